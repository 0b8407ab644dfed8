// The arm's joint path along a reach of the hand, from where the arm stands.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/pose.h"
#include "kinematics/arm_ik.h"
#include "kinematics/arm_swivel.h"

namespace springgrasp {

struct ReachPathRequest {
  std::vector<Pose> X_WH;  // the hand's way at even steps, to its end
  Eigen::VectorXd q_goal;  // arm joints at its last pose, rad
  // Where the arm stands; absent: the joint path begins in any posture that solves the first pose.
  std::optional<Eigen::VectorXd> q_start;
  double dt = 0.005;     // s, between samples
  double max_speed = 4;  // rad/s, of any joint
  int latest_join = 0;   // sample; 0: the whole way has to be followed
  // Whether hand poses and joints up to a sample are free of obstacles; for ways of our own making.
  std::function<bool(const std::vector<Pose>& X_WH, const std::vector<Eigen::VectorXd>& q, int end)>
      clear;
  // Cost per second of a posture near an obstacle, infinite in it; may be empty. What the elbow's
  // way is bent around (swivel_path.h).
  std::function<double(const SevenJoints& q, int sample)> obstacles;
};

struct ReachPath {
  bool complete = false;
  std::string reason;  // one line when not complete
  std::vector<Eigen::VectorXd> q;
  std::vector<Pose> X_WH;  // as asked from sample `join` on
  int join = 0;            // before it the arm comes straight from its start, in joint space
};

// Follows the hand's way from q_start to near q_goal with the elbow's course of PlanSwivelPath.
// Where the arm cannot do that it comes from q_start on a quintic in joint space that joins the way
// at the earliest sample possible, not after latest_join. (Arms without closed form: backwards from
// the goal, turned to q_start within the null space.)
ReachPath FollowReach(const Arm& arm, const ReachPathRequest& request);

}  // namespace springgrasp
