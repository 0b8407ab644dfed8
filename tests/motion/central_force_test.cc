// Eq. (7) and its extensions.
#include "motion/central_force.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "motion/dmp.h"
#include "motion/minimum_jerk.h"

namespace springgrasp {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// A straight minimum-jerk reach of 0.3 m in 1 s.
MotionSamples Reach() {
  MotionSamples out;
  out.t = EvenTimes(1.0, 0.01);
  out.x.resize(out.t.size(), 3);
  out.v = out.a = out.x;
  const VectorXd zero = VectorXd::Zero(3);
  const MinimumJerk line =
      MakeMinimumJerk({zero, zero, zero}, {Eigen::Vector3d(0.1, 0.2, -0.2), zero, zero}, 1.0);
  for (Index i = 0; i < out.t.size(); ++i) {
    const MotionState state = EvaluateMinimumJerk(line, out.t[i]);
    out.x.row(i) = state.x.transpose();
    out.v.row(i) = state.v.transpose();
    out.a.row(i) = state.a.transpose();
  }
  return out;
}

TEST(CentralForce, OpensBeforePeakSpeedAndClosesAfterIt) {
  const CentralForce force = MakeCentralForce(Reach(), 0.04);
  EXPECT_NEAR(force.t_switch, 0.5, 1e-12);
  EXPECT_LT(EvaluateCentralForce(force, 0.2), 0);
  EXPECT_GT(EvaluateCentralForce(force, 0.8), 0);
  // Peak acceleration of minimum jerk is 5.77 A / T^2.
  EXPECT_NEAR(EvaluateCentralForce(force, 0.79), 0.04 * 5.77 * 0.3, 0.001);
}

TEST(CentralForce, FirstOfEqualSpeedsDecides) {
  Eigen::MatrixXd v(4, 1);
  v << 0, 1, 1, 0;
  EXPECT_EQ(SwitchTime(Eigen::Vector4d(0, 0.1, 0.2, 0.3), v), 0.1);
}

TEST(CentralForce, DelayAndClosingGainShiftAndScaleIt) {
  const CentralForce plain = MakeCentralForce(Reach(), 0.04);
  CentralForce force = plain;
  force.delay = 0.2;
  force.beta = 3;
  for (double t = 0.005; t < 1.2; t += 0.01) {
    const double f = t < 0.2 ? 0 : EvaluateCentralForce(plain, t - 0.2);
    EXPECT_NEAR(EvaluateCentralForce(force, t), f > 0 ? 3 * f : f, 1e-12);
  }
}

TEST(CentralForce, HoldsAfterTheReach) {
  CentralForce force = MakeCentralForce(Reach(), 0.04);
  EXPECT_EQ(EvaluateCentralForce(force, 1.5), 0);
  force.hold = 0.02;
  EXPECT_EQ(EvaluateCentralForce(force, 1.5), 0.02);
  force.delay = 0.2;
  // The delayed closing force is still larger.
  EXPECT_GT(EvaluateCentralForce(force, 1.0), 0.02);
}

TEST(CentralForce, BlendingMakesTheSwitchContinuousAndLeavesTheRest) {
  MotionSamples curved = Reach();
  curved.a.rowwise() += Eigen::RowVector3d(0, 0.5, 0.5);
  CentralForce force = MakeCentralForce(curved, 0.04);
  const double t = force.t_switch;
  const double jump = EvaluateCentralForce(force, t) - EvaluateCentralForce(force, t - 1e-9);
  EXPECT_GT(jump, 0.01);
  const double before = EvaluateCentralForce(force, t - 0.1);
  force.blend = 0.05;
  EXPECT_LT(std::abs(EvaluateCentralForce(force, t) - EvaluateCentralForce(force, t - 1e-9)), 1e-6);
  EXPECT_EQ(EvaluateCentralForce(force, t - 0.1), before);
  EXPECT_LT(std::abs(EvaluateCentralForce(force, t)), 1e-12);
}

TEST(CentralForce, KinksCoverEveryJump) {
  CentralForce force = MakeCentralForce(Reach(), 0.04);
  force.a.array() += 1.0;
  force.delay = 0.137;
  force.hold = 0.05;
  const ForceProfile profile = MakeForceProfile(force);
  EXPECT_TRUE(std::is_sorted(profile.kinks.begin(), profile.kinks.end()));
  double last = profile.f(0);
  for (double t = 1e-4; t < 1.5; t += 1e-4) {
    const double f = profile.f(t);
    if (std::abs(f - last) > 0.01) {
      const bool near = std::any_of(profile.kinks.begin(), profile.kinks.end(),
                                    [&](double kink) { return std::abs(kink - t) < 2e-4; });
      EXPECT_TRUE(near) << "jump at " << t;
    }
    last = f;
  }
}

TEST(CentralForce, LagMovesTheSwitchOfOneFingerAlone) {
  CentralForce force = MakeCentralForce(Reach(), 0.04);
  force.blend = 0.1;
  force.delay = 0.1;
  force.hold = 0.02;
  force.ramp = true;
  force.lag = Eigen::Vector3d(0, -0.07, 0.05);
  const ForceProfile profile = MakeForceProfile(force);
  Eigen::VectorXd f(3);
  for (double t = 0; t < 1.5; t += 0.01) {
    profile.At(t, f);
    EXPECT_EQ(f[0], EvaluateCentralForce(force, t)) << t;
    for (int i = 1; i < 3; ++i) {
      CentralForce own = force;
      own.t_switch += force.lag[i];
      EXPECT_NEAR(f[i], EvaluateCentralForce(own, t), 1e-15) << t;
    }
  }
  profile.At(force.t_switch + 0.1 - 0.02, f);
  EXPECT_LT(f[0], 0);
  EXPECT_GT(f[1], 0);
  EXPECT_LT(f[2], 0);
  EXPECT_TRUE(std::is_sorted(profile.kinks.begin(), profile.kinks.end()));
}

TEST(ForceTable, IsLinearBetweenItsPointsAndHeldOutside) {
  for (const Eigen::Vector3d& t : {Eigen::Vector3d(0, 1, 2), Eigen::Vector3d(0, 0.1, 2)}) {
    const ForceProfile table = MakeForceProfile(t, Eigen::Vector3d(1, -1, 3));
    EXPECT_EQ(table.f(-5), 1);
    EXPECT_EQ(table.f(7), 3);
    EXPECT_NEAR(table.f(0.5 * t[1]), 0, 1e-12);
    EXPECT_NEAR(table.f(0.5 * (t[1] + t[2])), 1, 1e-12);
    EXPECT_EQ(table.f(t[1]), -1);
  }
  EXPECT_THROW(MakeForceProfile(Eigen::Vector3d(0, 2, 1), Eigen::Vector3d(0, 0, 0)), Error);
}

}  // namespace
}  // namespace springgrasp
