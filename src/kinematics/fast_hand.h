// Forward kinematics of a hand by the angles of its valves, for solving a frame in microseconds.
#pragma once

#include <Eigen/Core>
#include <array>

#include "kinematics/robot_hand.h"

namespace springgrasp {

inline constexpr int kMostValves = 8;  // of a hand; a hand with fewer leaves the rest at 0
using ValveAngles = Eigen::Matrix<double, kMostValves, 1>;
using ValveMatrix = Eigen::Matrix<double, kMostValves, kMostValves>;

// Sines and cosines are taken once per valve, nothing comes from the heap.
class FastHand {
 public:
  // Throws Error for a hand with slides, or more bodies or valves than fit.
  explicit FastHand(const RobotHand& robot);

  // Does nothing for the angles that it was moved to last.
  void Move(const ValveAngles& x);

  struct Body {
    int parent = -1, valve = -1;
    Eigen::Vector3d p, axis;
    Eigen::Matrix3d fixed, C, S;
    Eigen::Matrix3d R_HB;  // where Move left it, in H
    Eigen::Vector3d p_HB;
  };
  const Body& body(int node) const { return bodies_[node]; }

 private:
  static constexpr int kMostNodes = 24;
  std::array<Body, kMostNodes> bodies_;
  int count_ = 0;
  ValveAngles x_;  // where it is; at first nowhere
  std::array<double, kMostValves> sin_, cos_;
};

}  // namespace springgrasp
