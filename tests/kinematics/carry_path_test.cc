#include "kinematics/carry_path.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "kinematics/arm_choice.h"
#include "test_arm.h"

namespace springgrasp {
namespace {

CarryRequest FromHome() {
  CarryRequest request;
  request.q = HomePosture(TestArm());
  request.X_WH = HandPose(TestArm(), request.q);
  return request;
}

// Largest acceleration of any joint, rad/s^2.
double LargestAcceleration(const std::vector<Eigen::VectorXd>& q, double dt) {
  double most = 0;
  for (std::size_t k = 1; k + 1 < q.size(); ++k) {
    most = std::max(most, (q[k + 1] - 2 * q[k] + q[k - 1]).cwiseAbs().maxCoeff() / (dt * dt));
  }
  return most;
}

void ExpectWithinRanges(const std::vector<Eigen::VectorXd>& path, double margin) {
  const Arm& arm = TestArm();
  for (const Eigen::VectorXd& q : path) {
    for (int i = 0; i < arm.num_joints(); ++i) {
      EXPECT_GE(q[i], arm.tree.lower[arm.joints[i]] + margin - 1e-9);
      EXPECT_LE(q[i], arm.tree.upper[arm.joints[i]] - margin + 1e-9);
    }
  }
}

TEST(CarryPathTest, LiftsAndShakesFromAndToRestWithJointsAsSmoothAsTheHand) {
  const CarryRequest request = FromHome();
  const CarryPath carry = PlanCarry(TestArm(), request);
  ASSERT_TRUE(carry.complete) << carry.reason;
  EXPECT_LT((carry.lift.front() - request.q).norm(), 1e-9);
  const Pose X_lifted = HandPose(TestArm(), carry.lift.back());
  EXPECT_NEAR(X_lifted.translation().z() - request.X_WH.translation().z(), request.lift, 1e-6);
  // The hand's own is 5 m/s^2 when the shake fades in; the arm is about half a metre long.
  EXPECT_LT(LargestAcceleration(carry.lift, request.dt), 10);
  for (int axis = 0; axis < 3; ++axis) {
    const auto& shake = carry.shake[axis];
    EXPECT_LT((shake.front() - carry.lift.back()).norm(), 1e-6);
    EXPECT_LT((shake.back() - carry.lift.back()).norm(), 1e-6);
    EXPECT_LT(LargestAcceleration(shake, request.dt), 60);
    double most = 0;
    for (const Eigen::VectorXd& q : shake) {
      const Eigen::Vector3d moved = HandPose(TestArm(), q).translation() - X_lifted.translation();
      most = std::max(most, std::abs(moved[axis]));
      EXPECT_NEAR(moved.norm(), std::abs(moved[axis]), 1e-6);
    }
    EXPECT_NEAR(most, request.shake, 0.1 * request.shake);
    ExpectWithinRanges(shake, request.margin);
  }
}

// A swivel at the end of its interval cannot be kept while the hand moves; the parabola turns the
// elbow with the hand.
TEST(CarryPathTest, NearALimitTheElbowTurnsWithTheHand) {
  const CarryRequest request = FromHome();
  const ArmGeometry geometry = *GeometryOf(TestArm());
  ArmSolutions solutions;
  solutions.Solve(geometry, request.X_WH, 0.02);
  int turned = 0, kept = 0;
  for (const SwivelInterval& interval : solutions.intervals()) {
    for (const double swivel : {interval.from + 1e-3, interval.to - 1e-3}) {
      ShakePostures shake(geometry, request.X_WH, {0, 0, 0.02}, 0.4, 0.02);
      if (shake.Fit(interval, swivel) == std::numeric_limits<double>::infinity()) continue;
      std::vector<Eigen::VectorXd> path;
      for (int i = -50; i <= 50; ++i) path.push_back(shake.At(0.02 * i));
      ExpectWithinRanges(path, 0.02);
      EXPECT_LT(LargestAcceleration(path, 0.02), 1);  // rad per unit of the displacement, squared
      ++(path.front().isApprox(path.back(), 1e-3) ? kept : turned);
    }
  }
  EXPECT_GT(turned, 0);
  EXPECT_EQ(kept, 0);
}

TEST(CarryPathTest, WhatCannotBeLiftedIsAValueWithAReason) {
  CarryRequest request = FromHome();
  request.lift = 2;
  const CarryPath carry = PlanCarry(TestArm(), request);
  EXPECT_FALSE(carry.complete);
  EXPECT_NE(carry.reason.find("lifting"), std::string::npos);
}

}  // namespace
}  // namespace springgrasp
