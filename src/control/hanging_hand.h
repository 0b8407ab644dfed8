// What the springs of a pneumatic hand can hold against gravity.
#pragma once

#include <Eigen/Core>

#include "control/pneumatic_hand.h"
#include "kinematics/robot_hand.h"

namespace springgrasp {

// The posture nearest to `q` that the hand can take in gravity `g_H` (m/s^2, in its frame H): the
// chambers can only flex, so that a joint opens no further than to where its spring alone, friction
// against it, carries what hangs on it. Within the joints' ranges.
Eigen::VectorXd HangingPosture(const PneumaticHandModel& model, const RobotHand& hand,
                               const Eigen::Vector3d& g_H, const Eigen::VectorXd& q);

// The hand with the ranges that are left to it in that gravity near posture `q`.
RobotHand HangingHand(const PneumaticHandModel& model, const RobotHand& hand,
                      const Eigen::Vector3d& g_H, const Eigen::VectorXd& q);

}  // namespace springgrasp
