// The demonstrator's hand (MMM model) as kinematics: fingertips, finger segments, named postures.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "base/fingers.h"
#include "kinematics/human_hand.h"
#include "kinematics/kinematic_tree.h"

namespace springgrasp {

struct HandSize {
  double length = kMmmHandLength;  // m, wrist centre to middle fingertip
  double cap_radius = 0.010;       // m, of the largest cap
};

struct DemonstratorHand {
  KinematicTree tree;                 // root: H
  PerFinger<int> tip_frames = {};     // of the pad spheres
  PerFinger<std::vector<int>> links;  // bodies with a segment, from the knuckle outwards
  HandSize size;
  double tip_radius = 0.008;      // m; given for a hand of kMmmHandLength, scaled with it
  double finger_radius = 0.0085;  // m, of the segments; likewise
  Eigen::VectorXd open;           // five separable fingertips, rad
  Eigen::VectorXd relaxed;        // rad

  double scale() const { return size.length / kMmmHandLength; }
};

// From the tree below body `mmm_hand` (sim/kinematic_tree_of.h) of a hand of that size, with the
// postures in open.yaml and relaxed.yaml of `folder` (default: the shipped models/mmm_hand). Throws
// Error if a joint, a tip or a file is missing.
DemonstratorHand MakeDemonstratorHand(KinematicTree tree, const HandSize& size = {},
                                      const std::string& folder = "");

// Reads `joint: angle` lines (rad, within the joint ranges); joints not named are 0. Throws Error.
Eigen::VectorXd ReadPosture(const KinematicTree& tree, const std::string& path);

// Joint angles of one posture, rad.
struct ThumbAngles {
  double opposition = 0, flexion = 0, mcp = 0, ip = 0;
};
struct FingerAngles {
  double abduction = 0, mcp = 0, pip = 0, dip = 0;
};
// `fingers`: index to pinkie.
Eigen::VectorXd PostureOf(const KinematicTree& tree, const ThumbAngles& thumb,
                          const std::array<FingerAngles, 4>& fingers);

// Where the parts of the hand are at joints q, in H.
struct HandShape {
  PerFinger<Eigen::Vector3d> tips;                 // pad-sphere centres, m
  PerFinger<std::vector<Eigen::Vector3d>> chains;  // knuckle, joints, tip of each finger, m
};
// `bodies` is scratch space, so that repeated calls do not allocate.
void ComputeHandShape(const DemonstratorHand& hand, const Eigen::Ref<const Eigen::VectorXd>& q,
                      std::vector<Pose>& bodies, HandShape& shape);
HandShape ComputeHandShape(const DemonstratorHand& hand, const Eigen::VectorXd& q);

}  // namespace springgrasp
