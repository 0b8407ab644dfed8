#include "control/grip.h"

#include <gtest/gtest.h>

#include "control/toy_hand.h"

namespace springgrasp {
namespace {

TEST(GripTest, FingertipGripDoesNoWorkWhenTheHandTurnsAsAWhole) {
  // Internal forces: their virtual work for a common displacement of all pads along z is zero.
  const KinematicTree tree = ToyHand();
  FingertipGrip grip;
  grip.involved = {true, true, true, false, false};
  const HandVector q = HandVector::Constant(11, 0.2);
  const HandVector torque =
      FingertipGripTorque(tree, {0, 1, 2, 3, 4}, BodiesAt(tree, q), grip).torque;
  EXPECT_GT(torque.cwiseAbs().maxCoeff(), 0.05);
  EXPECT_EQ(torque[7], 0);   // ring
  EXPECT_EQ(torque[10], 0);  // pinkie
}

TEST(GripTest, FingertipGripTorqueIsTheGradientOfTheDistanceBetweenTheOpposedPads) {
  const KinematicTree tree = ToyHand();
  FingertipGrip grip;
  grip.involved = {true, true, false, false, false};
  grip.force = 2;
  const HandVector q = HandVector::LinSpaced(11, -0.2, 0.4);
  const HandVector torque =
      FingertipGripTorque(tree, {0, 1, 2, 3, 4}, BodiesAt(tree, q), grip).torque;
  const auto distance = [&](const HandVector& at) {
    std::vector<Pose> X;
    ForwardKinematics(tree, at, X);
    return (FramePose(tree, X, 0).translation() - FramePose(tree, X, 1).translation()).norm();
  };
  for (int j = 0; j < DocumentedHand().num_joints(); ++j) {
    HandVector high = q, low = q;
    high[j] += 1e-6;
    low[j] -= 1e-6;
    EXPECT_NEAR(torque[j], -grip.force * (distance(high) - distance(low)) / 2e-6, 1e-6) << j;
  }
}

TEST(GripTest, EvenSharesPressWithTheForcesThatAreReported) {
  const KinematicTree tree = ToyHand();
  FingertipGrip grip;
  grip.involved = {true, true, true, false, false};
  grip.force = 4;
  const GripTorque even = FingertipGripTorque(tree, {0, 1, 2, 3, 4},
                                              BodiesAt(tree, HandVector::Constant(11, 0.2)), grip);
  EXPECT_EQ(even.force[kThumb], 4);
  EXPECT_EQ(even.force[kIndex] + even.force[kMiddle], 4);
  grip.share[kIndex] = 3;
  const GripTorque uneven = FingertipGripTorque(
      tree, {0, 1, 2, 3, 4}, BodiesAt(tree, HandVector::Constant(11, 0.2)), grip);
  EXPECT_NEAR(uneven.torque[3], 1.5 * even.torque[3], 1e-12);
  EXPECT_NEAR(uneven.torque[5], 0.5 * even.torque[5], 1e-12);
  EXPECT_EQ(uneven.torque[1], even.torque[1]);
}

TEST(GripTest, ClosingDirectionsAreOrthonormalAndHoldTheTorqueOfTheGrip) {
  const KinematicTree tree = ToyHand();
  FingertipGrip grip;
  grip.involved = {true, true, true, false, false};
  const HandVector q = HandVector::LinSpaced(11, -0.2, 0.4);
  const Eigen::MatrixXd d =
      ClosingDirections(tree, {0, 1, 2, 3, 4}, BodiesAt(tree, q), grip.involved);
  ASSERT_EQ(d.cols(), 2);
  EXPECT_TRUE((d.transpose() * d).isIdentity(1e-9));
  const Eigen::VectorXd torque =
      FingertipGripTorque(tree, {0, 1, 2, 3, 4}, BodiesAt(tree, q), grip).torque;
  EXPECT_LT((torque - d * (d.transpose() * torque)).norm(), 1e-9);
}

TEST(GripTest, EnclosingFingersPressTogetherWithTheForceAskedFor) {
  const KinematicTree tree = ToyHand();
  EnclosingGrip grip;
  grip.involved.fill(true);
  grip.force = 8;
  const GripTorque t = EnclosingGripTorque(tree, {0, 1, 2, 3, 4},
                                           BodiesAt(tree, HandVector::Constant(11, 0.2)), grip);
  EXPECT_NEAR(t.force[1] + t.force[2] + t.force[3] + t.force[4], 8, 1e-12);
  EXPECT_NEAR(t.torque[4], t.force[kIndex] * 0.05, 1e-12);  // pads 50 mm from the last joint
}

TEST(GripTest, ForceHoldsTheWeightByFrictionAndIsBounded) {
  const double force = GripForceFor(0.2, 0.8, 0, 1, 100);
  EXPECT_NEAR(2 * 0.8 * force, 0.2 * 9.81, 1e-12);
  EXPECT_EQ(GripForceFor(50, 0.8, 0, 1, 5), 5);
}

TEST(GripTest, KeyGripTorqueIsTheThumbsWorkAlongItsPushAndNobodyElses) {
  const KinematicTree tree = ToyHand();
  const HandVector q = HandVector::LinSpaced(11, -0.2, 0.4);
  const Eigen::Vector3d push = Eigen::Vector3d(0.6, 0, -0.8);
  const GripTorque grip = KeyGripTorque(tree, {0, 1, 2, 3, 4}, BodiesAt(tree, q), push, 4);
  EXPECT_EQ(grip.force[kThumb], 4);
  EXPECT_EQ(grip.force[kIndex], 0);
  const auto along = [&](const HandVector& at) {
    std::vector<Pose> X;
    ForwardKinematics(tree, at, X);
    return push.dot(FramePose(tree, X, 0).translation());
  };
  for (int j = 0; j < DocumentedHand().num_joints(); ++j) {
    HandVector high = q, low = q;
    high[j] += 1e-6;
    low[j] -= 1e-6;
    EXPECT_NEAR(grip.torque[j], 4 * (along(high) - along(low)) / 2e-6, 1e-6) << j;
  }
  EXPECT_GT(grip.torque.cwiseAbs().maxCoeff(), 0.05);
}

}  // namespace
}  // namespace springgrasp
