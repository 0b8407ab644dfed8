#include "sim/pneumatics.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "sim/model_index.h"

namespace springgrasp {
namespace {

constexpr double kFillTime = 0.1;           // s, of models/armar3b
constexpr double kArea = 1, kLever = 1;     // cm^2, cm, of its fingers
constexpr double kPascalCubicMetre = 1e-1;  // 1e5 Pa/bar * 1e-4 m^2/cm^2 * 1e-2 m/cm

bool IsHand(const std::string& name) { return name.rfind("hand_", 0) == 0; }

double Scale(const std::string& name) {
  return name.size() > 5 && name.substr(name.size() - 5) == "_palm" ? 2 : 1;
}

}  // namespace

void ApplyPneumatics(const PneumaticParameters& p, mjModel& model) {
  for (int a = 0; a < model.nu; ++a) {
    const std::string name = NameOf(model, mjOBJ_ACTUATOR, a);
    if (!IsHand(name) || model.actuator_dyntype[a] != mjDYN_FILTER) continue;
    double& fill_time = model.actuator_dynprm[mjNDYN * a];
    if (p.fill_time) fill_time = *p.fill_time;
    if (p.supply) model.actuator_ctrlrange[2 * a + 1] = *p.supply;
    if (p.area || p.lever) {
      model.actuator_gear[6 * a] =
          Scale(name) * kPascalCubicMetre * p.area.value_or(kArea) * p.lever.value_or(kLever);
    }
    // A closed valve must be able to ask for less than ambient for the engine's filter to leak.
    if (p.leakage > 0) {
      model.actuator_ctrlrange[2 * a] =
          -p.leakage * fill_time * model.actuator_ctrlrange[2 * a + 1];
    }
  }
  for (int j = 0; j < model.njnt; ++j) {
    const std::string name = NameOf(model, mjOBJ_JOINT, j);
    if (!IsHand(name)) continue;
    const int dof = model.jnt_dofadr[j];
    if (p.spring) model.jnt_stiffness[j] = Scale(name) * *p.spring;
    if (p.damping) model.dof_damping[dof] = *p.damping;
    if (p.friction) model.dof_frictionloss[dof] = Scale(name) * *p.friction;
  }
}

PneumaticDrives::PneumaticDrives(const PneumaticParameters& parameters, double dt,
                                 RandomEngine engine)
    : parameters_(parameters),
      dt_(dt),
      fill_time_(parameters.fill_time.value_or(kFillTime)),
      supply_(parameters.supply.value_or(kMaxPressureBar)),
      waiting_(static_cast<std::size_t>(std::lround(parameters.delay / dt)), ValveVector::Zero()),
      engine_(engine) {}

ValveVector PneumaticDrives::Step(const ValveVector& command, const ValveVector& pressure) {
  ValveVector u = command.cwiseMax(0).cwiseMin(supply_);
  if (!waiting_.empty()) {
    std::swap(u, waiting_[next_]);
    next_ = (next_ + 1) % waiting_.size();
  }
  const double play = parameters_.hysteresis / 2;
  for (int v = 0; v < kNumValves; ++v) {
    spool_[v] = std::clamp(spool_[v], u[v] - play, u[v] + play);
    double c = std::clamp(spool_[v], 0.0, supply_);
    if (parameters_.max_rate > 0) {
      const double reach = parameters_.max_rate * fill_time_;
      c = std::clamp(c, pressure[v] - reach, pressure[v] + reach);
    }
    u[v] = c - parameters_.leakage * fill_time_ * pressure[v];
  }
  return u;
}

void PneumaticDrives::Sense(RobotState& state) {
  if (parameters_.pressure_noise > 0) {
    for (double& p : state.pressure) p += parameters_.pressure_noise * Normal(engine_);
  }
  if (parameters_.angle_noise > 0) {
    for (double& q : state.hand_q) q += parameters_.angle_noise * Normal(engine_);
  }
  if (parameters_.sensing_delay > 0) {
    const Reading now = {state.hand_q, state.hand_bias, state.pressure};
    if (readings_.empty()) {
      readings_.assign(static_cast<std::size_t>(std::lround(parameters_.sensing_delay / dt_)), now);
    }
    if (!readings_.empty()) {
      const Reading old = std::exchange(readings_[next_reading_], now);
      next_reading_ = (next_reading_ + 1) % readings_.size();
      state.hand_q = old.q;
      state.hand_bias = old.bias;
      state.pressure = old.pressure;
    }
  }
  if (parameters_.angle_noise == 0 && parameters_.sensing_delay == 0) return;
  if (last_q_.size() == 0) {
    last_q_ = state.hand_q;
    speed_ = HandVector::Zero(state.hand_q.size());
  }
  speed_ += dt_ / (kSpeedFilter + dt_) * ((state.hand_q - last_q_) / dt_ - speed_);
  last_q_ = state.hand_q;
  state.hand_qd = speed_;
}

}  // namespace springgrasp
