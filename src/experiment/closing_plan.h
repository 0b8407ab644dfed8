// How the robot's fingers close once its arm is there.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/fingers.h"
#include "kinematics/hand_motion.h"
#include "kinematics/robot_hand.h"

namespace springgrasp {

// The chambers fill slower than a human hand closes, so the robot's closing waits for its arm: the
// fingers follow the human-like motion up to the widest aperture, hold it (opened at least as far
// as `q_wait`) until the arm has arrived at T, and close on the contact posture by 1.3 T. Fingers
// with both joints on one valve push with their first phalanx before the last is round the object:
// they follow once the others hold it, by 1.5 T. Joint angles at the motion's samples, those of
// one valve as the valve makes them in free space.
std::vector<Eigen::VectorXd> CloseAfterArrival(
    const RobotHand& hand, const HandMotionResult& motion, const PerFinger<bool>& involved,
    const Eigen::VectorXd& q_wait, const Eigen::VectorXd& q_contact, double dt, double T);

}  // namespace springgrasp
