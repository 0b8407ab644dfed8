// The MMM hand (21 joints) as kinematics: the intermediate hand model of paper section III-C.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/fingers.h"
#include "kinematics/kinematic_tree.h"

namespace springgrasp {

// Wrist centre to middle fingertip of the hand in models/mmm_hand: 0.108 of 1.75 m body height.
inline constexpr double kMmmHandLength = 0.189;  // m

struct HumanHand {
  KinematicTree tree;                  // root: H
  PerFinger<std::vector<int>> joints;  // from the wrist to the tip, indices into q
  PerFinger<int> base = {};            // node of the knuckle (thumb: CMC), where flexion begins
  PerFinger<int> tip = {};             // frame of the pad sphere's centre
  PerFinger<double> length = {};       // base to tip centre at q = 0, m
  Eigen::VectorXd rest;                // relaxed posture, rad: fingers that were not seen
};

// From the tree below body `mmm_hand` (its frame is H). Joints are found by their MMM names.
// Throws Error if one is missing.
HumanHand MakeHumanHand(KinematicTree tree);

// The same hand with all lengths multiplied by `factor`.
HumanHand ScaledHand(const HumanHand& hand, double factor);

// Flexion angles that Eq. (14) compares, rad. Thumb: CMC flexion + MCP (from straight out of the
// palm plane's 45 degrees), IP. Fingers: MCP, PIP + DIP.
struct FlexionAngles {
  double proximal = 0;
  double distal = 0;
};
PerFinger<FlexionAngles> FlexionOf(const HumanHand& hand, const Eigen::VectorXd& q);
// Turn of the thumb's CMC joint about the hand's long axis, rad: 0 beside the index, in the plane
// of the palm; pi/2 before the palm.
double OppositionOf(const HumanHand& hand, const Eigen::VectorXd& q);

}  // namespace springgrasp
