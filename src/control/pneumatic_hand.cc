#include "control/pneumatic_hand.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace springgrasp {
namespace {

constexpr double kFingerTorque = 0.1;   // Nm/bar, of the valves whose gains are given
constexpr double kFrictionSpeed = 0.1;  // rad/s, of the copy, at which all of the friction is met

using Copy = HandControlState::Copy;

// One step of the model without friction, driven towards the target. Returns the valves' command.
ValveVector Advance(const PneumaticHandModel& model, const PneumaticGains& gains,
                    const ValveVector& q, const ValveVector& qd, const ValveVector& qdd,
                    const ValveVector& gravity, double dt, Copy& copy) {
  const double w = gains.bandwidth;
  ValveVector command;
  for (int v = 0; v < kNumValves; ++v) {
    const double g = model.torque_per_bar[v];
    const double acceleration = qdd[v] + 2 * w * (qd[v] - copy.qd[v]) + w * w * (q[v] - copy.q[v]);
    const double passive =
        model.return_stiffness[v] * (copy.q[v] - model.return_rest[v]) + gravity[v];
    const double wanted =
        (model.inertia[v] * acceleration + model.damping[v] * copy.qd[v] + passive) / g;
    const double rate =
        gains.pressure_bandwidth * (std::clamp(wanted, 0.0, kMaxPressureBar) - copy.pressure[v]) +
        (model.damping[v] * qdd[v] + model.return_stiffness[v] * qd[v]) / g;
    command[v] = std::clamp(copy.pressure[v] + model.fill_time * rate, 0.0, kMaxPressureBar);
    copy.pressure[v] += dt / (model.fill_time + dt) * (command[v] - copy.pressure[v]);
    // Implicit in the damping: the light joint is faster than the step.
    copy.qd[v] = (model.inertia[v] * copy.qd[v] + dt * (g * copy.pressure[v] - passive)) /
                 (model.inertia[v] + dt * model.damping[v]);
    const double next = copy.q[v] + dt * copy.qd[v];
    copy.q[v] = std::clamp(next, model.lower[v], model.upper[v]);
    if (copy.q[v] != next) copy.qd[v] = 0;
  }
  return command;
}

ValveVector MeanOrZero(const HandLayout& layout, const HandVector& of_joints) {
  return of_joints.size() > 0 ? MeanOfValves(layout, of_joints) : ValveVector(ValveVector::Zero());
}

}  // namespace

PneumaticHandModel::PneumaticHandModel(const HandLayout& hand) : layout(hand) {
  torque_per_bar.setConstant(kFingerTorque);
  return_stiffness.setConstant(0.08);
  return_rest.setConstant(-0.2);
  damping.setConstant(0.02);
  friction.setConstant(0.002);
  lower.setZero();
  upper.setConstant(std::numbers::pi / 2);
  // Armature 1e-4 and the phalanges beyond the joint; a valve's mean over its joints.
  for (int v = 0; v < kNumValves; ++v) {
    const std::string_view name = hand.valves[v];
    inertia[v] = name.ends_with("_distal") ? 1.2e-4 : name.ends_with("_proximal") ? 2.0e-4 : 1.6e-4;
  }
  // The opposition joint starts at -30 degrees, its spring as much before that as the others'.
  if (hand.opposition >= 0) {
    const int v = hand.valve_of_joint[hand.opposition];
    lower[v] = -std::numbers::pi / 6;
    upper[v] = 100 * std::numbers::pi / 180;
    return_rest[v] = lower[v] - 0.2;
  }
  torque_per_bar[0] = 0.2;
  return_stiffness[0] = 0.16;
  friction[0] = 0.004;
  inertia[0] = 6e-4;
  upper[0] = 40 * std::numbers::pi / 180;
}

PneumaticHandModel WithErrors(PneumaticHandModel model, double error, RandomEngine& engine) {
  const auto factor = [&] { return Uniform(engine, 1 - error, 1 + error); };
  model.fill_time *= factor();
  model.gravity *= factor();
  for (ValveVector* parameter : {&model.torque_per_bar, &model.return_stiffness, &model.damping,
                                 &model.friction, &model.inertia}) {
    for (double& value : *parameter) value *= factor();
  }
  return model;
}

ValveVector MeanOfValves(const HandLayout& layout, const HandVector& of_joints) {
  ValveVector sum = ValveVector::Zero(), count = ValveVector::Zero();
  for (int j = 0; j < layout.num_joints(); ++j) {
    sum[layout.valve_of_joint[j]] += of_joints[j];
    count[layout.valve_of_joint[j]] += 1;
  }
  return sum.cwiseQuotient(count);
}

ValveVector ControlHand(const PneumaticHandModel& model, const PneumaticGains& gains,
                        const HandTarget& target, const RobotState& state, double dt,
                        HandControlState& memory) {
  const HandLayout& layout = model.layout;
  const ValveVector q = MeanOfValves(layout, state.hand_q);
  const ValveVector qd = MeanOfValves(layout, state.hand_qd);
  const ValveVector gravity = model.gravity * MeanOrZero(layout, state.hand_bias);
  const ValveVector q_target = MeanOfValves(layout, target.q);
  const ValveVector torque = MeanOrZero(layout, target.torque);

  const auto delay = static_cast<std::size_t>(std::lround(target.sensing_delay / dt));
  if (!memory.started) {
    memory.past.assign(delay + 1, {q, qd, state.pressure});
    memory.started = true;
  }
  const std::size_t next = (memory.now + 1) % memory.past.size();
  Copy copy = memory.past[memory.now];
  const ValveVector reference = Advance(model, gains, q_target, MeanOrZero(layout, target.qd),
                                        MeanOrZero(layout, target.qdd), gravity, dt, copy);
  // The oldest, whose place the new one takes: the copy as it was when the sensors were read.
  const Copy then = memory.past[next];

  ValveVector command;
  for (int v = 0; v < kNumValves; ++v) {
    const double g = model.torque_per_bar[v];
    double wanted, feedforward = 0, error;
    if (target.pressing[v]) {
      copy.q[v] = q[v], copy.qd[v] = qd[v], copy.pressure[v] = state.pressure[v];
      error = q_target[v] - q[v];
      // The palm bears its forces with twice a finger's lever: a stronger valve is stiffer.
      const double strength = g / kFingerTorque;
      wanted = model.return_stiffness[v] * (q[v] - model.return_rest[v]) + gravity[v] + torque[v] +
               target.offset[v] + strength * (gains.stiffness * error - gains.damping * qd[v]) +
               memory.integral[v];
      memory.integral[v] -= dt * gains.integral_leak * memory.integral[v];
    } else {
      error = then.q[v] - q[v];
      wanted = g * then.pressure[v] + gains.stiffness * error +
               gains.damping * (then.qd[v] - qd[v]) + memory.integral[v] +
               model.friction[v] * std::clamp(copy.qd[v] / kFrictionSpeed, -1.0, 1.0);
      feedforward = reference[v] - then.pressure[v];
    }
    if (wanted > 0 && wanted < g * kMaxPressureBar) {
      memory.integral[v] = std::clamp(memory.integral[v] + gains.integral * error * dt,
                                      -gains.max_integral, gains.max_integral);
    }
    const double p = std::clamp(wanted / g, 0.0, kMaxPressureBar);
    command[v] =
        std::clamp(p + feedforward + gains.lead * (p - state.pressure[v]), 0.0, kMaxPressureBar);
  }
  memory.now = next;
  memory.past[next] = copy;
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
