#include "control/pneumatic_hand.h"

#include <algorithm>

namespace springgrasp {

PneumaticHandModel::PneumaticHandModel(const HandLayout& hand) : layout(hand) {
  torque_per_bar.setConstant(0.1);
  return_stiffness.setConstant(0.08);
  return_rest.setConstant(-0.2);
  // The opposition joint starts at -30 degrees, its spring as much before that as the others'.
  if (hand.opposition >= 0) return_rest[hand.valve_of_joint[hand.opposition]] = -0.523599 - 0.2;
  torque_per_bar[0] = 0.2;
  return_stiffness[0] = 0.16;
}

ValveVector ControlHand(const PneumaticHandModel& model, const PneumaticGains& gains,
                        const HandTarget& target, const RobotState& state, double dt,
                        HandControlState& memory) {
  ValveVector torque = ValveVector::Zero();
  ValveVector error = ValveVector::Zero();
  ValveVector count = ValveVector::Zero();
  for (int j = 0; j < model.layout.num_joints(); ++j) {
    const int v = model.layout.valve_of_joint[j];
    const double e = target.q[j] - state.hand_q[j];
    // Against the return spring, plus PD, plus what the grip asks for.
    torque[v] += model.return_stiffness[v] * (target.q[j] - model.return_rest[v]) +
                 gains.stiffness * e - gains.damping * state.hand_qd[j] +
                 (target.torque.size() > 0 ? target.torque[j] : 0.0);
    error[v] += e;
    count[v] += 1;
  }
  ValveVector command;
  for (int v = 0; v < kNumValves; ++v) {
    const double g = model.torque_per_bar[v];
    const double wanted = torque[v] / count[v] + memory.integral[v];
    if (target.integrate && wanted > 0 && wanted < g * kMaxPressureBar) {
      memory.integral[v] =
          std::clamp(memory.integral[v] + gains.integral * error[v] / count[v] * dt,
                     -gains.max_integral, gains.max_integral);
    }
    const double p = std::clamp(wanted / g, 0.0, kMaxPressureBar);
    command[v] = std::clamp(p + gains.lead * (p - state.pressure[v]), 0.0, kMaxPressureBar);
  }
  return command;
}

HandVector FreeAnglesAt(const PneumaticHandModel& model, const ValveVector& pressure) {
  HandVector q(model.layout.num_joints());
  for (int j = 0; j < model.layout.num_joints(); ++j) {
    const int v = model.layout.valve_of_joint[j];
    q[j] = model.return_rest[v] + pressure[v] * model.torque_per_bar[v] / model.return_stiffness[v];
  }
  return q;
}

}  // namespace springgrasp
