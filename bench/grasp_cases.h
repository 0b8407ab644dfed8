// Grasps of the library generated for objects of other sizes and places, at other speeds: what the
// statistics of the mapping and of the arm are taken over.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "experiment/robot_body.h"
#include "grasp/fingertip_motion.h"
#include "grasp/grasp.h"
#include "kinematics/contact_posture.h"
#include "kinematics/hand_motion.h"

namespace springgrasp {

// Right hand and arm; the lateral grasp needs the thumb that turns.
struct GraspBodies {
  RobotBody documented, opposition;
  const RobotBody& For(const std::string& type) const {
    return type == "lateral" ? opposition : documented;
  }
};
GraspBodies MakeGraspBodies();

struct GraspCase {
  std::string type;
  const RobotBody* body = nullptr;
  HumanHand human;                       // that demonstrated
  FingertipMotion motion;                // even steps of dt
  std::vector<Eigen::VectorXd> q_human;  // by SolveHandMotionSmoothly, rad
  ContactPosture posture;                // of the robot
  HandMotionRequest request;
};

// Number n of the stream `seed`: the four types by turns; object size, its turn, the start of the
// reach and its duration drawn. dt in s.
GraspCase MakeGraspCase(const GraspBodies& bodies, const std::vector<Grasp>& library,
                        std::uint64_t seed, std::uint64_t n, double dt = 0.005);

// The sample at which the fingers touch.
int Anchor(const GraspCase& c);

// pinch, tripod, power, lateral of models/grasps.
std::vector<Grasp> ReadLibrary();

}  // namespace springgrasp
