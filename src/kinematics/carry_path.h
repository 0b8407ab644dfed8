// The arm's joints while it carries what the hand holds: straight up, then to and fro.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "kinematics/arm_ik.h"
#include "kinematics/arm_swivel.h"

namespace springgrasp {

struct CarryRequest {
  Pose X_WH = Pose::Identity();  // where the hand closed
  Eigen::VectorXd q;             // joints there, rad
  double dt = 0.005;             // s
  double lift = 0.15;            // m
  double lift_duration = 1.5;    // s
  double shake = 0.020;          // m, along each axis of W
  double shake_frequency = 2;    // Hz
  double shake_duration = 1;     // s, per axis
  double max_speed = 4;          // rad/s, of any joint
  double margin = 0.02;          // rad, kept from the joint ranges
  // Cost per second of a posture, infinite where it collides; may be empty.
  std::function<double(const SevenJoints&)> obstacles;
};

struct CarryPath {
  bool complete = false;
  std::string reason;                                 // why not complete
  std::vector<Eigen::VectorXd> lift;                  // from the start straight up, rad, at dt
  std::array<std::vector<Eigen::VectorXd>, 3> shake;  // about the lifted pose, from and to rest
};

// An arm of the usual kind (GeometryOf) lifts along the elbow's smoothest way to a posture from
// which it can be shaken. Each shake keeps one branch, and its swivel is a parabola of the hand's
// displacement: joints are as smooth in time as the displacement. Any other arm tracks pose by
// pose.
CarryPath PlanCarry(const Arm& arm, const CarryRequest& request);

// Of a hand that moves to and fro on a line through one pose.
class ShakePostures {
 public:
  // `by_W`: displacement at s = 1, m. `max_slope`: rad, of any joint per unit of s.
  ShakePostures(const ArmGeometry& geometry, const Pose& X_WH, const Eigen::Vector3d& by_W,
                double max_slope, double margin);

  // The parabola of the swivel that moves the joints least and most evenly, from the posture with
  // `swivel` on `branch` at s = 0. Returns its cost: infinite where a joint would leave its range
  // or be too fast.
  double Fit(const SwivelInterval& branch, double swivel);
  // Joints on the last fit at s in [-1, 1].
  SevenJoints At(double s) const;

 private:
  static constexpr int kPoints = 9;
  double CostOf(double slope, double bend) const;  // of the branch and swivel at hand

  const ArmGeometry& geometry_;
  const Pose X_WH_;
  const Eigen::Vector3d by_W_;
  const double max_slope_, margin_;
  std::array<ArmSolutions, kPoints> solutions_;
  SwivelInterval branch_;
  double swivel_ = 0, slope_ = 0, bend_ = 0;
};

}  // namespace springgrasp
