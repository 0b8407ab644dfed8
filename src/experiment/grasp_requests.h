// What the kinematic stages of a plan are asked: from a generated fingertip motion to requests.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/pose.h"
#include "grasp/fingertip_motion.h"
#include "kinematics/contact_posture.h"
#include "kinematics/hand_ik.h"
#include "kinematics/hand_motion.h"
#include "kinematics/human_hand.h"
#include "kinematics/robot_hand.h"

namespace springgrasp {

// The fingertips of a motion in H, all known.
std::vector<KnownTips> TipsOf(const FingertipMotion& motion);

// Sample of a motion (even steps `dt`, s) at its contact, T.
std::size_t ContactSample(const FingertipMotion& motion, double dt);

// `q_human`: the human hand at contact, rad.
ContactRequest RequestContacts(const HumanHand& human, const RobotHand& hand,
                               const FingertipMotion& motion, const Eigen::VectorXd& q_human);

// `q_human`, `X_WH` (the robot's hand): one of each for every sample of the motion.
HandMotionRequest RequestHandMotion(const FingertipMotion& motion,
                                    const std::vector<Eigen::VectorXd>& q_human,
                                    const ContactPosture& posture, const std::vector<Pose>& X_WH,
                                    const Pose& X_WO, double dt);

}  // namespace springgrasp
