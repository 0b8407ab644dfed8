// What is learned frame by frame is what is learned at once.
#include "grasp/spring_online.h"

#include <gtest/gtest.h>

#include "base/random.h"
#include "grasp/spring_test_systems.h"

namespace springgrasp {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

TEST(OnlineRegression, EqualsTheBatchSolutionForRandomRows) {
  RandomEngine engine = MakeStream(31, 0, "online");
  for (int draw = 0; draw < 20; ++draw) {
    const Index E = 7 + 2 * (draw % 2), per_frame = 15;
    OnlineRegression online(E);
    MatrixXd X(60 * per_frame, E);
    VectorXd b(X.rows());
    // Columns of very different size, as springs near their rest length make them.
    for (Index e = 0; e < E; ++e) {
      const double size = std::pow(10.0, Uniform(engine, -4, 0));
      for (Index i = 0; i < X.rows(); ++i) X(i, e) = size * Normal(engine);
    }
    for (double& x : b) x = Normal(engine);
    for (Index frame = 0; frame < 60; ++frame) {
      online.Add(X.middleRows(frame * per_frame, per_frame),
                 b.segment(frame * per_frame, per_frame));
    }
    const SpringRegression batch = SolveRegression(X, b, 1e-10);
    const SpringRegression result = online.Solve();
    EXPECT_LT((result.k - batch.k).norm(), 1e-9 * batch.k.norm());
    EXPECT_LT((result.standard_error - batch.standard_error).norm(),
              1e-9 * batch.standard_error.norm());
    EXPECT_NEAR(result.condition_number, batch.condition_number, 1e-9 * batch.condition_number);
    EXPECT_NEAR(result.residual, batch.residual, 1e-9 * batch.residual);
    const VectorXd non_negative = SolveNonNegative(X, b);
    EXPECT_LT((online.SolveNonNegative() - non_negative).norm(), 1e-9 * (1 + non_negative.norm()));
  }
}

TEST(OnlineEstimation, EqualsTheBatchEstimateOfTheSameFrames) {
  RandomEngine engine = MakeStream(32, 0, "online");
  for (const int dim : {2, 3}) {
    for (const bool power : {true, false}) {
      const SpringSystem system = GraspSystem(power, dim);
      const CentralForce force = ReachForce(0.04, 0.01);
      SpringObservation o;
      o.system = system;
      o.force = force;
      o.t = EvenTimes(1.5, 1.0 / 50);
      o.p = IntegrateSprings(system, MakeForceProfile(force), GraspStart(dim),
                             MatrixXd::Zero(dim, 5), o.t)
                ->p;
      for (double& x : o.p.reshaped()) x += 0.0005 * Normal(engine);
      OnlineEstimation online(system);
      for (Index i = 0; i < o.t.size(); ++i) {
        const Eigen::RowVectorXd p = o.p.row(i);
        online.AddFrame(o.t[i], Eigen::Map<const MatrixXd>(p.data(), dim, 5),
                        EvaluateCentralForce(force, o.t[i]));
      }
      // The batch over the same states.
      const Index window = 2 * online.lag() + 1, count = o.t.size() - window + 1;
      SpringObservation batch = o;
      batch.t = o.t.segment(online.lag(), count);
      batch.p = o.p.middleRows(online.lag(), count);
      batch.p_smooth = batch.v = batch.a = batch.p;
      for (Index i = 0; i < count; ++i) {
        const MatrixXd state = StateOfWindow(o.t.segment(i, window), o.p.middleRows(i, window));
        batch.p_smooth.row(i) = state.row(0);
        batch.v.row(i) = state.row(1);
        batch.a.row(i) = state.row(2);
      }
      const SpringEstimate estimate = EstimateSprings({batch}, {.trajectory_fit = false});
      const SpringRegression result = online.regression().Solve();
      EXPECT_LT((result.k - estimate.linear.k).cwiseAbs().maxCoeff(), 1e-9);
      EXPECT_LT(
          (online.regression().SolveNonNegative() - estimate.k_non_negative).cwiseAbs().maxCoeff(),
          1e-9);
    }
  }
}

TEST(OnlineEstimation, ConvergesToTheTrueConstantsOnCleanFrames) {
  const SpringSystem system = GraspSystem(true, 3);
  const CentralForce force = ReachForce(0.04, 0.01);
  const VectorXd t = EvenTimes(1.5, 0.004);
  const auto truth =
      IntegrateSprings(system, MakeForceProfile(force), GraspStart(3), MatrixXd::Zero(3, 5), t);
  OnlineEstimation online(system);
  for (Index i = 0; i < t.size(); ++i) {
    const Eigen::RowVectorXd p = truth->p.row(i);
    online.AddFrame(t[i], Eigen::Map<const MatrixXd>(p.data(), 3, 5),
                    EvaluateCentralForce(force, t[i]));
  }
  const SpringRegression result = online.regression().Solve();
  for (std::size_t e = 0; e < system.springs.size(); ++e) {
    EXPECT_NEAR(result.k[static_cast<Index>(e)], system.springs[e].k, 0.03 * system.springs[e].k);
  }
}

}  // namespace
}  // namespace springgrasp
