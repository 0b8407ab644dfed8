// The arm's solid links and what of the robot they could hit.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/pose.h"
#include "base/shape.h"
#include "kinematics/arm_ik.h"

namespace springgrasp {

// A capsule fixed to a body, or to the world. A sphere if a = b.
struct BodyCapsule {
  int node = -1;                                                             // of the arm's tree
  Eigen::Vector3d a = Eigen::Vector3d::Zero(), b = Eigen::Vector3d::Zero();  // m, in its node
  double radius = 0;                                                         // m
};

struct ArmBody {
  std::vector<BodyCapsule> links;  // that move: shoulder to hand
  std::vector<BodyCapsule> rest;   // that stand still, in W (node -1): trunk, head, other arm
  struct Block {
    Shape shape;
    Pose X_WO = Pose::Identity();
  };
  std::vector<Block> blocks;  // what of it is no capsule
  // Pairs link x rest and link x block that may touch (neighbours at a joint), link-major.
  std::vector<bool> exempt_rest, exempt_blocks;
};

// Distance of two segments, m.
double SegmentDistance(const Eigen::Vector3d& p, const Eigen::Vector3d& q, const Eigen::Vector3d& r,
                       const Eigen::Vector3d& s);

// Smallest distance between the arm's links and the rest of the robot, m; negative: they overlap.
// What is farther than `enough` need not be exact. `X_WB`: scratch.
double SelfClearance(const Arm& arm, const ArmBody& body, const Eigen::VectorXd& q, double enough,
                     std::vector<Pose>& X_WB);

// Smallest distance between the arm's links, without the hand, and a shape at X_WO, m; negative:
// they overlap. `X_WB`: scratch.
double ArmDistance(const Arm& arm, const ArmBody& body, const Eigen::VectorXd& q,
                   const Shape& shape, const Pose& X_WO, std::vector<Pose>& X_WB);

}  // namespace springgrasp
