// Inverse kinematics of the arm: joint angles for a pose of the hand frame H.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "base/pose.h"
#include "kinematics/kinematic_tree.h"

namespace springgrasp {

struct Arm {
  KinematicTree tree;       // root: world
  int frame = -1;           // of H
  std::vector<int> joints;  // that may move, indices into the tree's q
  Eigen::VectorXd q;        // full posture: values of all others, and home of those
  int num_joints() const { return static_cast<int>(joints.size()); }
};

// The arm of a tree in the world that ends at `frame` ("hand_r_H"): its joints named `prefix`...
// ("arm_r_", in the tree's order). With `torso` the joints named torso_... come first. `q`: full
// posture of the tree (others stay there). Throws Error if there is no such joint or frame.
Arm MakeArm(const KinematicTree& tree, const std::string& frame, const std::string& prefix,
            const Eigen::VectorXd& q, bool torso = false);

// An arm of the usual kind is solved in closed form (arm_swivel.h), any other by
// Levenberg-Marquardt (arm_ik_numeric.h).
struct ArmIkOptions {
  double limit_weight = 0.02;  // pulls joints towards the middle of their range
  double near_weight = 0.3;    // per rad^2, of SolveArmIkFromAnywhere's `near`
  double margin = 0.02;        // rad, kept from the limits
  // Of the numeric solver.
  double position_tolerance = 1e-4;  // m
  double rotation_tolerance = 1e-3;  // rad
  int max_iterations = 60;
  int starts = 24;  // of SolveArmIkFromAnywhere
};

// Pose X_WH at the arm's joint values (size num_joints).
Pose HandPose(const Arm& arm, const Eigen::VectorXd& q);

// The solution nearest to a start, a little drawn to mid range; nullopt: out of reach (numeric: not
// reached within the tolerances from there).
std::optional<Eigen::VectorXd> SolveArmIk(const Arm& arm, const Pose& X_WH,
                                          const Eigen::VectorXd& start,
                                          const ArmIkOptions& options = {});

// Of all solutions the one that is far from its joint limits, has its elbow low, and is near to
// `near` if given.
std::optional<Eigen::VectorXd> SolveArmIkFromAnywhere(
    const Arm& arm, const Pose& X_WH, const ArmIkOptions& options = {},
    const std::optional<Eigen::VectorXd>& near = std::nullopt);

// Follows a path of poses from a joint posture that solves the first one (or is near to it). Steps
// of more than `max_step` rad between samples count as failure. Joint angles at all samples, or
// the index where it failed.
struct ArmPath {
  std::vector<Eigen::VectorXd> q;  // as far as it went
  bool complete = false;
  std::string reason;   // why not complete
  double max_step = 0;  // rad
};
ArmPath TrackArmPath(const Arm& arm, const std::vector<Pose>& X_WH, const Eigen::VectorXd& start,
                     double max_step = 0.15, const ArmIkOptions& options = {});

// Smallest distance of any moving joint to its limits, as a fraction of half its range, 0..1.
double LimitMargin(const Arm& arm, const Eigen::VectorXd& q);

}  // namespace springgrasp
