// What a camera sees of a hand whose kinematics are known: balls along its bones and in its palm.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "base/fingers.h"
#include "kinematics/kinematic_tree.h"

namespace springgrasp {

// A ball fixed to a body of the tree, all lengths for scale 1.
struct HandBall {
  int node = 0;
  Eigen::Vector3d p_B = Eigen::Vector3d::Zero();  // m
  double radius = 0.008;                          // m
  bool forearm = false;                           // may be sleeved: explains skin but asks for none
  bool cut = false;  // the sleeve begins here: the outline of the skin need not be that of the ball
};

struct HandModel {
  KinematicTree tree;           // root: H
  PerFinger<int> tip = {};      // frames mmm_<finger>_tip
  std::vector<HandBall> balls;  // fingers, palm, and the beginning of the forearm
  Eigen::VectorXd rest;         // rad: where joints are when nothing tells them
  Eigen::VectorXd rest_sigma;   // rad: how surely
  std::vector<int> finger;      // whose joint it is
  std::vector<bool> abduction;  // of a finger, to its neighbours' side
  std::vector<bool> bends;      // at a knuckle or within a finger
  // Pairs (PIP, DIP): the end joint follows the middle one by two thirds.
  std::vector<std::pair<int, int>> coupled;
  // The same joint of neighbouring fingers (MCP, PIP; index to pinkie): they bend alike, loosely.
  std::vector<std::pair<int, int>> neighbours;
  // Where the bare forearm ends on the x axis of H (negative, m, for scale 1), once it is known.
  std::optional<double> sleeve_x;
};

// From a tree whose root is H and which has the frames `mmm_<finger>_tip`; `rest` (size
// num_joints, rad) is the posture to fall back to, by default a third of each flexion's range.
// Throws Error if a tip is missing.
HandModel MakeHandModel(const KinematicTree& tree, const Eigen::VectorXd& rest = {});

// A sleeve stays where it is: of the forearm only the balls from the wrist to the first that was
// not `bare` (one entry per ball) are kept, the last of them as cut by the sleeve.
void KeepBareForearm(const std::vector<bool>& bare, HandModel& model);

}  // namespace springgrasp
