#include "control/grip.h"

#include <gtest/gtest.h>

namespace springgrasp {
namespace {

// Five planar fingers of one link each, bases 20 mm apart along y; the thumb faces the others.
KinematicTree ToyHand() {
  KinematicTree tree;
  for (int j = 0; j < DocumentedHand().num_joints(); ++j) {
    KinematicTree::Node node;
    node.name = std::string(DocumentedHand().joints[j]);
    node.joint = j;
    node.axis = Eigen::Vector3d::UnitY();
    if (j > 0 && j % 2 == 0) {
      node.parent = j - 1;
      node.X_PB.translation() = Eigen::Vector3d(0.04, 0, 0);
    } else if (j > 0) {
      const int finger = (j - 1) / 2;
      node.X_PB.translation() = Eigen::Vector3d(0.1, -0.02 * finger, finger == kThumb ? -0.08 : 0);
    }
    tree.nodes.push_back(node);
    tree.joint_names.push_back(node.name);
  }
  for (int f = 0; f < kNumFingers; ++f) {
    KinematicTree::Frame tip;
    tip.name = "tip";
    tip.node = 2 + 2 * f;
    tip.X_BF.translation() = Eigen::Vector3d(0.05, 0, 0);
    tree.frames.push_back(tip);
  }
  tree.lower = HandVector::Constant(11, -1);
  tree.upper = HandVector::Constant(11, 1);
  return tree;
}

TEST(GripTest, FingertipGripDoesNoWorkWhenTheHandTurnsAsAWhole) {
  // Internal forces: their virtual work for a common displacement of all pads along z is zero.
  const KinematicTree tree = ToyHand();
  FingertipGrip grip;
  grip.involved = {true, true, true, false, false};
  const HandVector q = HandVector::Constant(11, 0.2);
  const HandVector torque = FingertipGripTorque(tree, {0, 1, 2, 3, 4}, q, grip);
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
  const HandVector torque = FingertipGripTorque(tree, {0, 1, 2, 3, 4}, q, grip);
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

TEST(GripTest, ForceHoldsTheWeightByFrictionAndIsBounded) {
  const double force = GripForceFor(0.2, 0.8, 0, 1, 100);
  EXPECT_NEAR(2 * 0.8 * force, 0.2 * 9.81, 1e-12);
  EXPECT_EQ(GripForceFor(50, 0.8, 0, 1, 5), 5);
}

}  // namespace
}  // namespace springgrasp
