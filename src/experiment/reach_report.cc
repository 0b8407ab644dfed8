#include "experiment/reach_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "experiment/robot_body.h"
#include "kinematics/reach_plan.h"
#include "sim/arm_body_of.h"
#include "sim/kinematic_tree_of.h"
#include "sim/scene_builder.h"

namespace springgrasp {
namespace {

constexpr double kHeights[] = {0.04, 0.09, 0.14};  // m, of the grasp centre above the table
constexpr double kDegrees = 180 / std::numbers::pi;
constexpr double kBodyFront = 0.28;  // m, before the robot's origin, at table height
constexpr double kGap = 0.02;        // m, between body and table

// The right arm of a scene's robot with everything that it can hit.
struct Reacher {
  Arm arm;
  ArmBody body;
  RobotHand hand;
  Eigen::Vector3d p_HG;  // between the opened fingers and the thumb
  ReachSurroundings around;
};

// The scene's robot and table, the robot in that posture.
Simulation WithoutObjects(const Scene& scene, const BasePosture& base) {
  Scene moved = scene;
  moved.objects.clear();
  for (const auto& [joint, value] : base) moved.start[joint] = value;
  BuildOptions build;
  build.with_looks = false;
  return Simulation(BuildModel(moved, build));
}

Reacher MakeReacher(const Scene& scene, const BasePosture& base) {
  const Simulation simulation = WithoutObjects(scene, base);
  RobotBody robot = MakeRobotBody(simulation);
  Reacher reacher{std::move(robot.arm),
                  std::move(robot.arm_body),
                  std::move(robot.hand),
                  Eigen::Vector3d::Zero(),
                  {}};
  const PerFinger<Eigen::Vector3d> tips = TipPositions(reacher.hand, [&] {
    Eigen::VectorXd half = 0.5 * (reacher.hand.tree.lower + reacher.hand.tree.upper);
    half[reacher.hand.palm] = 0;
    if (reacher.hand.opposition >= 0) half[reacher.hand.opposition] = 0;
    return half;
  }());
  reacher.p_HG = 0.5 * (tips[kThumb] + 0.5 * (tips[kIndex] + tips[kMiddle]));
  reacher.around.table_height = scene.table.height;
  reacher.around.table_edge = scene.table.position.y() - scene.table.size.y() / 2;
  return reacher;
}

int Directions(const Reacher& r, const Eigen::Vector3d& p_WO, Approach approach,
               const ReachMapOptions& options) {
  ReachSurroundings around = r.around;
  around.body = &r.body;
  return CountDirections(r.arm, r.hand, r.p_HG, p_WO, approach, around, options);
}

// Postures to try, with a cost that grows with the move.
std::vector<std::pair<double, BasePosture>> Candidates(const ReachAids& aids, double table_edge) {
  std::vector<std::pair<double, BasePosture>> candidates;
  const std::vector<double> none = {0};
  const std::vector<double> turns = {0, -0.26, 0.26, -0.52, 0.52};
  const std::vector<double> leans = {0, 0.17, 0.35};
  const std::vector<double> ways = {0, -0.1, 0.1, -0.2, 0.2, -0.3, 0.3, -0.4, 0.4};
  const double nearest = table_edge - kGap - kBodyFront;
  for (const double yaw : aids.torso ? turns : none) {
    for (const double lean : aids.torso ? leans : none) {
      for (const double x : aids.platform ? ways : none) {
        for (const double y : aids.platform ? ways : none) {
          if (y > std::max(0.0, nearest)) continue;
          BasePosture base;
          if (aids.torso) base = {{"torso_yaw", yaw}, {"torso_pitch", lean}};
          if (aids.platform) {
            base["platform_x"] = x;
            base["platform_y"] = y;
          }
          const double cost = std::abs(yaw) + 2 * std::abs(lean) + 2 * std::hypot(x, y);
          if (cost > 0) candidates.emplace_back(cost, base);
        }
      }
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  return candidates;
}

std::string FormatBase(const BasePosture& base) {
  std::string text;
  for (const auto& [joint, value] : base) {
    if (value == 0) continue;
    text += text.empty() ? "" : ", ";
    text += joint.starts_with("torso") ? fmt::format("{} {:+.0f} deg", joint, kDegrees * value)
                                       : fmt::format("{} {:+.2f} m", joint, value);
  }
  return text;
}

}  // namespace

ReachAids AidsOf(const Scene& scene) {
  const auto active = [&](const char* name) {
    return std::count(scene.active.begin(), scene.active.end(), name) > 0;
  };
  return {scene.torso == "free" || active("torso"), active("platform")};
}

bool StandsClear(const Scene& scene, const BasePosture& base) {
  return WithoutObjects(scene, base).data().ncon == 0;
}

std::vector<BasePosture> MovesIntoReach(const Scene& scene, const ReachAids& aids,
                                        const Eigen::Vector3d& p_WO,
                                        const ReachMapOptions& options) {
  constexpr std::size_t kMost = 3;
  std::vector<BasePosture> moves;
  // One model in which torso and platform can move tells what the arm reaches from where; the few
  // that serve are looked at with everything that stands in the way.
  Scene movable = scene;
  movable.active.insert(movable.active.end(), {"torso", "platform"});
  Reacher quick = MakeReacher(movable, {});
  const Eigen::VectorXd start = quick.arm.q;
  const auto enough = [&](const Reacher& reacher, bool with_body) {
    for (const Approach approach : {Approach::kSide, Approach::kAbove}) {
      ReachSurroundings around = reacher.around;
      if (with_body) around.body = &reacher.body;
      if (4 * CountDirections(reacher.arm, reacher.hand, reacher.p_HG, p_WO, approach, around,
                              options) >=
          options.directions) {
        return true;
      }
    }
    return false;
  };
  const double edge = scene.table.position.y() - scene.table.size.y() / 2;
  for (const auto& [cost, base] : Candidates(aids, edge)) {
    quick.arm.q = start;
    for (const auto& [joint, value] : base) {
      quick.arm.q[quick.arm.tree.JointIndex(joint)] = value;
    }
    if (!enough(quick, false) || !StandsClear(scene, base)) continue;
    if (!enough(MakeReacher(scene, base), true)) continue;
    moves.push_back(base);
    if (moves.size() == kMost) break;
  }
  return moves;
}

std::vector<BasePosture> MovesToHold(const Scene& scene, const ReachAids& aids,
                                     const std::vector<Pose>& X_WH, double lift, std::size_t most) {
  constexpr std::size_t kLooked = 48;
  constexpr int kEnough = 12;
  constexpr double kNear = 0.002;  // m, of arm and table or robot
  std::vector<BasePosture> moves;
  std::vector<Pose> holds;
  const std::size_t count = std::min(kLooked, X_WH.size());
  for (std::size_t i = 0; i < count; ++i) holds.push_back(X_WH[i * X_WH.size() / count]);
  Scene movable = scene;
  movable.active.insert(movable.active.end(), {"torso", "platform"});
  Reacher quick = MakeReacher(movable, {});
  const Eigen::VectorXd start = quick.arm.q;
  ArmIkOptions ik;
  ik.starts = 4;
  const auto reached = [&](const Reacher& reacher, bool with_body) {
    int hits = 0;
    std::vector<Pose> X_WB;
    for (const Pose& hold : holds) {
      const auto q = SolveArmIkFromAnywhere(reacher.arm, hold, ik);
      if (!q) continue;
      Pose lifted = hold;
      lifted.translation().z() += lift;
      if (!SolveArmIkFromAnywhere(reacher.arm, lifted, ik)) continue;
      hits += ForearmAboveTable(reacher.arm, *q, reacher.around.table_height,
                                reacher.around.table_edge) >= kNear &&
              (!with_body || SelfClearance(reacher.arm, reacher.body, *q, kNear, X_WB) >= kNear);
    }
    return hits;
  };
  std::vector<std::pair<int, BasePosture>> found;
  int well = 0;
  for (const auto& [cost, base] :
       Candidates(aids, scene.table.position.y() - scene.table.size.y() / 2)) {
    quick.arm.q = start;
    for (const auto& [joint, value] : base) {
      quick.arm.q[quick.arm.tree.JointIndex(joint)] = value;
    }
    const int hits = std::min(kEnough, reached(quick, false));
    if (hits == 0) continue;
    found.emplace_back(hits, base);
    well += hits == kEnough;
    if (well >= 2 * static_cast<int>(most)) break;
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  for (const auto& [hits, base] : found) {
    if (moves.size() == most) break;
    if (!StandsClear(scene, base)) continue;
    if (reached(MakeReacher(scene, base), true) > 0) moves.push_back(base);
  }
  return moves;
}

ReachReport ReportReach(const Scene& scene, const ReachAids& aids, const ReachMapOptions& options) {
  ReachReport report;
  report.options = options;
  report.table_height = scene.table.height;
  const Reacher reacher = MakeReacher(scene, {});
  ReachSurroundings around = reacher.around;
  around.body = &reacher.body;
  for (const double height : kHeights) {
    report.maps.push_back(MakeReachMap(reacher.arm, reacher.hand, reacher.p_HG,
                                       scene.table.height + height, around, options));
  }
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    ObjectReach object;
    object.name = scene.objects[i].name;
    object.p_WO = ObjectStartPose(scene, static_cast<int>(i)).translation();
    object.side = Directions(reacher, object.p_WO, Approach::kSide, options);
    object.above = Directions(reacher, object.p_WO, Approach::kAbove, options);
    if (4 * std::max(object.side, object.above) < options.directions) {
      object.moves = MovesIntoReach(scene, aids, object.p_WO, options);
    }
    report.objects.push_back(object);
  }
  return report;
}

std::string FormatReachReport(const ReachReport& report) {
  std::string text = fmt::format(
      "\nwhere the right hand can grasp: tenths of {} directions about the vertical ('#' all, '.' "
      "none), rows y, columns x, every {:.0f} mm\n",
      report.options.directions, 1e3 * report.options.cell);
  for (const ReachMap& map : report.maps) {
    text += fmt::format("\n{:.2f} m ({:.0f} mm above the table), from the side\n{}", map.z,
                        1e3 * (map.z - report.table_height),
                        FormatReachMap(map, map.side, report.options));
    text += fmt::format("\n{:.2f} m, from above\n{}", map.z,
                        FormatReachMap(map, map.above, report.options));
  }
  text += "\n";
  for (const ObjectReach& object : report.objects) {
    const bool reached = std::max(object.side, object.above) > 0;
    text += fmt::format(
        "{} at ({:.2f}, {:.2f}, {:.2f}): {} ({} of {} directions from the side, "
        "{} from above)\n",
        object.name, object.p_WO.x(), object.p_WO.y(), object.p_WO.z(),
        reached ? "within reach" : "out of reach", object.side, report.options.directions,
        object.above);
    for (const BasePosture& base : object.moves) {
      text += fmt::format("  better from {}\n", FormatBase(base));
    }
  }
  return text;
}

}  // namespace springgrasp
