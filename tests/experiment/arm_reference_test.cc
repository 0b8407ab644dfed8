#include "experiment/arm_reference.h"

#include <gtest/gtest.h>

#include <cmath>

#include "kinematics/test_arm.h"

namespace springgrasp {
namespace {

TEST(ArmReferenceTest, GivesPositionVelocityAndAccelerationOfTheSampledPath) {
  std::vector<ArmVector> path;
  const double dt = 0.005;
  for (int i = 0; i <= 200; ++i) path.push_back(ArmVector::Constant(std::sin(3 * i * dt)));
  for (const double t : {0.2, 0.333, 0.5, 0.71}) {
    const ArmTarget target = ArmReferenceAt(path, dt, t);
    EXPECT_NEAR(target.q[3], std::sin(3 * t), 1e-4);
    EXPECT_NEAR(target.qd[3], 3 * std::cos(3 * t), 1e-3);
    EXPECT_NEAR(target.qdd[3], -9 * std::sin(3 * t), 1e-2);
  }
}

TEST(ArmReferenceTest, RestsBeyondTheEnd) {
  const std::vector<ArmVector> path(10, ArmVector::Constant(0.4));
  const ArmTarget target = ArmReferenceAt(path, 0.01, 5);
  EXPECT_EQ(target.q[0], 0.4);
  EXPECT_EQ(target.qd[0], 0);
  EXPECT_EQ(target.qdd[0], 0);
}

TEST(ArmReferenceTest, HandAnglesAreInterpolated) {
  const std::vector<HandVector> path = {HandVector::Constant(11, 0), HandVector::Constant(11, 1)};
  EXPECT_NEAR(HandReferenceAt(path, 0.1, 0.025).q[2], 0.25, 1e-12);
  EXPECT_EQ(HandReferenceAt(path, 0.1, 9).q[2], 1);
  EXPECT_EQ(HandReferenceAt(path, 0.1, 9).qd[2], 0);
}

TEST(ArmReferenceTest, TheLoadsTorqueIsTheGradientOfItsPotentialEnergy) {
  const Arm& arm = TestArm();
  const ArmVector q = HomePosture(arm);
  Pose X_HO = Pose::Identity();
  X_HO.translation() = Eigen::Vector3d(0.1, 0.02, -0.03);
  const auto energy = [&](const ArmVector& at) {
    return 0.3 * 9.81 * (HandPose(arm, at) * X_HO).translation().z();
  };
  const ArmVector torque = LoadTorque(arm, q, X_HO, 0.3);
  EXPECT_GT(torque.norm(), 0.1);
  for (int i = 0; i < arm.num_joints(); ++i) {
    const ArmVector step = 1e-5 * ArmVector::Unit(i);
    EXPECT_NEAR(torque[i], (energy(q + step) - energy(q - step)) / 2e-5, 1e-6) << i;
  }
}

}  // namespace
}  // namespace springgrasp
