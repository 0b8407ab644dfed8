#include "kinematics/reach_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "base/error.h"
#include "kinematics/carry_path.h"
#include "kinematics/reach_path.h"
#include "kinematics/shape_distance.h"

namespace springgrasp {
namespace {

constexpr double kEnoughMargin = 0.25;     // of half a joint's range; more is no better
constexpr double kLeastClearance = 0.002;  // m, a way nearer to the table is not taken
constexpr double kFar = 0.05;              // m, what is farther off is as good as far
constexpr double kArmClearance = 0.005;    // m, of the arm beside the object
constexpr double kSeatClearance = 0.004;   // m, of the hand beside what the object stands on
// 1/m, of a hand pose's score, at best kEnoughMargin: above its middle an object is held the worse
// (tuned with tripods, seed 92).
constexpr double kSlideCost = 2;
constexpr double kDeeper = 0.001;      // m, that a finger may enter more than as planned
constexpr double kSlideStep = 0.0125;  // m
constexpr double kNearCost = 10;       // per second, of a posture that touches

// Arm and the rest of its robot, up to kFar.
double SelfClearanceOf(const Arm& arm, const Eigen::VectorXd& q, const ReachRequest& request) {
  if (request.body == nullptr) return kFar;
  std::vector<Pose> X_WB;
  return SelfClearance(arm, *request.body, q, kFar, X_WB);
}

bool ArmClearOfObject(const Arm& arm, const Eigen::VectorXd& q, const ReachRequest& request) {
  if (request.body == nullptr) return true;
  std::vector<Pose> X_WB;
  return ArmDistance(arm, *request.body, q, request.shape, request.X_WO, X_WB) >= kArmClearance;
}

// Cost per second of an arm posture near the table or the robot itself.
double ObstacleCost(const Arm& arm, const Eigen::VectorXd& q, const ReachRequest& request) {
  const double clearance =
      std::min(SelfClearanceOf(arm, q, request),
               ForearmAboveTable(arm, q, request.table_height, request.table_edge));
  if (clearance < kLeastClearance) return std::numeric_limits<double>::infinity();
  const double near = std::max(0.0, 1 - clearance / kFar);
  return kNearCost * near * near;
}

bool HandClearOfObstacles(const RobotHand& hand, const Pose& X_WH, const Eigen::VectorXd& q_hand,
                          const ReachRequest& request) {
  if (request.obstacles.empty()) return true;
  constexpr PerFinger<bool> kAll = {true, true, true, true, true};
  std::vector<Pose> X_HB;
  ForwardKinematics(hand.tree, q_hand, X_HB);
  for (const Obstacle& o : request.obstacles) {
    if (HandDistance(hand, X_HB, o.X_WS.inverse() * X_WH, o.shape, kAll, true) < kSeatClearance) {
      return false;
    }
  }
  return true;
}

struct Goal {
  FreeMotion motion;
  Pose X_WH = Pose::Identity();
  Eigen::VectorXd q;
  double score = 0;
};

Pose Moved(const Pose& X_WH, const Eigen::Vector3d& by_W) {
  Pose moved = X_WH;
  moved.translation() += by_W;
  return moved;
}

// Why hand poses were no goal, counted.
struct GoalFaults {
  int hand_in_table = 0, out_of_reach = 0, forearm_in_table = 0, no_lift = 0, no_shake = 0;
  int in_object = 0, in_obstacle = 0;
};

std::string Describe(const GoalFaults& faults) {
  std::string text;
  const auto add = [&](int count, const char* what) {
    if (count > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, what);
  };
  add(faults.out_of_reach, "out of the arm's reach");
  add(faults.hand_in_table, "with the hand in the table");
  add(faults.in_object, "with palm or spare fingers in the object");
  add(faults.in_obstacle, "with the hand in what the object stands on");
  add(faults.forearm_in_table, "with the forearm in the table");
  add(faults.no_lift, "that cannot be lifted");
  add(faults.no_shake, "that cannot be shaken");
  return text;
}

// Whether palm and spare fingers keep off the object, and the others as far out of it as planned.
bool ClearOfObject(const RobotHand& hand, const ReachRequest& request, const FreeMotion& motion) {
  if (request.spare_clearance <= 0) return true;
  std::vector<Pose> X_HB;
  ForwardKinematics(hand.tree, request.q_hand.back(), X_HB);
  PerFinger<bool> spare;
  for (int f = 0; f < kNumFingers; ++f) spare[f] = !request.involved[f];
  const Pose X_OH = request.X_HO.inverse(), X_OH_moved = motion.X_OF * X_OH;
  const auto distance = [&](const Pose& X, const PerFinger<bool>& fingers, bool palm) {
    return HandDistance(hand, X_HB, X, request.shape, fingers, palm);
  };
  return distance(X_OH_moved, spare, true) >= request.spare_clearance &&
         distance(X_OH_moved, request.involved, false) >
             distance(X_OH, request.involved, false) - kDeeper;
}

// The goal of one free motion: reached, liftable, shakable, clear of the table.
std::optional<Goal> TryGoal(const Arm& arm, const RobotHand& hand, const ReachRequest& request,
                            const ReachOptions& options, const FreeMotion& motion,
                            GoalFaults& faults, std::vector<Pose>& holds) {
  const auto fails = [](int& count) {
    ++count;
    return std::nullopt;
  };
  Goal goal;
  goal.motion = motion;
  goal.X_WH = request.X_WO * motion.X_OF * request.X_HO.inverse();
  const double above = HandAboveTable(hand, goal.X_WH, request.q_hand.back(), request.table_height,
                                      request.table_edge);
  if (above < options.least_clearance) return fails(faults.hand_in_table);
  if (!ClearOfObject(hand, request, motion)) return fails(faults.in_object);
  if (!HandClearOfObstacles(hand, goal.X_WH, request.q_hand.back(), request)) {
    return fails(faults.in_obstacle);
  }
  holds.push_back(goal.X_WH);
  ArmIkOptions ik;
  ik.starts = 4;
  const std::optional<Eigen::VectorXd> q =
      SolveArmIkFromAnywhere(arm, goal.X_WH, ik, request.q_start);
  if (!q) return fails(faults.out_of_reach);
  goal.q = *q;
  const double forearm = ForearmAboveTable(arm, *q, request.table_height, request.table_edge);
  if (forearm < kLeastClearance) return fails(faults.forearm_in_table);
  double margin = LimitMargin(arm, *q);
  Eigen::VectorXd lifted_q = *q;
  for (const double part : {0.33, 0.66, 1.0}) {
    const auto next =
        SolveArmIk(arm, Moved(goal.X_WH, Eigen::Vector3d(0, 0, part * options.lift)), lifted_q, ik);
    if (!next) return fails(faults.no_lift);
    lifted_q = *next;
    margin = std::min(margin, LimitMargin(arm, lifted_q));
  }
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      const Eigen::Vector3d by =
          Eigen::Vector3d(0, 0, options.lift) + side * options.shake * Eigen::Vector3d::Unit(axis);
      if (!SolveArmIk(arm, Moved(goal.X_WH, by), lifted_q, ik)) return fails(faults.no_shake);
    }
  }
  goal.score = std::min(margin, kEnoughMargin);
  goal.score -= 0.03 * std::abs(motion.tilt) / 0.35 + 0.03 * std::abs(motion.roll) / 0.35 +
                0.01 * std::abs(motion.yaw) / std::numbers::pi +
                kSlideCost * std::abs(motion.slide);
  if (request.q_start) goal.score -= 0.05 * (goal.q - *request.q_start).cwiseAbs().maxCoeff();
  goal.score -= 10 * std::max(0.0, options.clearance - std::min(above, forearm));
  return goal;
}

