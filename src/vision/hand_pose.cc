#include "vision/hand_pose.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "vision/hand_fit_problem.h"

namespace springgrasp {
namespace {

void JudgeTips(const HandModel& model, const HandObservation& observation, HandFit& fit) {
  double sum = 0;
  fit.tips_used = 0;
  for (int f = 0; f < kNumFingers; ++f) {
    if (!observation.tip_W[f]) continue;
    sum += (FittedTip(model, fit, f) - *observation.tip_W[f]).squaredNorm();
    ++fit.tips_used;
  }
  fit.tip_rms = fit.tips_used > 0 ? std::sqrt(sum / fit.tips_used) : 0;
  fit.has_orientation = fit.tips_used >= 3;
}

// Pose of the fit's frames in H with lengths scaled.
Pose ScaledFrame(const HandModel& model, const HandFit& fit, int frame) {
  KinematicTree tree = model.tree;
  for (auto& node : tree.nodes) node.X_PB.translation() *= fit.scale;
  std::vector<Pose> X_HB;
  ForwardKinematics(tree, fit.q, X_HB);
  Pose X_BF = tree.frames[frame].X_BF;
  X_BF.translation() *= fit.scale;
  return X_HB[tree.frames[frame].node] * X_BF;
}

constexpr int kWayOutEvery = 3;  // frames

// A hand that fled up the forearm or rolled over fits the tips nearly as well: now and then one way
// out is tried, about the fingertips. The better of both, judged by this frame alone, since the
// past led into the wrong one.
HandFit TryWayOut(const HandModel& model, const StereoCameras& cameras,
                  const HandObservation& observation, const HandFields& fields, const HandFit& last,
                  const Pose& X_predicted, bool fit_scale, const HandPoseOptions& options,
                  const HandFit& fit) {
  struct Way {
    Eigen::Vector3d shift, turn;  // m and rad, in H
  };
  static const std::array<Way, 6> kWays = {{{{0.025, 0, 0}, {0, 0, 0}},
                                            {{0, 0, 0}, {0.3, 0, 0}},
                                            {{0, 0, 0}, {0, 0.3, 0}},
                                            {{-0.02, 0, 0}, {0, 0, 0}},
                                            {{0, 0, 0}, {-0.3, 0, 0}},
                                            {{0, 0, 0}, {0, -0.3, 0}}}};
  const Way& way = kWays[static_cast<std::size_t>(last.frame / kWayOutEvery) % kWays.size()];
  Eigen::Vector3d pivot = Eigen::Vector3d::Zero();
  int tips = 0;
  for (const auto& tip : observation.tip_W) {
    if (tip) pivot += *tip, ++tips;
  }
  pivot /= tips;
  HandFit other = fit;
  const Eigen::Matrix3d turn = ExpRotation(fit.X_WH.linear() * way.turn).toRotationMatrix();
  other.X_WH.linear() = turn * fit.X_WH.linear();
  other.X_WH.translation() =
      pivot + turn * (fit.X_WH.translation() - pivot) + fit.X_WH.linear() * way.shift;
  HandPoseOptions free = options;
  constexpr double kFree = 10;
  free.pose_sigma *= kFree;
  free.turn_sigma *= kFree;
  free.joint_sigma *= kFree;
  HandFitProblem now(model, cameras, observation, fields, last, X_predicted, fit_scale, false,
                     free);
  other = Solve(now, model, other, 2 * options.iterations);
  constexpr double kClearlyBetter = 1.5;
  return other.cost < Solve(now, model, fit, 0).cost - kClearlyBetter ? other : fit;
}

}  // namespace

Eigen::Vector3d FittedTip(const HandModel& model, const HandFit& fit, int finger) {
  return fit.X_WH * ScaledFrame(model, fit, model.tip[finger]).translation();
}

Eigen::Vector3d FittedAxis(const HandModel& model, const HandFit& fit, int finger) {
  const KinematicTree::Frame& frame = model.tree.frames[model.tip[finger]];
  const Pose X_HF = ScaledFrame(model, fit, model.tip[finger]);
  // Along the last bone: from its joint to the tip.
  return fit.X_WH.linear() *
         (X_HF.linear() * frame.X_BF.linear().transpose() * frame.X_BF.translation().normalized());
}

std::array<Eigen::Vector3d, kArcPlaces> BendingArc(const HandModel& model, const HandFit& fit,
                                                   int finger) {
  constexpr double kStraighter = 0.6, kMoreBent = 1.2;  // rad, at the knuckle
  std::array<Eigen::Vector3d, kArcPlaces> arc;
  HandFit bent = fit;
  for (int i = 0; i < kArcPlaces; ++i) {
    const double angle = -kStraighter + (kStraighter + kMoreBent) * i / (kArcPlaces - 1);
    for (int j = 0; j < static_cast<int>(fit.q.size()); ++j) {
      if (model.finger[j] != finger || !model.bends[j]) continue;
      bent.q[j] = std::clamp(fit.q[j] + angle, model.tree.lower[j], model.tree.upper[j]);
    }
    arc[i] = FittedTip(model, bent, finger);
  }
  return arc;
}

Eigen::Vector3d PalmOf(const HandFit& fit) {
  return fit.X_WH * Eigen::Vector3d(0.045 * fit.scale, 0, 0);
}

namespace {

// Hands with their palm to the cameras and fingers in the picture from the hand's skin to its tips,
// bent and tilted towards the cameras by some amounts, laid onto the tips seen. Empty if these are
// not before the camera.
std::vector<HandFit> LikelyHands(const HandModel& model, const StereoCameras& cameras,
                                 const HandObservation& observation, double scale) {
  std::vector<int> seen;
  for (int f = 0; f < kNumFingers; ++f) {
    if (observation.tip_W[f]) seen.push_back(f);
  }
  std::vector<HandFit> hands;
  const Eigen::Matrix3d R_WC = cameras.left.X_WC.linear();
  const Eigen::Vector3d forward = R_WC.col(2);
  Eigen::Vector3d tips = Eigen::Vector3d::Zero();
  for (int f : seen) tips += *observation.tip_W[f] / static_cast<double>(seen.size());
  Eigen::Vector3d along = Eigen::Vector3d::Zero();  // in the picture plane, from palm to tips
  const auto tips_px = Project(cameras.left, tips);
  if (!tips_px) return hands;
  if (observation.masks[0] != nullptr && !observation.masks[0]->mask.empty()) {
    const double depth = forward.dot(tips - cameras.left.X_WC.translation());
    const MaskField field = MakeField(*observation.masks[0], 200, *tips_px,
                                      0.16 * cameras.left.fx / std::max(0.1, depth));
    for (const Eigen::Vector2d& sample : field.samples) {
      along.head<2>() += *tips_px - sample;
    }
  }
  if (along.norm() < 1e-6) along = -Eigen::Vector3d::UnitY();
  along = (R_WC * along).normalized();
  for (const double bend : {0.3, 1.0, 1.7}) {
    for (const double tilt : {-0.4, 0.0, 0.5, 1.0}) {
      HandFit start;
      start.scale = scale;
      start.q = (bend * model.rest).cwiseMax(model.tree.lower).cwiseMin(model.tree.upper);
      start.X_WH.linear() << along, forward.cross(along), forward;
      start.X_WH.linear() =
          start.X_WH.linear() * ExpRotation(Eigen::Vector3d(0, tilt, 0)).toRotationMatrix();
      Eigen::Vector3d model_tips = Eigen::Vector3d::Zero();
      for (int f : seen)
        model_tips += FittedTip(model, start, f) / static_cast<double>(seen.size());
      start.X_WH.translation() = tips - model_tips;
      hands.push_back(start);
    }
  }
  return hands;
}

// A fit found without the wrist's depth, settled with it. Its cost stays comparable: without.
HandFit WithDepth(const HandModel& model, const StereoCameras& cameras,
                  const HandObservation& observation, HandFields fields, const HandFit& found,
                  const HandPoseOptions& options) {
  constexpr int kRounds = 2;
  constexpr double kWorse = 10;  // of the cost: the depth was that of something else
  HandFit any;
  any.q = model.rest;
  HandFit fit = found;
  for (int i = 0; i < kRounds; ++i) {
    fields.wrist = MeasureWristDepth(model, cameras, observation, fit);
    HandFitProblem problem(model, cameras, observation, fields, any, any.X_WH, true, true, options);
    fit = Solve(problem, model, fit, 2 * options.start_iterations);
  }
  fields.wrist.reset();
  HandFitProblem plain(model, cameras, observation, fields, any, any.X_WH, true, true, options);
  if (Solve(plain, model, fit, 0).cost > found.cost + kWorse) return found;
  fit.cost = found.cost;
  return fit;
}

}  // namespace

std::optional<HandFit> StartHandFit(const HandModel& model, const StereoCameras& cameras,
                                    const HandObservation& observation,
                                    const HandPoseOptions& options) {
  std::vector<int> seen;
  for (int f = 0; f < kNumFingers; ++f) {
    if (observation.tip_W[f]) seen.push_back(f);
  }
  if (seen.size() < 4) return std::nullopt;
  // Coarse to fine: outlines pull from afar first.
  HandPoseOptions coarse = options;
  coarse.mask_reach_px *= 2.5;
  coarse.skin_sigma_px *= 2.5;
  coarse.ball_sigma_px *= 2;
  HandFit any;
  any.q = model.rest;
  const HandFields fields = MakeFields(cameras, observation, options);
  HandFitProblem coarse_problem(model, cameras, observation, fields, any, any.X_WH, true, true,
                                coarse);
  std::vector<HandFit> starts;
  for (const HandFit& hand : LikelyHands(model, cameras, observation, 1)) {
    starts.push_back(Solve(coarse_problem, model, hand, options.start_iterations));
  }
  std::stable_sort(starts.begin(), starts.end(),
                   [](const HandFit& a, const HandFit& b) { return a.cost < b.cost; });
  HandFitProblem problem(model, cameras, observation, fields, any, any.X_WH, true, true, options);
  std::optional<HandFit> best;
  for (std::size_t i = 0; i < std::min<std::size_t>(4, starts.size()); ++i) {
    const HandFit fit = Solve(problem, model, starts[i], 2 * options.start_iterations);
    if (!best || fit.cost < best->cost) best = fit;
  }
  if (best) {
    best = WithDepth(model, cameras, observation, fields, *best, options);
    JudgeTips(model, observation, *best);
  }
  return best;
}

std::optional<HandFit> RestartHandFit(const HandModel& model, const StereoCameras& cameras,
                                      const HandObservation& observation, const HandFit& last,
                                      const HandPoseOptions& options) {
  constexpr double kFree = 10, kClearlyBetter = 5;
  HandPoseOptions free = options;
  free.pose_sigma *= kFree;
  free.turn_sigma *= kFree;
  free.joint_sigma *= kFree;
  const HandFields fields = MakeFields(cameras, observation, options);
  HandFitProblem now(model, cameras, observation, fields, last, last.X_WH, false, false, free);
  HandFit best = Solve(now, model, last, options.iterations);
  const double least = best.cost - kClearlyBetter;
  bool found = false;
  for (const HandFit& hand : LikelyHands(model, cameras, observation, last.scale)) {
    const HandFit other = Solve(now, model, hand, options.start_iterations);
    if (other.cost >= std::min(least, best.cost)) continue;
    best = other;
    found = true;
  }
  if (!found) return std::nullopt;
  best.frame = last.frame;
  JudgeTips(model, observation, best);
  return best;
}

HandFit UpdateHandFit(const HandModel& model, const StereoCameras& cameras,
                      const HandObservation& observation, const HandFit& last,
                      const HandStep& moved, bool fit_scale, const HandPoseOptions& options) {
  int tips = 0;
  for (const auto& tip : observation.tip_W) tips += tip.has_value();
  Pose X_predicted = last.X_WH;
  X_predicted.translation() += moved.position;
  X_predicted.linear() = ExpRotation(moved.rotation).toRotationMatrix() * last.X_WH.linear();
  if (tips == 0) {
    HandFit fit = last;
    fit.X_WH = X_predicted;
    JudgeTips(model, observation, fit);
    return fit;
  }
  HandFit start = last;
  start.X_WH = X_predicted;
  if (moved.joints.size() == last.q.size()) {
    start.q = (last.q + moved.joints).cwiseMax(model.tree.lower).cwiseMin(model.tree.upper);
  }
  HandFields fields = MakeFields(cameras, observation, options);
  fields.wrist = MeasureWristDepth(model, cameras, observation, start);
  HandFitProblem problem(model, cameras, observation, fields, last, X_predicted, fit_scale, false,
                         options);
  problem.SetPredictedJoints(start.q);
  HandFit fit = Solve(problem, model, start, options.iterations);
  if (tips >= 3 && last.frame % kWayOutEvery == 0) {
    fit =
        TryWayOut(model, cameras, observation, fields, last, X_predicted, fit_scale, options, fit);
  }
  fit.frame = last.frame + 1;
  JudgeTips(model, observation, fit);
  return fit;
}

}  // namespace springgrasp
