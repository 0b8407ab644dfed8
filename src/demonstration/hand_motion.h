// HAND MOTION: what the demonstrator's hand does before the cameras. The truth of an observation;
// the tracker never sees it.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "base/fingers.h"
#include "base/pose.h"
#include "demonstration/demonstration.h"

namespace springgrasp {

struct HandMotionSample {
  double t = 0;  // s; 0 is the first sample of the demonstration, negative the lead-in
  Pose X_WH = Pose::Identity();
  Eigen::VectorXd q;              // finger joints of the MMM hand, rad
  bool wrist_recorded = false;    // else synthesised, solved for or bridged
  PerFinger<bool> recorded = {};  // the fingertip was measured; else posed or bridged
};

struct HandMotion {
  std::string source;
  std::string type;                      // pinch | tripod | power | lateral | "" (unknown)
  std::vector<std::string> joint_names;  // of q
  PerFinger<bool> involved = {};         // fingers that touch the object in the end
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  std::optional<DemonstratedObject> object;
  std::vector<std::string> comments;      // what was assumed, for the CSV
  std::vector<HandMotionSample> samples;  // in time order
};

// The same motion elsewhere: W' is the new world, X_VW its pose for the old coordinates.
HandMotion Moved(const HandMotion& motion, const Pose& X_VW);

// State at time t by interpolation (linear, rotations by slerp); flags of the earlier neighbour
// hold if those of the later do. Clamped to the ends.
HandMotionSample Interpolated(const HandMotion& motion, double t);

// Even samples at `rate` Hz, one of them at t = 0.
HandMotion Resampled(const HandMotion& motion, double rate);

// The same motion, slower or faster throughout: the wrist's largest speed (over 30 ms of the motion
// as it was) becomes `speed`, m/s; t = 0 stays. Throws Error if the wrist does not move.
HandMotion AtPeakSpeed(const HandMotion& motion, double speed);

// Puts `duration` seconds of the open hand before the first sample: from rest at joints `q_open`
// into the first sample, meeting its position and velocity (minimum jerk), t from -duration.
HandMotion WithLeadIn(const HandMotion& motion, const Eigen::VectorXd& q_open,
                      double duration = 0.5, double rate = 100);

}  // namespace springgrasp
