// How the robot's hand holds an object, wherever that stands: the first part of a plan.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "experiment/robot_body.h"
#include "grasp/fingertip_motion.h"
#include "grasp/generate.h"
#include "grasp/grasp.h"
#include "kinematics/contact_posture.h"
#include "kinematics/human_hand.h"

namespace springgrasp {

struct Hold {
  FingertipMotion motion;                // as demonstrated, on this object
  std::vector<Eigen::VectorXd> q_human;  // rad, the demonstrator's hand at its samples
  ContactPosture posture;                // of the robot's hand
  // Fingers that close; of a lateral grasp the index lies where the plate comes to.
  PerFinger<bool> closing = {};
  Eigen::VectorXd q_open;  // rad, as far as the hand opens in gravity
};

// `generate`: the object, where it stands, and the duration of the reach.
Hold PlanHold(const RobotBody& body, const HumanHand& human, const Grasp& grasp,
              const GenerateOptions& generate);

// The held posture with the closing fingers opened until they are `clearance` (m) off the object.
Eigen::VectorXd OpenedHold(const RobotHand& hand, const Hold& hold, const Shape& shape,
                           double clearance);

// Distance of palm and fingers that are not involved from the object in the hand, a little less, m.
double SpareDistance(const RobotHand& hand, const Shape& shape, const Hold& hold);

// Joints along a way of hand poses X_WH: what does not bear on the object yet hangs deeper.
void LetHang(const RobotHand& hand, const std::vector<Pose>& X_WH, std::vector<Eigen::VectorXd>& q);

}  // namespace springgrasp
