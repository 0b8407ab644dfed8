// The robot's own kinematics, and the human hand it compares itself with: what planning knows.
#pragma once

#include "kinematics/arm_body.h"
#include "kinematics/arm_ik.h"
#include "kinematics/human_hand.h"
#include "kinematics/robot_hand.h"
#include "sim/scene.h"
#include "sim/simulation.h"

namespace springgrasp {

struct RobotBody {
  Arm arm;           // world to hand frame H
  ArmBody arm_body;  // its links, and what of the robot they could hit
  RobotHand hand;
  HumanHand human;  // MMM hand as shipped, kMmmHandLength; planning scales it
  // All of it is the image of the left side in a mirror (kinematics/mirror.h), planned for as a
  // right one in the mirrored world.
  bool mirrored = false;
};

// "r", or "l" where the scene moves the left hand alone.
std::string GraspingSide(const Scene& scene);

// From a scene's model at its start posture. Throws Error if the model lacks arm or hand.
RobotBody MakeRobotBody(const Simulation& simulation, const std::string& side = "r");

}  // namespace springgrasp
