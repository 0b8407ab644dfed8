// Where the hand can grasp: from how many directions the arm brings the hand's grasp centre to a
// place, in closed form.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "kinematics/arm_body.h"
#include "kinematics/arm_ik.h"
#include "kinematics/robot_hand.h"

namespace springgrasp {

enum class Approach {
  kSide,   // hand level, its fingers close about an upright axis
  kAbove,  // fingers down
};

struct ReachMapOptions {
  int directions = 12;               // of the hand about the vertical
  double max_tilt = 0.35;            // rad, side: of the hand from level
  double max_slant = 0.7;            // rad, above: of the fingers from the vertical
  double clearance = 0.002;          // m, of hand and forearm above the table
  double cell = 0.05;                // m
  double x_from = -0.1, x_to = 0.7;  // m, W
  double y_from = 0.2, y_to = 0.8;
};

// What stands in the way besides the joint ranges.
struct ReachSurroundings {
  const ArmBody* body = nullptr;  // null: not looked at
  double table_height = -1e9;     // m, world
  double table_edge = -1e9;       // m, W's y where the table begins
};

// Directions, 0 .. options.directions, in which some hand pose of the approach has its grasp centre
// (`p_HG`, m, in H) at p_WG: reached, and clear of the surroundings.
int CountDirections(const Arm& arm, const RobotHand& hand, const Eigen::Vector3d& p_HG,
                    const Eigen::Vector3d& p_WG, Approach approach,
                    const ReachSurroundings& surroundings, const ReachMapOptions& options = {});

struct ReachMap {
  double z = 0;  // m, of the grasp centre in W
  int columns = 0, rows = 0;
  std::vector<int> side, above;  // directions, row-major; rows go with y, the nearest first
};
ReachMap MakeReachMap(const Arm& arm, const RobotHand& hand, const Eigen::Vector3d& p_HG, double z,
                      const ReachSurroundings& surroundings, const ReachMapOptions& options = {});

// One character per cell, farthest row first: '.' none, 1 to 9 tenths of the directions, '#' all.
std::string FormatReachMap(const ReachMap& map, const std::vector<int>& counts,
                           const ReachMapOptions& options);

}  // namespace springgrasp
