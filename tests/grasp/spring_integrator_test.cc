// The integrator: order, conserved quantities, scaling, and that it allocates nothing.
#include "grasp/spring_integrator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <new>

#include "base/error.h"
#include "grasp/spring_sensitivity.h"
#include "grasp/spring_test_systems.h"
#include "motion/dmp.h"
#include "motion/minimum_jerk.h"

namespace {
long allocations = 0;
}

void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace springgrasp {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kPi = 3.14159265358979323846;

// A smooth force without kinks.
ForceProfile SineForce(double amplitude, double period) {
  return {[=](double t) { return -amplitude * std::sin(2 * kPi * t / period); }, {}};
}

MatrixXd PointsAt(const MatrixXd& rows, Index i, int dim) {
  const Eigen::RowVectorXd row = rows.row(i);
  return Eigen::Map<const MatrixXd>(row.data(), dim, row.size() / dim);
}

double EndError(const SpringSystem& system, double h, const SpringTrajectory& reference) {
  const VectorXd times = Eigen::Vector2d(0, 0.8);
  const auto out = IntegrateSprings(system, SineForce(0.05, 1.0), GraspStart(system.dim),
                                    MatrixXd::Zero(system.dim, 5), times, {.step = h});
  return (out->p.row(1) - reference.p.row(1)).cwiseAbs().maxCoeff();
}

TEST(SpringIntegrator, ErrorFallsWithTheFourthPowerOfTheStep) {
  for (const int dim : {2, 3}) {
    const SpringSystem system = GraspSystem(true, dim);
    const VectorXd times = Eigen::Vector2d(0, 0.8);
    const auto reference =
        IntegrateSprings(system, SineForce(0.05, 1.0), GraspStart(dim), MatrixXd::Zero(dim, 5),
                         times, {.step = 2e-4, .tolerance = 1e-14});
    const double coarse = EndError(system, 0.01, *reference);
    const double fine = EndError(system, 0.005, *reference);
    const double finer = EndError(system, 0.0025, *reference);
    EXPECT_NEAR(std::log2(coarse / fine), 4, 0.4) << dim;
    EXPECT_NEAR(std::log2(fine / finer), 4, 0.4) << dim;
  }
}

TEST(SpringIntegrator, OrderIsFourForRandomSystems) {
  RandomEngine engine = MakeStream(4, 0, "order");
  std::vector<double> orders;
  for (int draw = 0; draw < 8; ++draw) {
    const int dim = draw % 2 ? 3 : 2;
    SpringSystem system = RandomSystem(engine, dim, dim == 2 ? "fan7" : "brace9");
    system.ratio = ForceRatio::kBalanced;
    // Clear of the contacts, whose soft norms need finer steps to show the order.
    system.involved.assign(5, draw % 4 < 2);
    const MatrixXd p = GraspStart(dim) + RandomPoints(engine, dim, 5, 0.01);
    system.anchors = 0.3 * p;
    const VectorXd times = Eigen::Vector2d(0, 0.3);
    const auto end = [&](double h) {
      return IntegrateSprings(system, SineForce(0.02, 0.6), p, MatrixXd::Zero(dim, 5), times,
                              {.step = h, .tolerance = 1e-15})
          ->p.row(1)
          .eval();
    };
    const Eigen::RowVectorXd reference = end(2e-4);
    const double coarse = (end(0.01) - reference).norm(), fine = (end(0.005) - reference).norm();
    orders.push_back(std::log2(coarse / fine));
  }
  std::sort(orders.begin(), orders.end());
  EXPECT_NEAR(orders[orders.size() / 2], 4, 0.25);
  EXPECT_GT(orders.front(), 3.4);
}

TEST(SpringIntegrator, KinksOfTheForceDoNotCostTheOrder) {
  const SpringSystem system = GraspSystem(true);
  // A force that jumps at 0.313 s, at no multiple of any step.
  const ForceProfile jump = {[](double t) { return t < 0.313 ? -0.05 : 0.05; }, {0.313}};
  const VectorXd times = Eigen::Vector2d(0, 0.8);
  const auto run = [&](double h) {
    return IntegrateSprings(system, jump, GraspStart(), MatrixXd::Zero(2, 5), times, {.step = h})
        ->p.row(1)
        .eval();
  };
  const Eigen::RowVectorXd reference = run(2e-4);
  const double coarse = (run(0.01) - reference).cwiseAbs().maxCoeff();
  const double fine = (run(0.005) - reference).cwiseAbs().maxCoeff();
  EXPECT_GT(coarse / fine, 11);
  EXPECT_LT(fine, 1e-6);
}

TEST(SpringIntegrator, MomentumIsKeptWithoutContactsAndAngularMomentumWithAxialDampers) {
  RandomEngine engine = MakeStream(5, 0, "momentum");
  for (int draw = 0; draw < 20; ++draw) {
    const int dim = draw % 2 ? 3 : 2;
    SpringSystem system = RandomSystem(engine, dim, "full10");
    system.involved.assign(5, false);
    system.damping = draw % 3 == 0   ? SpringDamping::kVector
                     : draw % 3 == 1 ? SpringDamping::kAxial
                                     : SpringDamping::kLiteral;
    const auto out = IntegrateSprings(system, SineForce(0.1, 1), RandomPoints(engine, dim, 5, 0.06),
                                      RandomPoints(engine, dim, 5, 0.2), EvenTimes(0.5, 0.1));
    ASSERT_TRUE(out);
    const auto momentum = [&](Index i) { return VectorXd(PointsAt(out->v, i, dim) * system.mass); };
    const auto spin = [&](Index i) {
      const MatrixXd p = PointsAt(out->p, i, dim), v = PointsAt(out->v, i, dim);
      double sum = 0;
      for (int k = 0; k < 5; ++k) {
        sum += system.mass[k] * (p(0, k) * v(1, k) - p(1, k) * v(0, k));
      }
      return sum;
    };
    for (Index i = 1; i < out->t.size(); ++i) {
      EXPECT_LT((momentum(i) - momentum(0)).norm(), 1e-13);
      if (system.damping == SpringDamping::kAxial) {
        EXPECT_NEAR(spin(i), spin(0), 1e-8);
      }
    }
  }
}

TEST(SpringIntegrator, EnergyNeverGrowsWithoutForce) {
  RandomEngine engine = MakeStream(6, 0, "energy");
  for (int draw = 0; draw < 20; ++draw) {
    const int dim = draw % 2 ? 3 : 2;
    SpringSystem system = RandomSystem(engine, dim, "full10");
    system.damping = draw % 3 ? SpringDamping::kAxial : SpringDamping::kVector;
    if (draw % 4 == 0) system.rest_radius.setConstant(0.03);
    const auto out = IntegrateSprings(system, ConstantForce(0), RandomPoints(engine, dim, 5, 0.06),
                                      RandomPoints(engine, dim, 5, 0.2), EvenTimes(1.0, 0.01));
    ASSERT_TRUE(out);
    double last = SpringEnergy(system, PointsAt(out->p, 0, dim), PointsAt(out->v, 0, dim));
    for (Index i = 1; i < out->t.size(); ++i) {
      const double energy =
          SpringEnergy(system, PointsAt(out->p, i, dim), PointsAt(out->v, i, dim));
      EXPECT_LE(energy, last + 1e-9);
      last = energy;
    }
  }
}

TEST(SpringIntegrator, ScalingLengthsScalesTheSolution) {
  RandomEngine engine = MakeStream(7, 0, "length");
  for (int draw = 0; draw < 10; ++draw) {
    const int dim = draw % 2 ? 3 : 2;
    const double s = Uniform(engine, 0.5, 2);
    const SpringSystem system = RandomSystem(engine, dim, "fan7");
    SpringSystem scaled = system;
    scaled.anchors *= s;
    scaled.eps_c *= s;
    scaled.eps_s *= s;
    for (Spring& spring : scaled.springs) spring.l *= s;
    const MatrixXd p = RandomPoints(engine, dim, 5, 0.06), v = RandomPoints(engine, dim, 5, 0.1);
    const VectorXd times = EvenTimes(0.5, 0.1);
    const auto a = IntegrateSprings(system, SineForce(0.03, 1), p, v, times);
    const auto b = IntegrateSprings(scaled, SineForce(0.03 * s, 1), s * p, s * v, times);
    ASSERT_TRUE(a && b);
    EXPECT_LT((s * a->p - b->p).cwiseAbs().maxCoeff(), 1e-10);
  }
}

TEST(SpringIntegrator, ScalingTimeKeepsThePath) {
  RandomEngine engine = MakeStream(8, 0, "time");
  for (int draw = 0; draw < 10; ++draw) {
    const double T = Uniform(engine, 0.5, 2);
    const SpringSystem system = RandomSystem(engine, 2, "fan7");
    SpringSystem slow = system;
    for (Spring& spring : slow.springs) {
      spring.k /= T * T;
      spring.d /= T;
    }
    slow.kc /= T * T;
    slow.dc /= T;
    const MatrixXd p = RandomPoints(engine, 2, 5, 0.06), v = RandomPoints(engine, 2, 5, 0.1);
    const VectorXd times = EvenTimes(0.5, 0.1);
    const auto a = IntegrateSprings(system, SineForce(0.03, 1), p, v, times);
    const auto b = IntegrateSprings(slow, SineForce(0.03 / (T * T), T), p, v / T, T * times,
                                    {.step = 0.005 * T});
    ASSERT_TRUE(a && b);
    EXPECT_LT((a->p - b->p).cwiseAbs().maxCoeff(), 1e-9);
  }
}

TEST(SpringIntegrator, StiffDampersAreNoTrouble) {
  SpringSystem system = GraspSystem(true);
  system.dc = 2 * 20 * std::sqrt(system.kc * 0.02);  // zeta 20: |lambda| 2700 1/s
  const VectorXd times = EvenTimes(1.0, 0.05);
  const auto coarse = IntegrateSprings(system, SineForce(0.05, 1.0), GraspStart(),
                                       MatrixXd::Zero(2, 5), times, {.step = 0.01});
  const auto fine = IntegrateSprings(system, SineForce(0.05, 1.0), GraspStart(),
                                     MatrixXd::Zero(2, 5), times, {.step = 5e-4});
  ASSERT_TRUE(coarse && fine);
  EXPECT_LT((coarse->p - fine->p).cwiseAbs().maxCoeff(), 1e-5);
}

TEST(SpringIntegrator, RunawayParametersGiveNothing) {
  SpringSystem system = GraspSystem(true);
  system.kc = -20;  // grows by e every 0.05 s
  EXPECT_FALSE(IntegrateSprings(system, ConstantForce(0), GraspStart(), MatrixXd::Zero(2, 5),
                                EvenTimes(60, 20), {.step = 0.01}));
}

// The matrix of Newton's method and its starting point are carried over from step to step: that
// must show only in the time it takes.
TEST(SpringIntegrator, WhatIsCarriedOverBetweenStepsDoesNotShow) {
  RandomEngine engine = MakeStream(12, 0, "spring_integrator_test");
  const ForceProfile force = MakeForceProfile(ReachForce(0.04, 0.01));
  for (int n = 0; n < 20; ++n) {
    const int dim = 2 + n % 2;
    const SpringSystem system = RandomSystem(engine, dim, dim == 2 ? "fan7" : "brace9");
    MatrixXd p = RandomPoints(engine, dim, 5, 0.1), v = MatrixXd::Zero(dim, 5);
    MatrixXd p_fresh = p, v_fresh = v;
    SpringStepper stepper(system);
    double t = 0;
    for (int i = 0; i < 80; ++i) {
      const double h = i % 7 == 3 ? 0.0031 : 0.01;
      ASSERT_TRUE(stepper.Step(force, t, h, p, v));
      SpringStepper fresh(system);
      ASSERT_TRUE(fresh.Step(force, t, h, p_fresh, v_fresh));
      t += h;
    }
    EXPECT_LT((p - p_fresh).cwiseAbs().maxCoeff(), 1e-10);
  }
}

TEST(SpringIntegrator, StepsAllocateNothing) {
  for (const int dim : {2, 3}) {
    const SpringSystem system = GraspSystem(true, dim);
    const ForceProfile force = MakeForceProfile(ReachForce(0.04, 0.005));
    SpringStepper stepper(system);
    MatrixXd p = GraspStart(dim), v = MatrixXd::Zero(dim, 5);
    ASSERT_TRUE(stepper.Step(force, 0, 0.005, p, v));
    const long before = allocations;
    for (int i = 1; i < 100; ++i) stepper.Step(force, 0.005 * i, 0.005, p, v);
    EXPECT_EQ(allocations, before);
  }
}

class SensitivitiesTest : public testing::TestWithParam<bool> {};

TEST_P(SensitivitiesTest, AgreeWithCentralDifferences) {
  SpringSystem system = GraspSystem(true);
  CentralForce force = ReachForce(0.04, 0.005);
  if (GetParam()) {  // as profile human has it
    RandomEngine engine = MakeStream(13, 0, "spring_integrator_test");
    system.ratio = ForceRatio::kBalanced;
    system.opening = OpeningDirection::kOutward;
    system.normals = RandomPoints(engine, 2, 5, 1.0);
    system.opening_bend = RandomPoints(engine, 2, 5, 4.0);
    system.bend = RandomPoints(engine, 2, 5, 4.0);
    force.lag = 0.05 * RandomPoints(engine, 5, 1, 1.0);
  }
  force.blend = 0.1;
  force.delay = 0.1;
  force.beta = 1.5;
  const SpringParameters parameters = {
      {SpringGain::kGamma, SpringGain::kBeta, SpringGain::kDelay, SpringGain::kSwitch,
       SpringGain::kDamping, SpringGain::kContact, SpringGain::kContactDamping},
      true};
  const VectorXd times = EvenTimes(1.2, 0.1);
  const MatrixXd p0 = GraspStart(), v0 = MatrixXd::Constant(2, 5, 0.01);
  MatrixXd dp;
  // Derivatives leave out that kinks move with the switch, so both need fine steps.
  const SpringIntegration options = {.step = 0.002, .tolerance = 1e-14};
  ASSERT_TRUE(IntegrateWithSensitivities(system, force, parameters, p0, v0, times, options, dp));
  const auto run = [&](Index parameter, double change) {
    SpringSystem s = system;
    CentralForce f = force;
    MatrixXd p = p0, v = v0;
    const Index E = 7;
    if (parameter < E) s.springs[static_cast<std::size_t>(parameter)].k += change;
    if (parameter == E) f.gamma *= std::exp(change);
    if (parameter == E + 1) f.beta *= std::exp(change);
    if (parameter == E + 2) f.delay += change;
    if (parameter == E + 3) f.t_switch += change;
    if (parameter == E + 4) {
      for (Spring& spring : s.springs) spring.d *= std::exp(change);
    }
    if (parameter == E + 5) s.kc *= std::exp(change);
    if (parameter == E + 6) s.dc *= std::exp(change);
    if (parameter >= E + 7 && parameter < E + 17) p.reshaped()[parameter - E - 7] += change;
    if (parameter >= E + 17) v.reshaped()[parameter - E - 17] += change;
    const auto out = IntegrateSprings(s, MakeForceProfile(f), p, v, times, options);
    return MatrixXd(out->p.transpose());
  };
  for (Index q = 0; q < dp.cols(); ++q) {
    const double h = 1e-4;
    const VectorXd numeric = ((run(q, h) - run(q, -h)) / (2 * h)).reshaped();
    EXPECT_LT((dp.col(q) - numeric).norm(), 2e-3 * numeric.norm()) << "parameter " << q;
  }
}

INSTANTIATE_TEST_SUITE_P(PaperAndHuman, SensitivitiesTest, testing::Bool());

}  // namespace
}  // namespace springgrasp
