// From a grasp of the library to the robot's commands: contacts, hand mapping (Eq. (14)-(16)), arm.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiment/finger_baseline.h"
#include "experiment/grasp_plan.h"
#include "experiment/phases.h"
#include "experiment/robot_body.h"
#include "grasp/fingertip_motion.h"
#include "grasp/grasp.h"
#include "kinematics/contact_posture.h"
#include "kinematics/reach_plan.h"
#include "sim/scene.h"

namespace springgrasp {

struct PlanRequest {
  BelievedObject object;                    // its shape must be known
  double table_height = 0;                  // m
  double table_edge = -1e9;                 // m, W's y where the table begins
  std::vector<Obstacle> obstacles;          // fixed things on it
  ArmVector arm_start = ArmVector::Zero();  // rad
  TrialCriteria criteria;                   // lift and shake are planned too
  double dt = 0.005;                        // s
  std::optional<Eigen::Vector2d> place;     // where to set it down, m
  bool object_centre = false;               // Eq. (6) alone, no contact points
  std::optional<BaselineRequest> baseline;  // moves the fingers in the springs' place
  bool seek_holds = true;                   // `holds` of a blocked start, too
};

struct PlanResult {
  std::optional<GraspPlan> plan;  // nothing: unreachable, for this reason
  std::string reason;
  FingertipMotion motion;  // as generated for the chosen pose of the grasp
  ContactPosture posture;
  double mapping_error = 0;    // m, involved fingertips against those wanted, mean over the motion
  double limit_margin = 0;     // see ReachPlan
  double table_clearance = 0;  // m
  double self_clearance = 0;   // m, see ReachPlan
  double join = 0;             // of T: before, the arm comes straight from its start
  double clearance = 0;        // m, hand and object before closing
  // Hand poses that would hold the object, reached or not: a base to reach them from may be sought.
  std::vector<Pose> holds;
  bool blocked = false;       // the robot would begin in the object's place
  double free_angle_deg = 0;  // how far the chosen pose is turned from the demonstrated one
};

// System contract 5.5-5.7: the grasp frame G is carried over, not the wrist; what the object leaves
// free is chosen by reachability and clearance. Throws Error for an object without a shape.
PlanResult PlanGrasp(const RobotBody& body, const Grasp& grasp, const PlanRequest& request);

}  // namespace springgrasp
