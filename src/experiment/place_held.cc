#include "experiment/place_held.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "motion/minimum_jerk.h"

namespace springgrasp {
namespace {

// By how much the arm's joints differ at the place, rad.
ArmVector Correction(const Arm& arm, const RobotHand& hand, const GraspPlan& plan,
                     const HandVector& q_hand) {
  const PerFinger<Eigen::Vector3d> now = TipPositions(hand, q_hand);
  const PerFinger<Eigen::Vector3d> planned = TipPositions(hand, plan.hand.back());
  Eigen::Vector3d others = Eigen::Vector3d::Zero();
  int count = 0;
  for (int f = kIndex; f < kNumFingers; ++f) {
    if (!plan.involved[f]) continue;
    others += now[f] - planned[f];
    ++count;
  }
  const Eigen::Vector3d moved_H = (now[kThumb] - planned[kThumb] + others / std::max(1, count)) / 2;
  Pose X_WH = HandPose(arm, plan.place.back());
  X_WH.translation() -= X_WH.linear() * moved_H;
  const auto q = SolveArmIk(arm, X_WH, plan.place.back());
  return q ? ArmVector(*q - plan.place.back()) : ArmVector::Zero();
}

}  // namespace

PlacePaths PathsForHeld(const Arm& arm, const RobotHand& hand, const GraspPlan& plan,
                        const HandVector& q_hand) {
  const ArmVector by = Correction(arm, hand, plan, q_hand);
  PlacePaths paths{plan.place, plan.retreat};
  const auto last = static_cast<double>(paths.place.size() - 1);
  for (std::size_t i = 0; i < paths.place.size(); ++i) {
    paths.place[i] += MinimumJerkPosition(static_cast<double>(i) / last) * by;
  }
  for (ArmVector& q : paths.retreat) q += by;
  return paths;
}

PlacedObject JudgePlaced(const Pose& X_WO, const Pose& X_WO_place,
                         const Eigen::Vector3d& p_WO_before, const ContactWindow& window,
                         const TrialCriteria& criteria) {
  PlacedObject placed;
  placed.error = (X_WO.translation() - X_WO_place.translation()).norm();
  placed.tilt =
      std::acos(std::clamp(X_WO.linear().col(2).dot(X_WO_place.linear().col(2)), -1.0, 1.0));
  const double speed = (X_WO.translation() - p_WO_before).norm() / criteria.rest;
  double touched = window.palm_normal;
  for (const double normal : window.normal) touched += normal;
  const double tilt_deg = placed.tilt * 180 / std::numbers::pi;
  if (placed.error > criteria.max_place_distance || tilt_deg > criteria.max_place_tilt_deg ||
      speed > criteria.max_place_speed || touched > 0) {
    placed.fault = fmt::format(
        "stands {:.0f} mm off and {:.0f} degrees tilted, moves at {:.1f} mm/s, touched with {:.1f} "
        "N",
        1e3 * placed.error, tilt_deg, 1e3 * speed, touched);
  }
  return placed;
}

}  // namespace springgrasp
