#include "control/arm_controller.h"

namespace springgrasp {

ArmVector ControlArm(const ArmGains& gains, const ArmTarget& target, const RobotState& state,
                     double dt, ArmControlState& memory) {
  const double w = gains.bandwidth;
  const double wi = gains.integral_bandwidth;
  const ArmVector error = target.q - state.arm_q;
  memory.integral += wi * wi * wi * dt * error;
  memory.integral = memory.integral.cwiseMax(-gains.max_integral).cwiseMin(gains.max_integral);
  const ArmVector acceleration =
      target.qdd + 2 * w * (target.qd - state.arm_qd) + w * w * error + memory.integral;
  return state.arm_mass * acceleration + state.arm_bias + target.feedforward_torque;
}

}  // namespace springgrasp
