// Spring constants from fingertips: exact data give them back, noisy data as well as can be.
#include "grasp/spring_estimation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/random.h"
#include "grasp/spring_test_systems.h"
#include "motion/dmp.h"

namespace springgrasp {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd TrueConstants(const SpringSystem& system) {
  VectorXd k(static_cast<Index>(system.springs.size()));
  for (Index e = 0; e < k.size(); ++e) k[e] = system.springs[static_cast<std::size_t>(e)].k;
  return k;
}

// A demonstration by the model itself, with exact derivatives; noise on the positions.
SpringObservation Demonstrate(const SpringSystem& system, const CentralForce& force, double rate,
                              double duration, double noise, RandomEngine& engine,
                              bool derivatives) {
  SpringObservation o;
  o.system = system;
  o.force = force;
  o.t = EvenTimes(duration, 1 / rate);
  const auto truth = IntegrateSprings(system, MakeForceProfile(force), GraspStart(system.dim),
                                      MatrixXd::Zero(system.dim, 5), o.t, {.step = 0.004});
  o.p = truth->p;
  if (derivatives) {
    o.v = truth->v;
    o.a = truth->v;
    SpringTerms terms;
    for (Index i = 0; i < o.t.size(); ++i) {
      const Eigen::RowVectorXd p = truth->p.row(i), v = truth->v.row(i);
      EvaluateSprings(system, Eigen::Map<const MatrixXd>(p.data(), system.dim, 5),
                      Eigen::Map<const MatrixXd>(v.data(), system.dim, 5),
                      EvaluateCentralForce(force, o.t[i]), terms);
      o.a.row(i) = terms.acc.reshaped().transpose();
    }
  }
  for (double& x : o.p.reshaped()) x += noise * Normal(engine);
  return o;
}

double RelativeError(const VectorXd& k, const VectorXd& truth) {
  return (k - truth).norm() / truth.norm();
}

double Median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

TEST(SpringEstimation, ExactDataGiveTheConstantsBackByRegressionAlone) {
  RandomEngine engine = MakeStream(1, 0, "exact");
  for (const int dim : {2, 3}) {
    for (const bool power : {true, false}) {
      const SpringSystem system = GraspSystem(power, dim);
      const auto o = Demonstrate(system, ReachForce(0.04, 0.01), 30, 1.5, 0, engine, true);
      const SpringEstimate estimate = EstimateSprings({o}, {.trajectory_fit = false});
      EXPECT_LT(RelativeError(estimate.linear.k, TrueConstants(system)), 1e-8);
      EXPECT_LT(RelativeError(estimate.k_non_negative, TrueConstants(system)), 1e-8);
      EXPECT_EQ(estimate.linear.rank, static_cast<int>(system.springs.size()));
      EXPECT_LT(estimate.linear.condition_number, 100);
      EXPECT_TRUE(estimate.remarks.empty());
    }
  }
}

TEST(SpringEstimation, TrajectoryFitFindsTheConstantsFromPositionsAlone) {
  RandomEngine engine = MakeStream(2, 0, "positions");
  for (const int dim : {2, 3}) {
    const SpringSystem system = GraspSystem(true, dim);
    const auto o = Demonstrate(system, ReachForce(0.04, 0.01), 23, 1.5, 0, engine, false);
    // With the demonstration's own step nothing but the constants is left to be found.
    const SpringEstimate exact = EstimateSprings({o}, {.step = 0.004});
    EXPECT_LT(RelativeError(exact.k, TrueConstants(system)), 1e-6);
    EXPECT_LT(exact.finger_rmse[0].maxCoeff(), 1e-8);
    EXPECT_TRUE(exact.converged);
    const SpringEstimate coarse = EstimateSprings({o});
    EXPECT_LT(RelativeError(coarse.k, TrueConstants(system)), 1e-2);
  }
}

TEST(SpringEstimation, TrajectoryFitBeatsTheRegressionOnNoisyData) {
  const VectorXd truth = TrueConstants(GraspSystem(true));
  for (const bool power : {true, false}) {
    std::vector<double> linear, fitted;
    int inside = 0, free = 0;
    for (std::uint64_t draw = 0; draw < 4; ++draw) {
      RandomEngine engine = MakeStream(3, draw, "noise");
      const auto o =
          Demonstrate(GraspSystem(power), ReachForce(0.04, 0.01), 23, 1.5, 0.001, engine, false);
      const SpringEstimate estimate = EstimateSprings({o}, {.step = 0.01});
      linear.push_back(RelativeError(estimate.linear.k, truth));
      fitted.push_back(RelativeError(estimate.k, truth));
      EXPECT_NEAR(estimate.noise, 0.001, 0.0002);
      for (Index e = 0; e < truth.size(); ++e) {
        if (estimate.k[e] <= 0) continue;
        ++free;
        inside += std::abs(estimate.k[e] - truth[e]) < 1.96 * estimate.standard_error[e];
      }
    }
    RecordProperty(power ? "power_linear" : "pinch_linear", std::to_string(Median(linear)));
    RecordProperty(power ? "power_fitted" : "pinch_fitted", std::to_string(Median(fitted)));
    EXPECT_LT(Median(fitted), 0.6 * Median(linear));
    EXPECT_LT(Median(fitted), 0.3);
    EXPECT_GT(inside, 0.8 * free);
  }
}

TEST(SpringEstimation, GainDelayClosingAndSwitchAreFoundTogetherWithTheConstants) {
  RandomEngine engine = MakeStream(4, 0, "gains");
  const SpringSystem system = GraspSystem(true);
  CentralForce force = ReachForce(0.05, 0.01);
  force.delay = 0.12;
  force.beta = 2;
  force.blend = 0.05;
  force.t_switch = 0.45;
  SpringObservation o = Demonstrate(system, force, 50, 1.5, 0, engine, false);
  o.force.gamma = 0.03;
  o.force.delay = 0.05;
  o.force.beta = 1;
  o.force.t_switch = 0.5;
  const SpringEstimate estimate =
      EstimateSprings({o}, {.fit = {.gamma = true, .beta = true, .delay = true, .t_switch = true},
                            .max_iterations = 100});
  EXPECT_NEAR(estimate.gamma, 0.05, 0.002);
  EXPECT_NEAR(estimate.delay, 0.12, 0.005);
  EXPECT_NEAR(estimate.beta, 2, 0.1);
  EXPECT_NEAR(estimate.t_switch, 0.45, 0.01);
  EXPECT_LT(estimate.finger_rmse[0].maxCoeff(), 1e-4);
  EXPECT_LT(RelativeError(estimate.k, TrueConstants(system)), 0.1);
}

TEST(SpringEstimation, PoolingDemonstrationsReducesTheError) {
  const SpringSystem system = GraspSystem(true);
  const EstimationOptions coarse = {.step = 0.01};
  std::vector<double> single, pooled;
  for (std::uint64_t draw = 0; draw < 3; ++draw) {
    RandomEngine engine = MakeStream(5, draw, "pool");
    std::vector<SpringObservation> observations;
    for (int i = 0; i < 3; ++i) {
      observations.push_back(
          Demonstrate(system, ReachForce(0.03 + 0.01 * i, 0.01), 23, 1.5, 0.001, engine, false));
    }
    single.push_back(
        RelativeError(EstimateSprings({observations[0]}, coarse).k, TrueConstants(system)));
    pooled.push_back(RelativeError(EstimateSprings(observations, coarse).k, TrueConstants(system)));
  }
  EXPECT_LT(Median(pooled), Median(single));
}

TEST(SpringEstimation, MissingSamplesAreLeftOut) {
  RandomEngine engine = MakeStream(6, 0, "missing");
  const SpringSystem system = GraspSystem(true);
  auto o = Demonstrate(system, ReachForce(0.04, 0.01), 50, 1.5, 0, engine, true);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  o.p_smooth = o.p;
  for (Index i = 10; i < 25; ++i) {
    o.p.row(i).segment(4, 2).setConstant(nan);
    o.p_smooth.row(i).segment(4, 2).setConstant(nan);
  }
  const SpringEstimate estimate = EstimateSprings({o}, {.step = 0.004});
  EXPECT_LT(RelativeError(estimate.linear.k, TrueConstants(system)), 1e-8);
  EXPECT_LT(RelativeError(estimate.k, TrueConstants(system)), 1e-6);
}

TEST(SpringEstimation, AnUndeterminedConstantIsSaidPlainly) {
  RandomEngine engine = MakeStream(7, 0, "undetermined");
  SpringSystem system = GraspSystem(true);
  // A rigid pair: both at rest on their contacts, so the spring between them never stretches.
  auto o = Demonstrate(system, ReachForce(0.04, 0.01), 30, 1.5, 0, engine, true);
  for (Index i = 0; i < o.t.size(); ++i) {
    const Eigen::RowVector2d ring = o.p.row(i).segment(6, 2), pinkie = o.p.row(i).segment(8, 2);
    const double now = (ring - pinkie).norm();
    const double l = system.springs[6].l;
    o.p.row(i).segment(8, 2) = ring + (pinkie - ring) * (l / now);
  }
  o.system.eps_s = 1e-9;
  const SpringEstimate estimate = EstimateSprings({o}, {.trajectory_fit = false});
  ASSERT_FALSE(estimate.remarks.empty());
  EXPECT_NE(estimate.remarks.back().find("ring-pinkie"), std::string::npos);
}

TEST(SpringEstimation, NonNegativeSolutionMeetsTheOptimalityConditions) {
  RandomEngine engine = MakeStream(8, 0, "nnls");
  for (int draw = 0; draw < 50; ++draw) {
    MatrixXd X(30, 8);
    VectorXd b(30);
    for (double& x : X.reshaped()) x = Normal(engine);
    for (double& x : b) x = Normal(engine);
    const VectorXd k = SolveNonNegative(X, b);
    const VectorXd gradient = X.transpose() * (X * k - b);
    EXPECT_GE(k.minCoeff(), 0);
    for (Index i = 0; i < k.size(); ++i) {
      if (k[i] > 0) {
        EXPECT_NEAR(gradient[i], 0, 1e-9);
      } else {
        EXPECT_GE(gradient[i], -1e-9);
      }
    }
  }
}

TEST(SpringEstimation, UnusableInputIsRefused) {
  RandomEngine engine = MakeStream(9, 0, "refuse");
  const SpringSystem system = GraspSystem(true);
  const auto good = Demonstrate(system, ReachForce(0.04, 0.01), 23, 1.0, 0, engine, false);
  EXPECT_THROW(EstimateSprings({}), Error);
  auto bad = good;
  bad.t[3] = bad.t[2];
  EXPECT_THROW(EstimateSprings({bad}), Error);
  bad = good;
  bad.p.col(4).setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_THROW(EstimateSprings({bad}), Error);
  bad = good;
  bad.system.springs.pop_back();
  EXPECT_THROW(EstimateSprings({good, bad}), Error);
}

}  // namespace
}  // namespace springgrasp
