#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "kinematics/reach_plan.h"
#include "motion/minimum_jerk.h"

namespace springgrasp {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kForearmRadius = 0.047;      // m (models/armar3b)
constexpr double kWristRadius = 0.03;         // m
constexpr double kSquare = 0.002;             // m, sides as equal as this are equal
constexpr double kRoll = 20 * kPi / 180;      // rad, about G's z (spheres)
constexpr double kBelowEnd = 0.012;           // m, contacts stay so far below the upper end
constexpr double kTiltStep = 10 * kPi / 180;  // rad

// Turns 0, +step, -step, +2 step, ... up to `most` (inclusive).
std::vector<double> Around(double step, double most) {
  std::vector<double> values = {0};
  for (int i = 1; i * step <= most + 1e-9; ++i) {
    values.push_back(i * step);
    values.push_back(-i * step);
  }
  return values;
}

Pose TurnAbout(const Eigen::Vector3d& p, const Eigen::Vector3d& axis, double angle) {
  Pose X = Pose::Identity();
  X.linear() = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
  X.translation() = p - X.linear() * p;
  return X;
}

}  // namespace

std::vector<FreeMotion> FreeMotions(const ReachRequest& request, const ReachOptions& options) {
  const Pose X_OC = request.X_HO.inverse() * request.X_HC;
  const bool sphere = request.shape.kind == Shape::Kind::kSphere;
  const Eigen::Vector3d up_O =
      sphere ? Eigen::Vector3d(request.X_WO.linear().row(2)) : Eigen::Vector3d::UnitZ();
  std::vector<double> yaws, rolls = {0}, tilts = {0}, slides = {0};
  if (request.shape.kind == Shape::Kind::kBox) {
    const bool square = std::abs(request.shape.size.x() - request.shape.size.y()) < kSquare;
    yaws = square ? std::vector<double>{0, kPi / 2, -kPi / 2, kPi} : std::vector<double>{0, kPi};
  } else {
    yaws = Around(options.yaw_step, kPi - 0.5 * options.yaw_step);
    yaws.push_back(kPi);
  }
  if (sphere) rolls = Around(kRoll, kRoll);
  // Tilting a sphere is a turn like any other; elsewhere the approach shall stay the demonstrated.
  if (sphere) {
    tilts = Around(2 * kTiltStep, options.last_resort_tilt);
  } else if (request.tilt_free) {
    tilts = Around(kTiltStep, options.max_tilt);
    // Along faces and the round, not along the normal of end faces.
    const bool along = std::abs(X_OC(2, 0)) < 0.1;
    const double highest = request.shape.size.z() / 2 - kBelowEnd - X_OC.translation().z();
    for (int i = 1; along && options.slide_step > 0 && i * options.slide_step <= highest; ++i) {
      slides.push_back(i * options.slide_step);
    }
  }
  // A sphere turns about its own centre, so that its contacts stay on it.
  const Eigen::Vector3d p = (sphere ? 0.0 : 1.0) * X_OC.translation();
  std::vector<FreeMotion> motions;
  for (const double slide : slides) {
    const Pose X_slide(Eigen::Translation3d(0, 0, slide));
    for (const double tilt : tilts) {
      const Pose X_tilt = TurnAbout(p, X_OC.linear().col(0), tilt);
      for (const double roll : rolls) {
        const Pose X_roll = TurnAbout(p, X_OC.linear().col(2), roll);
        for (const double yaw : yaws) {
          const Pose X_yaw = TurnAbout(Eigen::Vector3d::Zero(), up_O.normalized(), yaw);
          motions.push_back({X_slide * X_yaw * X_tilt * X_roll, yaw, tilt, roll, slide});
        }
      }
    }
  }
  return motions;
}

double HandAboveTable(const RobotHand& hand, const Pose& X_WH, const Eigen::VectorXd& q_hand,
                      double table_height, double table_edge) {
  std::vector<Pose> X_HB;
  ForwardKinematics(hand.tree, q_hand, X_HB);
  double lowest = std::numeric_limits<double>::infinity();
  for (const LinkCapsule& c : hand.capsules) {
    for (const Eigen::Vector3d& p_B : {c.a, c.b}) {
      const Eigen::Vector3d p_W = X_WH * (X_HB[c.node] * p_B);
      if (p_W.y() + c.radius < table_edge) continue;
      lowest = std::min(lowest, p_W.z() - c.radius - table_height);
    }
  }
  return lowest;
}

double ForearmAboveTable(const Arm& arm, const Eigen::VectorXd& q, double table_height,
                         double table_edge) {
  Eigen::VectorXd full = arm.q;
  for (int i = 0; i < arm.num_joints(); ++i) full[arm.joints[i]] = q[i];
  std::vector<Pose> X_WB;
  ForwardKinematics(arm.tree, full, X_WB);
  const Eigen::Vector3d p_hand = FramePose(arm.tree, X_WB, arm.frame).translation();
  // The elbow: the farthest of the last joints' bodies that is not yet the wrist.
  Eigen::Vector3d p_elbow = p_hand;
  for (int b = arm.tree.frames[arm.frame].node; b >= 0; b = arm.tree.nodes[b].parent) {
    p_elbow = X_WB[b].translation();
    if ((p_elbow - p_hand).norm() > 0.1) break;
  }
  double lowest = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= 6; ++i) {
    const double s = i / 6.0;
    const Eigen::Vector3d p = p_elbow + s * (p_hand - p_elbow);
    const double radius = kForearmRadius + s * (kWristRadius - kForearmRadius);
    if (p.y() + radius < table_edge) continue;
    lowest = std::min(lowest, p.z() - radius - table_height);
  }
  return lowest;
}

double RaisePath(const RobotHand& hand, const std::vector<Eigen::VectorXd>& q_hand,
                 double table_height, double table_edge, double clearance, int last,
                 std::vector<Pose>& X_WH) {
  constexpr double kWeak = 0.15;  // where the bump is lower it cannot help
  constexpr double kMost = 0.25;  // m
  const int n = static_cast<int>(X_WH.size());
  last = std::clamp(last, 1, std::max(1, n - 1));
  const auto bump = [&](int k) {
    const double s = static_cast<double>(k) / last;
    return s >= 1 ? 0 : MinimumJerkPosition(s / 0.4) * MinimumJerkPosition((1 - s) / 0.5);
  };
  double raise = 0;
  for (int k = 0; k < std::min(n, last); ++k) {
    const double b = bump(k);
    if (b < kWeak) continue;
    const Eigen::VectorXd& q = q_hand[std::min<std::size_t>(k, q_hand.size() - 1)];
    const double height = HandAboveTable(hand, X_WH[k], q, table_height, table_edge);
    raise = std::max(raise, std::min(kMost, (clearance - height) / b));
  }
  for (int k = 0; k < std::min(n, last); ++k) X_WH[k].translation().z() += raise * bump(k);
  return raise;
}

}  // namespace springgrasp
