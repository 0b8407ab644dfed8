#include "control/pneumatic_hand.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace springgrasp {
namespace {

// The controller's own model of the hand, with the inertia and damping of a finger joint.
struct Plant {
  const PneumaticHandModel model = PneumaticHandModel(DocumentedHand());
  RobotState state = AtRest();
  static RobotState AtRest() {
    RobotState rest;
    rest.hand_q = rest.hand_qd = HandVector::Zero(DocumentedHand().num_joints());
    return rest;
  }
  double inertia = 2e-4, damping = 0.02, fill = 0.1;
  void Step(const ValveVector& command, double dt) {
    for (int v = 0; v < kNumValves; ++v) {
      state.pressure[v] += dt / fill * (command[v] - state.pressure[v]);
    }
    for (int j = 0; j < model.layout.num_joints(); ++j) {
      const int v = model.layout.valve_of_joint[j];
      const double torque = model.torque_per_bar[v] * state.pressure[v] -
                            model.return_stiffness[v] * (state.hand_q[j] - model.return_rest[v]);
      // Implicit in the damping, so that the light joint stays stable.
      state.hand_qd[j] = (state.hand_qd[j] + dt * torque / inertia) / (1 + dt * damping / inertia);
      state.hand_q[j] = std::clamp(state.hand_q[j] + dt * state.hand_qd[j], 0.0, M_PI / 2);
      if (state.hand_q[j] <= 0 || state.hand_q[j] >= M_PI / 2) state.hand_qd[j] = 0;
    }
  }
};

TEST(PneumaticHandTest, StepReachesNinetyPercentInAFifthOfASecondWithLittleOvershoot) {
  Plant plant;
  plant.state.hand_q.setConstant(0.1);
  HandControlState memory;
  HandTarget target;
  target.q.setConstant(11, 0.1);
  const double dt = 0.002;
  for (int i = 0; i < 500; ++i) {
    plant.Step(ControlHand(plant.model, {}, target, plant.state, dt, memory), dt);
  }
  target.q.setConstant(11, 0.8);
  double rise = -1, top = 0;
  for (int i = 0; i < 700; ++i) {
    plant.Step(ControlHand(plant.model, {}, target, plant.state, dt, memory), dt);
    const double q = plant.state.hand_q[3];
    if (rise < 0 && q > 0.1 + 0.9 * 0.7) rise = i * dt;
    top = std::max(top, q);
  }
  EXPECT_GT(rise, 0);
  EXPECT_LT(rise, 0.2);
  EXPECT_LT(top, 0.8 + 0.15 * 0.7);
  EXPECT_NEAR(plant.state.hand_q[3], 0.8, 0.05);
}

TEST(PneumaticHandTest, CommandsStayWithinTheSupply) {
  Plant plant;
  HandControlState memory;
  for (const double q : {-3.0, 0.0, 3.0, 30.0}) {
    HandTarget target;
    target.q.setConstant(11, q);
    const ValveVector u = ControlHand(plant.model, {}, target, plant.state, 0.002, memory);
    EXPECT_GE(u.minCoeff(), 0);
    EXPECT_LE(u.maxCoeff(), kMaxPressureBar);
  }
}

TEST(PneumaticHandTest, PressAddsTheTorqueItIsAskedFor) {
  const PneumaticHandModel model(DocumentedHand());
  RobotState state = Plant::AtRest();
  state.hand_q.setConstant(0.5);
  HandControlState memory;
  HandTarget target;
  target.q = state.hand_q;
  target.integrate = false;
  PneumaticGains gains;
  gains.lead = 0;
  const ValveVector rest = ControlHand(model, gains, target, state, 0.002, memory);
  target.torque.setConstant(11, 0.2);
  const ValveVector press = ControlHand(model, gains, target, state, 0.002, memory);
  for (int v = 0; v < kNumValves; ++v) {
    EXPECT_NEAR((press[v] - rest[v]) * model.torque_per_bar[v], 0.2, 1e-12);
  }
}

TEST(PneumaticHandTest, FourJointsOnOneValveAskForTheirMean) {
  const PneumaticHandModel model(DocumentedHand());
  RobotState state = Plant::AtRest();
  HandControlState memory, other_memory;
  PneumaticGains gains;
  gains.lead = 0;
  HandTarget even, uneven;
  even.q.setConstant(11, 0.5);
  uneven.q = even.q;
  uneven.q[7] = 0.8;
  uneven.q[10] = 0.2;
  EXPECT_NEAR(ControlHand(model, gains, even, state, 0.002, memory)[7],
              ControlHand(model, gains, uneven, state, 0.002, other_memory)[7], 1e-12);
}

TEST(PneumaticHandTest, TheVariantsThumbSharesOneValveAndItsOppositionHasItsOwn) {
  const PneumaticHandModel model(OppositionHand());
  ValveVector pressure = ValveVector::Zero();
  pressure[1] = 1;  // opposition
  pressure[2] = 1;  // both thumb joints
  const HandVector q = FreeAnglesAt(model, pressure);
  ASSERT_EQ(q.size(), 12);
  EXPECT_NEAR(q[11], -0.723599 + 1.25, 1e-9);
  EXPECT_NEAR(q[1], 1.05, 1e-9);
  EXPECT_EQ(q[1], q[2]);
  EXPECT_NEAR(q[3], -0.2, 1e-12);
}

}  // namespace
}  // namespace springgrasp
