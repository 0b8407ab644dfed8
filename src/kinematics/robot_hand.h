// A robot hand as the mapping sees it. A second hand is another value of this struct.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "base/fingers.h"
#include "base/pose.h"
#include "kinematics/kinematic_tree.h"

namespace springgrasp {

// A rounded piece of a link, for clearances. Points in the frame of its node.
struct LinkCapsule {
  int node = -1;
  int finger = -1;                                                           // 0..4; -1: palm
  bool distal = false;                                                       // last phalanx
  Eigen::Vector3d a = Eigen::Vector3d::Zero(), b = Eigen::Vector3d::Zero();  // axis ends, m
  double radius = 0;                                                         // m
};

struct RobotHand {
  struct Finger {
    int j0 = -1, j1 = -1;                                      // joints: proximal, distal
    int base = -1;                                             // node that j0 turns
    int tip = -1;                                              // frame of the pad sphere's centre
    double length = 0;                                         // base to tip centre, straight, m
    Eigen::Vector2d flexion_offset = Eigen::Vector2d::Zero();  // robot angle at human angle 0
  };
  std::string name;
  KinematicTree tree;  // root: H of the robot; q in the order of joint_names
  PerFinger<Finger> fingers;
  int palm = -1;        // joint that moves the four fingers; -1: none
  int opposition = -1;  // joint that turns the thumb about the hand's long axis; -1: none
  std::vector<std::vector<int>> valves;  // joints driven by each valve (equal torque)
  std::vector<int> valve_of;             // of each joint
  double tip_radius = 0;                 // m
  // Frame A of straight fingers: x along them, y along their common axes towards the thumb side,
  // z out of the back. Human H and robot A have the same meaning for directions.
  Eigen::Matrix3d R_HA = Eigen::Matrix3d::Identity();
  Eigen::Vector3d p_HPalm = Eigen::Vector3d::Zero();  // middle of the palm plate's surface, m
  std::vector<LinkCapsule> capsules;
  Eigen::VectorXd open;  // all fingers open, rad
};

// The ARMAR-IIIb hand from the tree below its hand body (`hand_r` or `hand_l`; frames
// <side>_H and <side>_<finger>_tip, side = "hand_r" or "hand_l"). Joint order of the result: palm,
// then j0, j1 of thumb .. pinkie, then the variant's opposition joint. Capsules as the MJCF's
// (documented in models/armar3b/README.md). Throws Error if a joint or frame is missing.
//
// Thumb angles: the human thumb at full opposition and CMC flexion 0 points 45 degrees forward of
// the palm's normal, the robot's at J0 = 0 straight along the normal, both flex towards the
// fingers. So J0 = pi/4 + CMC + MCP: the fully extended human thumb (CMC = -45 degrees) is the
// robot's open one.
RobotHand MakeArmarHand(const KinematicTree& tree, const std::string& side = "hand_r");

// Tip centres in H.
PerFinger<Eigen::Vector3d> TipPositions(const RobotHand& hand, const Eigen::VectorXd& q);

}  // namespace springgrasp