// The whole path to one goal; false with a reason in `plan`.
bool PlanPath(const Arm& arm, const RobotHand& hand, const ReachRequest& request,
              const ReachOptions& options, const Goal& goal, ReachPlan& plan) {
  plan.X_OF = goal.motion.X_OF;
  plan.yaw = goal.motion.yaw;
  plan.tilt = goal.motion.tilt;
  plan.roll = goal.motion.roll;
  plan.slide = goal.motion.slide;
  plan.X_WH = request.path(goal.motion.X_OF);
  plan.via_raise =
      RaisePath(hand, request.q_hand, request.table_height, request.table_edge, options.clearance,
                static_cast<int>(std::lround(request.T / request.dt)), plan.X_WH);
  const std::optional<Eigen::VectorXd> q_end = SolveArmIk(arm, plan.X_WH.back(), goal.q);
  if (!q_end) {
    plan.reason = "the end of the reach is out of the arm's reach";
    return false;
  }
  if (!request.clear(plan.X_WH)) {
    plan.reason = "the hand would touch the object on its way";
    return false;
  }
  ReachPathRequest follow;
  follow.X_WH = plan.X_WH;
  follow.q_goal = *q_end;
  follow.q_start = request.q_start;
  follow.dt = request.dt;
  follow.max_speed = options.max_joint_speed;
  follow.latest_join = static_cast<int>(options.latest_join * request.T / request.dt);
  follow.clear = [&](const std::vector<Pose>& X_WH, const std::vector<Eigen::VectorXd>& q,
                     int end) {
    constexpr int kStride = 3;
    for (int k = 0; k < end; k += kStride) {
      const Eigen::VectorXd& q_hand =
          request.q_hand[std::min<std::size_t>(k, request.q_hand.size() - 1)];
      if (HandAboveTable(hand, X_WH[k], q_hand, request.table_height, request.table_edge) <
              kLeastClearance ||
          ForearmAboveTable(arm, q[k], request.table_height, request.table_edge) <
              kLeastClearance ||
          SelfClearanceOf(arm, q[k], request) < kLeastClearance ||
          !HandClearOfObstacles(hand, X_WH[k], q_hand, request) ||
          !ArmClearOfObject(arm, q[k], request)) {
        return false;
      }
    }
    return request.clear(X_WH);
  };
  follow.obstacles = [&](const SevenJoints& q, int) { return ObstacleCost(arm, q, request); };
  ReachPath path = FollowReach(arm, follow);
  if (!path.complete) {
    plan.reason = path.reason;
    return false;
  }
  for (const Eigen::VectorXd& q : path.q) {
    if (ArmClearOfObject(arm, q, request)) continue;
    plan.reason = "the arm would touch the object on its way";
    return false;
  }
  for (std::size_t k = 0; k < path.q.size(); ++k) {
    const Eigen::VectorXd& q_hand = request.q_hand[std::min(k, request.q_hand.size() - 1)];
    if (HandClearOfObstacles(hand, path.X_WH[k], q_hand, request)) continue;
    plan.reason = "the hand would touch what the object stands on";
    return false;
  }
  plan.X_WH = path.X_WH;
  plan.join = path.join * request.dt / request.T;
  CarryRequest carrying;
  carrying.X_WH = plan.X_WH.back();
  carrying.q = path.q.back();
  carrying.dt = request.dt;
  carrying.lift = options.lift;
  carrying.lift_duration = options.lift_duration;
  carrying.shake = options.shake;
  carrying.shake_frequency = options.shake_frequency;
  carrying.shake_duration = options.shake_duration;
  carrying.max_speed = options.max_joint_speed;
  carrying.obstacles = [&](const SevenJoints& q) { return ObstacleCost(arm, q, request); };
  CarryPath carry = PlanCarry(arm, carrying);
  if (!carry.complete) {
    plan.reason = carry.reason;
    return false;
  }
  plan.arm = path.q;
  plan.lift = std::move(carry.lift);
  plan.shake = std::move(carry.shake);
  plan.limit_margin = 1;
  plan.table_clearance = std::numeric_limits<double>::infinity();
  plan.self_clearance = kFar;
  for (std::size_t k = 0; k < plan.arm.size(); ++k) {
    plan.limit_margin = std::min(plan.limit_margin, LimitMargin(arm, plan.arm[k]));
    const Eigen::VectorXd& q_hand = request.q_hand[std::min(k, request.q_hand.size() - 1)];
    plan.table_clearance = std::min(
        {plan.table_clearance,
         ForearmAboveTable(arm, plan.arm[k], request.table_height, request.table_edge),
         HandAboveTable(hand, plan.X_WH[k], q_hand, request.table_height, request.table_edge)});
    plan.self_clearance = std::min(plan.self_clearance, SelfClearanceOf(arm, plan.arm[k], request));
  }
  if (plan.table_clearance < kLeastClearance) {
    plan.reason = "the hand would touch the table on its way";
    return false;
  }
  for (const Eigen::VectorXd& q : plan.lift) {
    plan.limit_margin = std::min(plan.limit_margin, LimitMargin(arm, q));
  }
  plan.reason = request.refusal ? request.refusal(plan) : "";
  plan.reachable = plan.reason.empty();
  return plan.reachable;
}

