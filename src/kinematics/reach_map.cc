#include "kinematics/reach_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "kinematics/arm_choice.h"
#include "kinematics/reach_plan.h"

namespace springgrasp {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;

// Tilts tried in each direction: none, and both ways about two of the hand's own axes. From the
// side: roll, and pitch (y is up). From above: the two that swing x (down) aside.
std::array<Matrix3d, 5> Tilts(Approach approach, double most) {
  const Vector3d first = approach == Approach::kSide ? Vector3d::UnitX() : Vector3d::UnitY();
  return {Matrix3d(Matrix3d::Identity()), Matrix3d(AngleAxisd(most, first)),
          Matrix3d(AngleAxisd(-most, first)), Matrix3d(AngleAxisd(most, Vector3d::UnitZ())),
          Matrix3d(AngleAxisd(-most, Vector3d::UnitZ()))};
}

// H with x ahead and y up (side), or x down (above), before the turn about the vertical.
Matrix3d Upright(Approach approach, double side_of_thumb) {
  Matrix3d R;
  if (approach == Approach::kSide) {
    const Vector3d x = Vector3d::UnitY(), y = side_of_thumb * Vector3d::UnitZ();
    R << x, y, x.cross(y);
  } else {
    const Vector3d x = -Vector3d::UnitZ(), y = Vector3d::UnitX();
    R << x, y, x.cross(y);
  }
  return R;
}

}  // namespace

int CountDirections(const Arm& arm, const RobotHand& hand, const Vector3d& p_HG,
                    const Vector3d& p_WG, Approach approach, const ReachSurroundings& surroundings,
                    const ReachMapOptions& options) {
  const std::optional<ArmGeometry> geometry = GeometryOf(arm);
  if (!geometry) return 0;
  const double thumb_side = hand.name.back() == 'l' ? -1 : 1;
  const Matrix3d upright = Upright(approach, thumb_side);
  const bool side = approach == Approach::kSide;
  const std::array<Matrix3d, 5> tilts =
      Tilts(approach, side ? options.max_tilt : options.max_slant);
  ArmSolutions solutions;
  std::vector<Pose> X_WB;
  int count = 0;
  for (int d = 0; d < options.directions; ++d) {
    const double yaw = 2 * std::numbers::pi * d / options.directions;
    const Matrix3d turned = AngleAxisd(yaw, Vector3d::UnitZ()) * upright;
    for (const Matrix3d& tilt : tilts) {
      Pose X_WH = Pose::Identity();
      X_WH.linear() = turned * tilt;
      X_WH.translation() = p_WG - X_WH.linear() * p_HG;
      if (HandAboveTable(hand, X_WH, hand.open, surroundings.table_height,
                         surroundings.table_edge) < options.clearance) {
        continue;
      }
      solutions.Solve(*geometry, X_WH, ArmIkOptions().margin);
      const std::optional<ArmChoice> choice = ChoosePosture(*geometry, solutions, {});
      if (!choice) continue;
      if (ForearmAboveTable(arm, choice->q, surroundings.table_height, surroundings.table_edge) <
          options.clearance) {
        continue;
      }
      if (surroundings.body != nullptr &&
          SelfClearance(arm, *surroundings.body, choice->q, 0.01, X_WB) < options.clearance) {
        continue;
      }
      ++count;
      break;
    }
  }
  return count;
}

ReachMap MakeReachMap(const Arm& arm, const RobotHand& hand, const Vector3d& p_HG, double z,
                      const ReachSurroundings& surroundings, const ReachMapOptions& options) {
  ReachMap map;
  map.z = z;
  map.columns = 1 + static_cast<int>(std::lround((options.x_to - options.x_from) / options.cell));
  map.rows = 1 + static_cast<int>(std::lround((options.y_to - options.y_from) / options.cell));
  for (int row = 0; row < map.rows; ++row) {
    for (int column = 0; column < map.columns; ++column) {
      const Vector3d p_WG(options.x_from + options.cell * column,
                          options.y_from + options.cell * row, z);
      map.side.push_back(
          CountDirections(arm, hand, p_HG, p_WG, Approach::kSide, surroundings, options));
      map.above.push_back(
          CountDirections(arm, hand, p_HG, p_WG, Approach::kAbove, surroundings, options));
    }
  }
  return map;
}

std::string FormatReachMap(const ReachMap& map, const std::vector<int>& counts,
                           const ReachMapOptions& options) {
  std::string text;
  for (int row = map.rows - 1; row >= 0; --row) {
    text += fmt::format("  {:5.2f} ", options.y_from + options.cell * row);
    for (int column = 0; column < map.columns; ++column) {
      const int count = counts[static_cast<std::size_t>(row * map.columns + column)];
      text += ' ';
      text += count == 0 ? '.'
              : count == options.directions
                  ? '#'
                  : static_cast<char>('0' + std::clamp(10 * count / options.directions, 1, 9));
    }
    text += '\n';
  }
  text += fmt::format("        x from {:.2f} to {:.2f} m\n", options.x_from,
                      options.x_from + options.cell * (map.columns - 1));
  return text;
}

}  // namespace springgrasp
