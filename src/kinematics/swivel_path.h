// The elbow's way along a path of hand poses: of all swivels that the joint ranges and obstacles
// allow, the course that is smoothest over the whole path.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "base/pose.h"
#include "kinematics/arm_choice.h"
#include "kinematics/arm_ik.h"

namespace springgrasp {

struct SwivelPathRequest {
  std::vector<Pose> X_WH;                 // even steps
  double dt = 0.005;                      // s
  std::optional<Eigen::VectorXd> start;   // joints at the first pose, rad; absent: free
  std::optional<Eigen::VectorXd> goal;    // the last pose is taken near these, rad; absent: free
  std::optional<Eigen::VectorXd> origin;  // as goal, of the first pose, where start is absent
  double max_speed = 4;                   // rad/s, of any joint
  double margin = 0.02;                   // rad, kept from the joint ranges
  // Cost per second of being in a posture at a sample, infinite where it collides; may be empty.
  std::function<double(const SevenJoints& q, int sample)> obstacles;
};

// Minimises over the path the cost of the postures (limits, elbow height, obstacles) and the square
// of the joint speeds: by dynamic programming over a grid of swivels every 50 ms, which finds a way
// where there is one, then by descent with the square of the accelerations. Joints at all samples,
// or the reason why there is no way. The arm changes its branch only where two of them meet.
ArmPath PlanSwivelPath(const ArmGeometry& geometry, const SwivelPathRequest& request,
                       const ArmPreference& preference = {});

}  // namespace springgrasp