// PlanReach within one range of tilts.
ReachPlan PlanWithin(const Arm& arm, const RobotHand& hand, const ReachRequest& request,
                     const ReachOptions& options) {
  ReachPlan plan;
  std::vector<Goal> goals;
  GoalFaults faults;
  for (const FreeMotion& motion : FreeMotions(request, options)) {
    ++plan.candidates;
    std::optional<Goal> goal = TryGoal(arm, hand, request, options, motion, faults, plan.holds);
    if (goal) goals.push_back(std::move(*goal));
  }
  plan.goals = static_cast<int>(goals.size());
  if (goals.empty()) {
    plan.reason = fmt::format(
        "no arm posture grasps, lifts and shakes the object at ({:.3f}, {:.3f}, {:.3f}): of {} "
        "hand "
        "poses {}",
        request.X_WO.translation().x(), request.X_WO.translation().y(),
        request.X_WO.translation().z(), plan.candidates, Describe(faults));
    return plan;
  }
  std::stable_sort(goals.begin(), goals.end(),
                   [](const Goal& a, const Goal& b) { return a.score > b.score; });
  const std::size_t tries = std::min<std::size_t>(goals.size(), options.path_candidates);
  // Neighbouring goals fail alike: besides the best few, take them evenly from the rest.
  for (std::size_t i = 0; i < tries; ++i) {
    const std::size_t half = tries / 2;
    const std::size_t index =
        i < half ? i : half + (i - half) * (goals.size() - half) / (tries - half);
    if (PlanPath(arm, hand, request, options, goals[index], plan)) return plan;
  }
  return plan;
}

}  // namespace

ReachPlan PlanReach(const Arm& arm, const RobotHand& hand, const ReachRequest& request,
                    const ReachOptions& options) {
  ThrowUnless(!request.q_hand.empty() && request.path && request.clear,
              "a reach needs the hand's joints, a path of hand poses and what is in its way");
  ReachPlan plan = PlanWithin(arm, hand, request, options);
  if (!request.tilt_free || !request.tilt_far || request.shape.kind == Shape::Kind::kSphere)
    return plan;
  ReachOptions wider = options;
  wider.slide_step = kSlideStep;
  for (const double tilt : {options.last_resort_tilt, options.any_tilt}) {
    if (plan.reachable || tilt <= wider.max_tilt) break;
    wider.max_tilt = tilt;
    plan = PlanWithin(arm, hand, request, wider);
  }
  return plan;
}

}  // namespace springgrasp
