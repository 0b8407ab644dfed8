#include "control/pneumatic_hand.h"

#include <algorithm>

namespace springgrasp {

PneumaticHandModel::PneumaticHandModel() {
  torque_per_bar.setConstant(0.1);
  return_stiffness.setConstant(0.08);
  torque_per_bar[0] = 0.2;
  return_stiffness[0] = 0.16;
}

ValveVector ControlHand(const PneumaticHandModel& model, const PneumaticGains& gains,
                        const HandTarget& target, const RobotState& state, double dt,
                        HandControlState& memory) {
  ValveVector torque = ValveVector::Zero();
  ValveVector error = ValveVector::Zero();
  ValveVector count = ValveVector::Zero();
  for (int j = 0; j < kNumHandJoints; ++j) {
    const int v = PneumaticHandModel::kValveOfJoint[j];
    const double e = target.q[j] - state.hand_q[j];
    // Against the return spring, plus PD, plus what the grip asks for.
    torque[v] += model.return_stiffness[v] * (target.q[j] - model.return_rest) +
                 gains.stiffness * e - gains.damping * state.hand_qd[j] + target.torque[j];
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
  HandVector q;
  for (int j = 0; j < kNumHandJoints; ++j) {
    const int v = PneumaticHandModel::kValveOfJoint[j];
    q[j] = model.return_rest + pressure[v] * model.torque_per_bar[v] / model.return_stiffness[v];
  }
  return q;
}

}  // namespace springgrasp
