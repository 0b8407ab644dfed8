#include "control/grip_controller.h"

#include <gtest/gtest.h>

#include <cmath>

#include "control/toy_hand.h"

namespace springgrasp {
namespace {

constexpr double kDt = 0.002;

// A hand whose joints stand where they are put; its chambers follow the commands.
struct Grip {
  KinematicTree hand = ToyHand();
  PneumaticHandModel model = PneumaticHandModel(DocumentedHand());
  GripTask task;
  RobotState state;
  HandTarget reference;
  explicit Grip(double force, double q = 0.4) {
    task.involved = {true, true, false, false, false};
    task.force = force;
    task.max_force = 5;
    state.hand_q = HandVector::Constant(11, q);
    state.hand_qd = state.hand_bias = HandVector::Zero(11);
    for (int v = 0; v < kNumValves; ++v) {
      state.pressure[v] = model.return_stiffness[v] * (q + 0.2) / model.torque_per_bar[v];
    }
    reference.q = state.hand_q;
  }
  void Run(GripController& controller, GripStage stage, double duration) {
    for (int i = 0; i < duration / kDt; ++i) {
      const ValveVector u = controller.Control(state, reference, stage, kDt);
      state.pressure += kDt / model.fill_time * (u - state.pressure);
    }
  }
};

TEST(GripControllerTest, AFingerThatIsStoppedIsFeltAndBothPressOnceAllAre) {
  Grip grip(3);
  GripController controller(grip.model, grip.hand, {0, 1, 2, 3, 4}, grip.task);
  grip.Run(controller, GripStage::kFree, 0.5);
  EXPECT_FALSE(controller.touching()[kThumb] || controller.touching()[kIndex]);
  for (const int j : {1, 2, 3, 4}) grip.reference.q[j] = 0.6;  // held back at 0.4
  grip.Run(controller, GripStage::kClosing, 0.5);
  EXPECT_TRUE(controller.touching()[kThumb] && controller.touching()[kIndex]);
  EXPECT_EQ(controller.target_force()[kThumb], 0);
  grip.Run(controller, GripStage::kPressing, 1.5);
  EXPECT_TRUE(controller.held());
  EXPECT_NEAR(controller.target_force()[kThumb], 3, 1e-9);
  EXPECT_NEAR(controller.target_force()[kIndex], 3, 1e-9);
  EXPECT_EQ(controller.target_force()[kMiddle], 0);
}

TEST(GripControllerTest, WhatIsFeltOfTheForceBecomesWhatIsAskedFor) {
  Grip grip(3);
  GripController controller(grip.model, grip.hand, {0, 1, 2, 3, 4}, grip.task);
  grip.Run(controller, GripStage::kFree, 0.5);
  grip.Run(controller, GripStage::kPressing, 4);
  const PerFinger<double> felt = controller.SensedForce();
  EXPECT_NEAR((felt[kThumb] + felt[kIndex]) / 2, 3, 0.05);
}

TEST(GripControllerTest, ThePalmBearsWhatTheFingersPressWith) {
  Grip grip(3);
  for (const int finger : {1, 2, 3, 4}) grip.hand.nodes[1 + 2 * finger].parent = 0;
  GripController controller(grip.model, grip.hand, {0, 1, 2, 3, 4}, grip.task);
  grip.Run(controller, GripStage::kFree, 0.5);
  const double before = grip.state.pressure[0];
  grip.Run(controller, GripStage::kPressing, 4);
  const GripTorque wanted =
      FingertipGripTorque(grip.hand, {0, 1, 2, 3, 4}, BodiesAt(grip.hand, grip.state.hand_q),
                          {.involved = grip.task.involved, .force = 3});
  ASSERT_GT(std::abs(wanted.torque[0]), 0.05);
  // But for what the force's controller adds.
  EXPECT_NEAR(grip.model.torque_per_bar[0] * (grip.state.pressure[0] - before), wanted.torque[0],
              0.15 * std::abs(wanted.torque[0]));
}

TEST(GripControllerTest, PostureIsHeldAcrossTheGripFromTheFirstTouchOn) {
  Grip grip(3);
  GripController pushed(grip.model, grip.hand, {0, 1, 2, 3, 4}, grip.task);
  grip.Run(pushed, GripStage::kFree, 0.5);
  grip.Run(pushed, GripStage::kPressing, 0.7);
  const HandDirections closing = ClosingDirections(
      grip.hand, {0, 1, 2, 3, 4}, BodiesAt(grip.hand, grip.state.hand_q), grip.task.involved);
  HandVector across = HandVector::Zero(11);
  across.segment<4>(1).setOnes();
  across -= closing.col(0).dot(across) * closing.col(0);
  GripController still = pushed;
  Grip moved = grip;
  moved.state.hand_q += 0.05 * across;
  grip.Run(still, GripStage::kPressing, kDt);
  moved.Run(pushed, GripStage::kPressing, kDt);
  // More pressure than the return springs take is pressure against the way that it was pushed.
  double work = 0;
  for (const int j : {1, 2, 3, 4}) {
    work += across[j] * (moved.state.pressure[j] - grip.state.pressure[j]);
  }
  EXPECT_LT(work, -0.01 * across.squaredNorm());
}

TEST(GripControllerTest, NoMoreForceIsAskedForThanTheValvesCanGive) {
  Grip grip(3, 0.6);
  grip.model.torque_per_bar *= 0.4;
  grip.state.pressure /= 0.4;
  GripController controller(grip.model, grip.hand, {0, 1, 2, 3, 4}, grip.task);
  grip.Run(controller, GripStage::kFree, 0.5);
  grip.Run(controller, GripStage::kPressing, 4);
  EXPECT_LT(controller.target_force()[kThumb], 2.8);
  EXPECT_GT(controller.target_force()[kThumb], 0.5);
  EXPECT_LT(grip.state.pressure.maxCoeff(), kMaxPressureBar);
  EXPECT_NEAR(controller.SensedForce()[kThumb], controller.target_force()[kThumb], 0.1);
}

TEST(GripControllerTest, ButWhereTheirStopsAreNearTheseBearIt) {
  for (const double q : {0.3, 0.6}) {
    Grip grip(3, q);
    grip.model.torque_per_bar *= 0.4;
    grip.state.pressure /= 0.4;
    GripController controller(grip.model, grip.hand, {0, 1, 2, 3, 4}, grip.task);
    grip.Run(controller, GripStage::kFree, 0.5);
    grip.Run(controller, GripStage::kPressing, 4);
    EXPECT_EQ(controller.target_force()[kThumb] > 2.999, q < GripSettings().near_stop);
  }
}

TEST(GripControllerTest, FingersThatComeCloserThanTheyHeldRegripHarderUpToTheLimit) {
  Grip grip(3);
  GripController controller(grip.model, grip.hand, {0, 1, 2, 3, 4}, grip.task);
  grip.Run(controller, GripStage::kFree, 0.5);
  grip.Run(controller, GripStage::kPressing, 3);
  ASSERT_TRUE(controller.held());
  EXPECT_EQ(controller.regrips(), 0);
  double last = controller.target_force()[kThumb];
  for (int slip = 1; slip <= 4; ++slip) {
    // The way in which the pads come closer, two millimetres of it.
    const HandVector toward = ClosingDirections(
        grip.hand, {0, 1, 2, 3, 4}, BodiesAt(grip.hand, grip.state.hand_q), grip.task.involved);
    grip.state.hand_q += 0.02 * toward;
    grip.Run(controller, GripStage::kPressing, 0.3);
    EXPECT_EQ(controller.regrips(), slip);
    const double now = controller.target_force()[kThumb];
    EXPECT_TRUE(now > last || now == grip.task.max_force);
    EXPECT_LE(now, grip.task.max_force);
    last = now;
  }
}

TEST(GripControllerTest, AnEnclosingHandTellsFingersThatSettleFromAnObjectThatEscapes) {
  Grip grip(10);
  grip.task.enclosing = true;
  grip.task.involved = {true, true, true, true, true};
  GripController controller(grip.model, grip.hand, {0, 1, 2, 3, 4}, grip.task);
  grip.Run(controller, GripStage::kFree, 0.5);
  grip.Run(controller, GripStage::kPressing, 3);
  ASSERT_TRUE(controller.held());
  // Pads come 12 mm nearer to their bases within two seconds, and the thumb gives way.
  for (int i = 0; i < 100; ++i) {
    for (const int j : {4, 6, 8, 10}) grip.state.hand_q[j] += 0.004;
    grip.state.hand_q[2] += 0.01;
    grip.Run(controller, GripStage::kPressing, 0.02);
  }
  EXPECT_EQ(controller.regrips(), 0);
  // And as far again at once.
  for (const int j : {4, 6, 8, 10}) grip.state.hand_q[j] += 0.4;
  grip.Run(controller, GripStage::kPressing, 0.02);
  EXPECT_EQ(controller.regrips(), 1);
}

TEST(GripControllerTest, AFingerThatMissesWhereItWasPlannedToTouchClosesOn) {
  Grip grip(3);
  GripController controller(grip.model, grip.hand, {0, 1, 2, 3, 4}, grip.task);
  grip.Run(controller, GripStage::kFree, 0.5);
  // It waits until the plan has moved it, then goes on when the plan is over.
  grip.reference.qd = grip.reference.qdd = HandVector::Zero(11);
  const double before = grip.state.pressure[3];
  grip.Run(controller, GripStage::kClosing, 0.2);
  EXPECT_NEAR(grip.state.pressure[3], before, 0.02);
  grip.reference.qd[3] = 0.5;
  grip.Run(controller, GripStage::kClosing, kDt);
  grip.reference.qd[3] = 0;
  grip.Run(controller, GripStage::kClosing, 0.05);
  EXPECT_GT(grip.state.pressure[3], before + 0.05);
}

TEST(GripControllerTest, InAKeyGripTheThumbAlonePressesAndTheOthersKeepTheirPlace) {
  Grip grip(3);
  grip.task.push_H = Eigen::Vector3d(0, 0, -1);
  GripController controller(grip.model, grip.hand, {0, 1, 2, 3, 4}, grip.task);
  grip.Run(controller, GripStage::kFree, 0.5);
  const double index = grip.state.pressure[3];
  grip.Run(controller, GripStage::kPressing, 3);
  EXPECT_TRUE(controller.held());
  EXPECT_NEAR(controller.target_force()[kThumb], 3, 1e-9);
  EXPECT_EQ(controller.target_force()[kIndex], 0);
  EXPECT_EQ(controller.SensedForce()[kIndex], 0);
  EXPECT_NEAR(grip.state.pressure[3], index, 0.05);
}

}  // namespace
}  // namespace springgrasp
