#include "control/pneumatic_hand.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace springgrasp {
namespace {

constexpr double kDt = 0.002;
constexpr double kDegrees = 180 / M_PI;

// The nominal hand, a joint for each of a valve's, with friction.
struct Plant {
  const PneumaticHandModel model = PneumaticHandModel(DocumentedHand());
  RobotState state = AtRest();
  static RobotState AtRest() {
    RobotState rest;
    rest.hand_q = rest.hand_qd = HandVector::Zero(DocumentedHand().num_joints());
    return rest;
  }
  void Step(const ValveVector& command) {
    state.pressure += kDt / model.fill_time * (command - state.pressure);
    for (int j = 0; j < model.layout.num_joints(); ++j) {
      const int v = model.layout.valve_of_joint[j];
      const double torque = model.torque_per_bar[v] * state.pressure[v] -
                            model.return_stiffness[v] * (state.hand_q[j] - model.return_rest[v]);
      // Implicit in the damping, so that the light joint stays stable; friction stops, never
      // drives.
      const double mass = model.inertia[v] + kDt * model.damping[v];
      const double free = (model.inertia[v] * state.hand_qd[j] + kDt * torque) / mass;
      const double friction = kDt * model.friction[v] / mass;
      state.hand_qd[j] = free - std::clamp(free, -friction, friction);
      state.hand_q[j] = std::clamp(state.hand_q[j] + kDt * state.hand_qd[j], 0.0, model.upper[v]);
      if (state.hand_q[j] <= 0 || state.hand_q[j] >= model.upper[v]) state.hand_qd[j] = 0;
    }
  }
};

struct StepResponse {
  double rise = 9, overshoot = 0, late = 0;  // s, part of the step, rad after 0.6 s
};

StepResponse Respond(double from, double to) {
  Plant plant;
  plant.state.hand_q.setConstant(from);
  plant.state.hand_q[0] = 0.3;
  HandControlState memory;
  HandTarget target;
  target.q = plant.state.hand_q;
  for (int i = 0; i < 500; ++i) {
    plant.Step(ControlHand(plant.model, {}, target, plant.state, kDt, memory));
  }
  StepResponse response;
  for (int j = 1; j < target.q.size(); ++j) target.q[j] = to;
  for (int i = 1; i <= 500; ++i) {
    plant.Step(ControlHand(plant.model, {}, target, plant.state, kDt, memory));
    const double t = i * kDt, done = (plant.state.hand_q[3] - from) / (to - from);
    if (done > 0.9) response.rise = std::min(response.rise, t);
    response.overshoot = std::max(response.overshoot, done - 1);
    if (t >= 0.6) response.late = std::max(response.late, std::abs(plant.state.hand_q[3] - to));
  }
  return response;
}

TEST(PneumaticHandTest, ClosesByAStepInAFifthOfASecondFromFiveAngles) {
  for (const double start : {0.0, 0.2, 0.4, 0.6, 0.8}) {
    const StepResponse r = Respond(start, start + 0.7);
    EXPECT_LT(r.rise, 0.2) << start;
    EXPECT_LT(r.overshoot, 0.12) << start;
    EXPECT_LT(r.late * kDegrees, 3) << start;
  }
}

TEST(PneumaticHandTest, OpensByItsSpringAlone) {
  for (const double end : {0.0, 0.2, 0.4, 0.6, 0.8}) {
    const StepResponse r = Respond(end + 0.7, end);
    EXPECT_LT(r.rise, 0.8) << end;
    EXPECT_LT(r.overshoot, 0.12) << end;
    EXPECT_LT(r.late * kDegrees, 3) << end;
  }
}

TEST(PneumaticHandTest, FollowsAGraspWithLateNoisySensorsAndAModelThatErrs) {
  constexpr int kDelay = 7;  // steps: 14 ms
  const auto at = [](double t) { return 0.5 - 0.4 * std::cos(M_PI * std::min(1.0, t)); };
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    RandomEngine engine(seed);
    Plant plant;
    plant.state.hand_q.setConstant(at(0));
    const PneumaticHandModel believed = WithErrors(plant.model, 0.2, engine);
    HandControlState memory;
    std::vector<RobotState> past(kDelay + 1, plant.state);
    double squares = 0;
    for (int i = -500; i < 500; ++i) {
      const double t = std::max(0, i) * kDt;
      past.erase(past.begin());
      past.push_back(plant.state);
      RobotState sensed = past.front();
      for (double& q : sensed.hand_q) q += 0.004 * Normal(engine);
      for (double& p : sensed.pressure) p += 0.02 * Normal(engine);
      HandTarget target;
      target.q.setConstant(11, at(t));
      target.qd.setConstant(11, i < 0 ? 0 : 0.4 * M_PI * std::sin(M_PI * t));
      target.qdd.setConstant(11, i < 0 ? 0 : 0.4 * M_PI * M_PI * std::cos(M_PI * t));
      target.sensing_delay = kDelay * kDt;
      plant.Step(ControlHand(believed, {}, target, sensed, kDt, memory));
      const double error = plant.state.hand_q[3] - at(t + kDt);
      if (i >= 0) squares += error * error;
    }
    EXPECT_LT(std::sqrt(squares / 500) * kDegrees, 6) << seed;
  }
}

TEST(PneumaticHandTest, ABlockedFingerWindsNothingUp) {
  Plant plant;
  plant.state.hand_q.setConstant(0.3);
  HandControlState memory;
  HandTarget target;
  target.q.setConstant(11, 0.9);
  RobotState blocked = plant.state;
  for (int i = 0; i < 2000; ++i) {
    plant.state = blocked;
    plant.state.pressure = blocked.pressure;
    const ValveVector u = ControlHand(plant.model, {}, target, plant.state, kDt, memory);
    blocked.pressure += kDt / plant.model.fill_time * (u - blocked.pressure);
  }
  EXPECT_LE(memory.integral.cwiseAbs().maxCoeff(), PneumaticGains().max_integral);
  // Pressed by its stiffness and the bounded integral, not by all that the supply has.
  const double torque = 0.1 * blocked.pressure[3] - 0.08 * (0.3 + 0.2);
  EXPECT_LT(torque, 0.45 * 0.6 + 0.08 + 0.08 * 0.6 + 0.01);
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
  target.pressing.fill(true);
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
  EXPECT_NEAR(q[11], -M_PI / 6 - 0.2 + 1.25, 1e-9);
  EXPECT_NEAR(q[1], 1.05, 1e-9);
  EXPECT_EQ(q[1], q[2]);
  EXPECT_NEAR(q[3], -0.2, 1e-12);
}

}  // namespace
}  // namespace springgrasp
