#include "experiment/place_plan.h"

#include <algorithm>
#include <cmath>

#include "motion/dmp.h"
#include "motion/minimum_jerk.h"

namespace springgrasp {
namespace {

constexpr double kSideways = 0.7;  // of the duration, by when the hand is above the place
constexpr double kDescent = 0.35;  // of the duration, from when it goes down
constexpr double kBigStep = 0.15;  // rad between samples: a jump
constexpr double kAway = 0.6;      // of T: the retreat ends where the reach was then

// Minimum-jerk share of the way at time s of [from, to], both of the duration.
double Share(double s, double from, double to) {
  return MinimumJerkPosition(std::clamp((s - from) / (to - from), 0.0, 1.0));
}

}  // namespace

PlacePlan PlanPlace(const Arm& arm, const PlaceRequest& request) {
  PlacePlan plan;
  const double dt = request.dt, duration = request.criteria.place;
  const Pose X_WH_end = request.X_WH.back();
  const Eigen::Vector3d move = request.X_WO_place.translation() - request.X_WO.translation();
  const Eigen::VectorXd times = EvenTimes(duration, dt);
  std::vector<Pose> arc;
  for (const double t : times) {
    const double s = t / duration;
    Pose X = X_WH_end;
    X.translation() += Share(s, 0, kSideways) * Eigen::Vector3d(move.x(), move.y(), 0);
    X.translation().z() += request.lift + Share(s, kDescent, 1) * (move.z() - request.lift);
    arc.push_back(X);
  }
  const PoseDmp dmp = LearnPoseDmp(times, arc);
  plan.X_WH = RolloutPoseDmp(dmp, EvenTimes(1.2 * duration, dt)).X_WB;
  const ArmPath way = TrackArmPath(arm, plan.X_WH, request.q_lifted, kBigStep);
  if (!way.complete) {
    plan.reason = "placing: " + way.reason;
    return plan;
  }
  plan.arm = way.q;

  const double last = std::min(request.T / dt, static_cast<double>(request.X_WH.size() - 1));
  std::vector<Pose> back;
  const Pose to_place = plan.X_WH.back() * X_WH_end.inverse();
  const Eigen::VectorXd away = EvenTimes(request.criteria.retreat, dt);
  for (const double t : away) {
    const double at = last * (1 - (1 - kAway) * MinimumJerkPosition(t / request.criteria.retreat));
    back.push_back(to_place * PoseAlong(request.X_WH, at));
  }
  const ArmPath retreat = TrackArmPath(arm, back, plan.arm.back(), kBigStep);
  if (!retreat.complete) {
    plan.reason = "leaving the placed object: " + retreat.reason;
    return plan;
  }
  plan.retreat = retreat.q;
  plan.complete = true;
  return plan;
}

}  // namespace springgrasp
