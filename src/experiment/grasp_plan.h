// COMMANDS: what the robot is going to do, planned before the trial starts.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "base/fingers.h"
#include "base/pose.h"
#include "base/shape.h"
#include "control/grip_controller.h"
#include "control/robot_state.h"

namespace springgrasp {

struct GraspPlan {
  std::string type;  // pinch | tripod | power | lateral
  PerFinger<bool> involved = {};
  Shape shape;                                   // believed
  double mass = 0.1, friction = 0.9;             // believed, kg
  double dt = 0.005;                             // s, of all paths below
  double T = 0;                                  // s, duration of the reach
  std::vector<Pose> X_WH;                        // robot hand through the reach, to its end (1.5 T)
  std::vector<ArmVector> arm;                    // rad, same samples
  std::vector<HandVector> hand;                  // rad, same samples
  std::vector<PerFinger<Eigen::Vector3d>> p_WF;  // planned fingertips, m
  std::vector<ArmVector> lift;                   // rad, from the end of the reach straight up
  std::array<std::vector<ArmVector>, 3> shake;   // rad, about the lifted pose, along W's axes
  // Where the object shall be set down; both paths empty: nowhere.
  Pose X_WO_place = Pose::Identity();
  std::vector<Pose> X_WH_place;    // hand from the lifted pose to there
  std::vector<ArmVector> place;    // rad, same samples
  std::vector<ArmVector> retreat;  // rad, from there out of the object's way
  HandVector released;             // rad, the hand that lets go
  Pose X_HO = Pose::Identity();    // object in the robot's hand at contact
  // Outward normals of the surface where involved pads touch, in the hand.
  PerFinger<Eigen::Vector3d> n_HC = NoDirections();
};

// The planned hand pose of the reach at time t (s), between its samples; before and after, its
// ends.
Pose PlannedHandPose(const GraspPlan& plan, double t);

// The planned fingertip of one sample of the reach, in H.
Eigen::Vector3d PlannedTipInHand(const GraspPlan& plan, std::size_t sample, int finger);

}  // namespace springgrasp
