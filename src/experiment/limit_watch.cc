#include "experiment/limit_watch.h"

#include <algorithm>

namespace springgrasp {
namespace {

template <typename Vector>
double Outside(const Vector& q, const Vector& lower, const Vector& upper) {
  return std::max({0.0, (lower - q).maxCoeff(), (q - upper).maxCoeff()});
}

}  // namespace

void WatchLimits(const RobotIo& robot, const PneumaticHandModel& hand,
                 const PneumaticParameters& pneumatics, const RobotState& state,
                 const ArmVector& arm_planned, const HandVector& hand_planned,
                 const RobotCommand& command, double dt, LimitViolations& violations) {
  LimitViolations& v = violations;
  const double torque = (command.arm_torque.cwiseAbs() - robot.max_arm_torque).maxCoeff();
  if (torque > 0) v.arm_torque_s += dt;
  v.arm_torque = std::max(v.arm_torque, torque);
  v.arm_range = std::max(v.arm_range, Outside(arm_planned, robot.arm_lower, robot.arm_upper));
  v.hand_range = std::max(v.hand_range, Outside(hand_planned, robot.hand_lower, robot.hand_upper));
  ValveVector torque_still = hand.return_stiffness.cwiseProduct(
      MeanOfValves(hand.layout, hand_planned) - hand.return_rest);
  if (state.hand_bias.size() > 0) torque_still += MeanOfValves(hand.layout, state.hand_bias);
  const ValveVector still = torque_still.cwiseQuotient(hand.torque_per_bar);
  v.pressure_low = std::max(v.pressure_low, -still.minCoeff());
  v.pressure_high = std::max(v.pressure_high, still.maxCoeff() - kMaxPressureBar);
  if (pneumatics.max_rate > 0) {
    const double rate =
        (command.valve_pressure - state.pressure).cwiseAbs().maxCoeff() / hand.fill_time -
        pneumatics.max_rate;
    v.valve_rate = std::max(v.valve_rate, rate);
  }
}

}  // namespace springgrasp
