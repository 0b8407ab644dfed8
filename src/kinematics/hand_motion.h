// The robot hand's joints through a grasp: human-like in the reach, on the contacts at its end.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/fingers.h"
#include "base/pose.h"
#include "base/shape.h"
#include "kinematics/contact_posture.h"
#include "kinematics/hand_mapping.h"
#include "kinematics/human_hand.h"
#include "kinematics/robot_hand.h"

namespace springgrasp {

// All series at the same even steps, from t = 0.
struct HandMotionRequest {
  double dt = 0.005;                     // s
  double T = 1;                          // s, end of the reach: contact
  double t_switch = 0.5;                 // s, closing begins (Eq. (7))
  std::vector<Eigen::VectorXd> q_human;  // MMM hand, rad (SolveHandMotion)
  // Where the robot's tips belong when they near the object, in the ROBOT's H, m: the human ones
  // about the object as the robot holds it, X_HO(robot) X_OH(human, T) p_HF(t).
  std::vector<PerFinger<Eigen::Vector3d>> p_HF;
  std::vector<Pose> X_OH;  // the ROBOT's hand in O: X_OG(t) X_HG(robot)^-1
  PerFinger<bool> involved = {};
  Shape shape;
};

struct HandMotionOptions {
  double clearance = 0.010;      // m, of the open hand from the object before it closes
  double lambda_contact = 1000;  // position weight at contact (Eq. (14): 1)
  double closing = 0.25;         // last part of T in which the clearance may fall to zero
  double max_speed = 8;          // rad/s, of a finger joint (3 degrees in 5 ms would be 10.5)
  MappingOptions mapping;
};

struct HandMotionResult {
  std::vector<Eigen::VectorXd> q;                // robot hand joints, rad; from T on the posture's
  std::vector<PerFinger<Eigen::Vector3d>> p_HF;  // tips in the robot's H, m
  double max_step = 0;                           // rad, largest joint step between samples
  double clearance = 0;                          // m, smallest before closing begins
  double mapping_error = 0;  // m, mean tip error to the wanted ones, until T (involved)
};

// What MapHandMotion asks of the mapping at each sample: the human posture and its scaled tips with
// lambda = 1, and from t_switch on, for the involved fingers, more and more the tips of the request
// with a weight that rises to lambda_contact. Tips near or beyond the end of a finger's reach are
// drawn in smoothly, the contacts excepted.
std::vector<MappingTarget> MappingTargets(const HumanHand& human, const RobotHand& robot,
                                          const HandMotionRequest& request,
                                          const HandMotionOptions& options = {});

HandMotionResult MapHandMotion(const HumanHand& human, const RobotHand& robot,
                               const HandMotionRequest& request, const ContactPosture& posture,
                               const HandMotionOptions& options = {});

// Moves a hand path away from the object where the open hand would touch it: adds the smallest
// offsets a * bump(t) along a retreat direction (out of the palm's back, back along the fingers, or
// between) so that the hand at `q_open` keeps `clearance` before the last `closing` part of T, and
// from there what it has at the goal and more the farther it is from T. The bumps are 0 at both
// ends, with zero velocity; the first is largest in the middle of the reach, the second, if `late`,
// towards its end. Returns the path in O; unchanged where it is clear.
std::vector<Pose> ClearApproach(const RobotHand& robot, const Shape& shape,
                                const std::vector<Pose>& X_OH, const Eigen::VectorXd& q_open,
                                double dt, double T, double clearance, double closing = 0.25,
                                bool late = true);

// A hand path that takes a plate edge on: G comes into the plate's plane, a little towards the
// fingers' side of it, and the hand turns as it will hold it, within the first part of T; the rest
// is along the plane. `n_O`: the plate's normal on the thumb's side; `X_HG`: G in H.
std::vector<Pose> EdgeOnApproach(const std::vector<Pose>& X_OH, const Pose& X_HG,
                                 const Eigen::Vector3d& n_O, double dt, double T);

// The contact posture with the involved fingers opened until they are `clearance` off the object
// (or as far as they open): what the hand looks like before it closes.
Eigen::VectorXd OpenedPosture(const RobotHand& robot, const ContactPosture& posture,
                              const Shape& shape, const PerFinger<bool>& involved,
                              double clearance);

}  // namespace springgrasp
