#include "control/hanging_hand.h"

#include <gtest/gtest.h>

#include "control/toy_hand.h"

namespace springgrasp {
namespace {

constexpr double kGravity = 9.81;

// The toy hand with fingers of 60 g each.
RobotHand HeavyHand() {
  RobotHand hand;
  hand.tree = ToyHand();
  for (KinematicTree::Node& node : hand.tree.nodes) {
    if (node.joint == 0) continue;
    node.mass = 0.03;
    node.p_BC = Eigen::Vector3d(0.02, 0, 0.005);
  }
  hand.open = Eigen::VectorXd::Zero(11);
  return hand;
}

TEST(GravityTorquesTest, AreTheSlopeOfThePotential) {
  const RobotHand hand = HeavyHand();
  const Eigen::Vector3d g(3, -4, 8);
  const Eigen::VectorXd q = Eigen::VectorXd::LinSpaced(11, -0.5, 0.7);
  const auto potential = [&](const Eigen::VectorXd& at) {
    const std::vector<Pose> X = BodiesAt(hand.tree, at);
    double sum = 0;
    for (std::size_t n = 0; n < X.size(); ++n) {
      sum -= hand.tree.nodes[n].mass * g.dot(X[n] * hand.tree.nodes[n].p_BC);
    }
    return sum;
  };
  const Eigen::VectorXd torque = GravityTorques(hand.tree, BodiesAt(hand.tree, q), g);
  for (int j = 0; j < 11; ++j) {
    const Eigen::VectorXd step = 1e-6 * Eigen::VectorXd::Unit(11, j);
    EXPECT_NEAR(torque[j], -(potential(q + step) - potential(q - step)) / 2e-6, 1e-8);
  }
}

TEST(HangingHandTest, AJointSinksToWhereSpringAndFrictionCarryItOrStaysWhereItIsFlexed) {
  const RobotHand hand = HeavyHand();
  const PneumaticHandModel model{DocumentedHand()};
  // Flexes all joints but the thumb's.
  const Eigen::Vector3d g(0, 0, -kGravity);
  const Eigen::VectorXd open = HangingPosture(model, hand, g, hand.open);
  const Eigen::VectorXd weight = GravityTorques(hand.tree, BodiesAt(hand.tree, open), g);
  int sunk = 0;
  for (int j = 3; j < 7; ++j) {  // index and middle: a valve for each joint
    const double carried = model.return_stiffness[j] * (open[j] - model.return_rest[j]);
    if (open[j] < 1e-6) {
      EXPECT_LE(weight[j] + model.friction[j], carried + 1e-4);
      continue;
    }
    ++sunk;
    EXPECT_NEAR(carried, weight[j] + model.friction[j], 1e-4);
  }
  EXPECT_GT(sunk, 0);
  EXPECT_EQ(open[1], 0);
  const Eigen::VectorXd flexed = Eigen::VectorXd::Constant(11, 0.9);
  EXPECT_EQ(HangingPosture(model, hand, g, flexed), flexed);
  EXPECT_EQ(HangingPosture(model, hand, Eigen::Vector3d::Zero(), hand.open), hand.open);
}

TEST(HangingHandTest, ThePlannedHandOpensNoFurtherThanItHangs) {
  const RobotHand hand = HeavyHand();
  const PneumaticHandModel model{DocumentedHand()};
  const Eigen::Vector3d g(0, 0, -kGravity);
  const Eigen::VectorXd open = HangingPosture(model, hand, g, hand.open);
  const RobotHand hanging = HangingHand(model, hand, g, hand.open);
  for (int j = 0; j < 11; ++j) {
    EXPECT_NEAR(hanging.open[j], open[j], 1e-3);
    EXPECT_GE(hanging.tree.lower[j], hand.tree.lower[j]);
  }
}

}  // namespace
}  // namespace springgrasp
