#include "grasp/learn_reach.h"

#include <algorithm>
#include <cmath>

#include "motion/central_force.h"
#include "motion/minimum_jerk.h"
#include "motion/smoothing.h"

namespace springgrasp {

using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

namespace {

constexpr double kRest = 0.5;  // of T, at the goal: reaches are rolled out to 1.5 T

// Velocity and acceleration at the ends decide how a cut movement is completed, and are what a
// recording knows worst. They become those of a straight line through the velocities of the first
// and last tenth of a second, the acceleration no larger than a minimum-jerk movement of the same
// duration and peak speed has.
void CalmEnds(MotionSamples& samples, double dt) {
  const Eigen::Index n = samples.size();
  const auto m = std::min<Eigen::Index>(n, static_cast<Eigen::Index>(0.12 / dt) + 2);
  const double duration = static_cast<double>(n - 1) * dt;
  for (const Eigen::Index end : {Eigen::Index{0}, n - 1}) {
    const Eigen::Index first = end == 0 ? 0 : n - m;
    const MatrixXd v = samples.v.middleRows(first, m);
    const VectorXd t = samples.t.segment(first, m).array() - samples.t.segment(first, m).mean();
    RowVectorXd slope = t.transpose() * v / t.squaredNorm();
    const RowVectorXd value = v.colwise().mean() + (end == 0 ? t[0] : t[m - 1]) * slope;
    constexpr double kPeaks = 5.7735 / 1.875;  // peak acceleration / (peak speed / duration)
    for (const Eigen::Index part : {0, 3}) {   // translation, rotation
      const double largest = kPeaks * value.segment(part, 3).norm() / duration;
      const double now = slope.segment(part, 3).norm();
      if (now > largest) slope.segment(part, 3) *= largest / now;
    }
    samples.v.row(end) = value;
    samples.a.row(end) = slope;
  }
}

MotionSamples Rows(const MotionSamples& samples, Eigen::Index first, Eigen::Index count) {
  return {samples.t.segment(first, count), samples.x.middleRows(first, count),
          samples.v.middleRows(first, count), samples.a.middleRows(first, count)};
}

// Completed to rest at both ends. How long the missing parts last is judged from the nearest 0.3 s:
// the slow homing in at the end of a reach says nothing about how it began.
CompletedMotion Complete(const MotionSamples& samples, double dt) {
  const double peak = samples.v.leftCols(3).rowwise().norm().maxCoeff();
  const Eigen::Index n = samples.size();
  const auto window = std::min<Eigen::Index>(n, static_cast<Eigen::Index>(0.3 / dt) + 1);
  const auto moves = [&](Eigen::Index row) {
    return samples.v.row(row).head(3).norm() > 0.05 * peak;  // movement time: 5 % of peak speed
  };
  CompletedMotion begin, end;
  if (moves(0)) begin = CompleteToRest(Rows(samples, 0, window));
  if (moves(n - 1)) end = CompleteToRest(Rows(samples, n - window, window));
  const auto before = static_cast<Eigen::Index>(std::lround(begin.begin / dt));
  const auto after = static_cast<Eigen::Index>(std::lround(end.end / dt));

  CompletedMotion out;
  out.begin = static_cast<double>(before) * dt;
  out.end = static_cast<double>(after) * dt;
  const Eigen::Index total = before + n + after;
  out.samples.t = VectorXd::LinSpaced(total, 0, static_cast<double>(total - 1) * dt);
  const auto join = [&](MatrixXd MotionSamples::*part) {
    MatrixXd& rows = out.samples.*part;
    rows.resize(total, samples.dimension());
    if (before > 0) rows.topRows(before) = (begin.samples.*part).topRows(before);
    rows.middleRows(before, n) = samples.*part;
    if (after > 0) rows.bottomRows(after) = (end.samples.*part).bottomRows(after);
  };
  join(&MotionSamples::x);
  join(&MotionSamples::v);
  join(&MotionSamples::a);
  return out;
}

// Followed by a rest at the last pose: else the last weights, which only the noise of the end would
// decide, carry the hand away from its goal after T.
MotionSamples ThenRest(const MotionSamples& samples, double duration, double dt) {
  const Eigen::Index n = samples.size();
  const auto rest = static_cast<Eigen::Index>(std::lround(duration / dt));
  MotionSamples out;
  out.t = VectorXd::LinSpaced(n + rest, 0, static_cast<double>(n + rest - 1) * dt);
  out.x.resize(n + rest, samples.dimension());
  out.x.topRows(n) = samples.x;
  out.x.bottomRows(rest).rowwise() = samples.x.row(n - 1);
  for (const auto part : {&MotionSamples::v, &MotionSamples::a}) {
    (out.*part).setZero(n + rest, samples.dimension());
    (out.*part).topRows(n) = samples.*part;
  }
  return out;
}

}  // namespace

LearnedReach LearnReach(const std::vector<Pose>& X_OG, double dt, int basis_functions) {
  const Eigen::Quaterniond R_goal(X_OG.back().linear());
  const auto count = static_cast<Eigen::Index>(X_OG.size());
  const VectorXd t = VectorXd::LinSpaced(count, 0, static_cast<double>(count - 1) * dt);
  const double cutoff = kReachBandwidth / t[count - 1];
  MotionSamples measured = SmoothSamples(t, PoseCoordinates(X_OG, R_goal), cutoff, t);
  CalmEnds(measured, dt);
  const CompletedMotion completed = Complete(measured, dt);

  LearnedReach reach;
  reach.lead = completed.begin;
  reach.tail = completed.end;
  reach.T = completed.samples.t[completed.samples.size() - 1];
  DmpOptions options;
  options.num_basis = basis_functions;
  options.tau = reach.T;
  reach.dmp = LearnPoseDmp(ThenRest(completed.samples, kRest * reach.T, dt), R_goal, options);
  const PoseMotion rollout = RolloutPoseDmp(reach.dmp, t.array() + reach.lead);
  double square = 0;
  for (Eigen::Index n = 0; n < count; ++n) {
    const auto k = static_cast<std::size_t>(n);
    square += (rollout.X_WB[k].translation() - X_OG[k].translation()).squaredNorm();
  }
  reach.rmse = std::sqrt(square / static_cast<double>(count));
  return reach;
}

HandPath RollOutHand(const PoseDmp& dmp, const Pose& X_GH, double T, double dt, int count) {
  const VectorXd t = VectorXd::LinSpaced(count, 0, (count - 1) * dt);
  HandPath path;
  path.X_OG = RolloutPoseDmp(dmp, t).X_WB;
  MatrixXd p(count, 3);
  for (int n = 0; n < count; ++n) {
    p.row(n) = (path.X_OG[static_cast<std::size_t>(n)] * X_GH).translation().transpose();
  }
  const MotionSamples motion = DifferentiateSamples(t, p);
  for (Eigen::Index n = 0; n < motion.a.rows(); ++n) {
    path.acceleration.push_back(motion.a.row(n).norm());
  }
  const auto within = std::min<Eigen::Index>(count, static_cast<Eigen::Index>(T / dt + 1e-9) + 1);
  path.t_switch = SwitchTime(t.head(within), motion.v.topRows(within));
  return path;
}

}  // namespace springgrasp
