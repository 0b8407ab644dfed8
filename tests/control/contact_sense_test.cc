#include "control/contact_sense.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace springgrasp {
namespace {

constexpr double kDt = 0.002;

// A hand at rest at 0.5 rad whose index bears `torque` on both joints, by pressure.
RobotState Bearing(const PneumaticHandModel& model, double torque) {
  RobotState state;
  state.hand_q = HandVector::Constant(11, 0.5);
  state.hand_qd = state.hand_bias = HandVector::Zero(11);
  for (int v = 0; v < kNumValves; ++v) {
    state.pressure[v] =
        model.return_stiffness[v] * (0.5 - model.return_rest[v]) / model.torque_per_bar[v];
  }
  for (const int v : {3, 4}) state.pressure[v] += torque / model.torque_per_bar[v];
  return state;
}

TEST(ContactSenseTest, AFreeHandTouchesNothingAndAPressingFingerDoes) {
  const PneumaticHandModel model(DocumentedHand());
  ContactSense sense;
  for (int i = 0; i < 100; ++i) SenseContacts(model, {}, Bearing(model, 0), false, kDt, sense);
  for (const bool touching : sense.touching) EXPECT_FALSE(touching);
  for (int i = 0; i < 100; ++i) SenseContacts(model, {}, Bearing(model, 0.08), false, kDt, sense);
  EXPECT_TRUE(sense.touching[kIndex]);
  EXPECT_FALSE(sense.touching[kMiddle]);
  EXPECT_NEAR(sense.torque[3], 0.08, 0.001);
}

TEST(ContactSenseTest, WhatTheModelErrsByIsLearnedWhileTheHandIsFree) {
  const PneumaticHandModel truth(DocumentedHand());
  PneumaticHandModel believed = truth;
  believed.torque_per_bar *= 1.2;
  ContactSense sense;
  for (int i = 0; i < 1000; ++i) SenseContacts(believed, {}, Bearing(truth, 0), true, kDt, sense);
  for (int i = 0; i < 100; ++i) SenseContacts(believed, {}, Bearing(truth, 0), false, kDt, sense);
  for (const bool touching : sense.touching) EXPECT_FALSE(touching);
  EXPECT_NEAR(sense.torque.cwiseAbs().maxCoeff(), 0, 1e-3);
}

constexpr PerFinger<int> kTips = {0, 1, 2, 3, 4};

PerFinger<Eigen::Vector3d> Along(const Eigen::Vector3d& axis) {
  PerFinger<Eigen::Vector3d> all;
  all.fill(axis);
  return all;
}

// Each finger two links along x that bend about y.
KinematicTree FlatHand() {
  KinematicTree tree;
  for (int j = 0; j < 11; ++j) {
    KinematicTree::Node node;
    node.joint = j;
    node.axis = Eigen::Vector3d::UnitY();
    if (j > 0 && j % 2 == 0) {
      node.parent = j - 1;
      node.X_PB.translation() = Eigen::Vector3d(0.04, 0, 0);
    }
    tree.nodes.push_back(node);
    tree.joint_names.push_back("joint");
  }
  for (int f = 0; f < kNumFingers; ++f) {
    KinematicTree::Frame tip;
    tip.node = 2 + 2 * f;
    tip.X_BF.translation() = Eigen::Vector3d(0.05, 0, 0);
    tree.frames.push_back(tip);
  }
  return tree;
}

TEST(ContactSenseTest, PadForceAlongAnAxisIsTheForceWhoseTorquesTheJointsFeel) {
  // The force has a part out of the finger's plane.
  const KinematicTree tree = FlatHand();
  const HandVector q = HandVector::Constant(11, 0.6);
  const Eigen::Vector3d axis = Eigen::Vector3d(0.3, 0.25, -1).normalized();
  std::vector<Pose> X;
  ForwardKinematics(tree, q, X);
  Eigen::MatrixXd J(6, 11);
  FrameJacobian(tree, X, 1, J);
  const Eigen::VectorXd torque = J.topRows<3>().transpose() * (2.5 * axis);
  ValveVector valves = ValveVector::Zero();
  valves[3] = torque[3];
  valves[4] = torque[4];
  const PerFinger<double> force =
      PadForcesAlong(PneumaticHandModel(DocumentedHand()), tree, kTips, X, q, valves, Along(axis));
  EXPECT_NEAR(force[kIndex], 2.5, 1e-9);
  EXPECT_EQ(force[kMiddle], 0);
}

// The torques that a force of 2.5 N of the index puts on its joints, the second of which presses
// against its stop with 0.1 Nm more.
TEST(ContactSenseTest, AJointAtItsStopDoesNotSpoilTheForceThatTheOtherFeels) {
  const PneumaticHandModel model(DocumentedHand());
  const KinematicTree tree = FlatHand();
  HandVector q = HandVector::Constant(11, 0.6);
  q[4] = model.upper[4];
  const Eigen::Vector3d axis = Eigen::Vector3d(-1, 0, -0.3).normalized();
  std::vector<Pose> X;
  ForwardKinematics(tree, q, X);
  Eigen::MatrixXd J(6, 11);
  FrameJacobian(tree, X, kIndex, J);
  const Eigen::VectorXd torque = J.topRows<3>().transpose() * (2.5 * axis);
  ValveVector valves = ValveVector::Zero();
  valves[3] = torque[3];
  valves[4] = torque[4] + 0.1;
  EXPECT_NEAR(PadForcesAlong(model, tree, kTips, X, q, valves, Along(axis))[kIndex], 2.5, 1e-9);
  q[3] = model.lower[3];
  EXPECT_TRUE(std::isnan(PadForcesAlong(model, tree, kTips, X, q, valves, Along(axis))[kIndex]));
}

TEST(ContactSenseTest, WhatNoJointTellsFollowsFromBalance) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  const PerFinger<bool> tripod = {true, true, true, false, false};
  const PerFinger<double> asked = {6, 3, 3, 0, 0};
  EXPECT_EQ(BalancedForces({kUnknown, 3, 4, 0, 0}, tripod, asked)[kThumb], 7);
  EXPECT_EQ(BalancedForces({7, 3, kUnknown, 0, 0}, tripod, asked)[kMiddle], 4);
  const PerFinger<double> neither = BalancedForces({kUnknown, 3.5, kUnknown, 0, 0}, tripod, asked);
  EXPECT_EQ(neither[kThumb], 6);
  EXPECT_EQ(neither[kIndex], 3.5);
  EXPECT_EQ(neither[kMiddle], 3);
}

}  // namespace
}  // namespace springgrasp
