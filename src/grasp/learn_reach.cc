#include "grasp/learn_reach.h"

#include <algorithm>
#include <cmath>

#include "motion/central_force.h"
#include "motion/minimum_jerk.h"
#include "motion/smoothing.h"

namespace springgrasp {

using Eigen::MatrixXd;
using Eigen::VectorXd;

LearnedReach LearnReach(const std::vector<Pose>& X_OG, double dt, int basis_functions) {
  const Eigen::Quaterniond R_goal(X_OG.back().linear());
  const auto count = static_cast<Eigen::Index>(X_OG.size());
  const VectorXd t = VectorXd::LinSpaced(count, 0, static_cast<double>(count - 1) * dt);
  const MotionSamples measured = DifferentiateSamples(t, PoseCoordinates(X_OG, R_goal));
  const CompletedMotion completed = CompleteToRest(measured);

  LearnedReach reach;
  reach.lead = completed.begin;
  reach.tail = completed.end;
  reach.T = completed.samples.t[completed.samples.size() - 1];
  DmpOptions options;
  options.num_basis = basis_functions;
  options.tau = reach.T;
  reach.dmp = LearnPoseDmp(completed.samples, R_goal, options);
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
