// The reach of a demonstration as a DMP of the grasp frame G in the object frame O.
#pragma once

#include <vector>

#include "base/pose.h"
#include "motion/dmp.h"

namespace springgrasp {

// Hz times the duration: what is faster in a reach is no reach. Eq. (7) takes its acceleration for
// the force on the fingers, and of that a tracker's faults would be the larger part.
inline constexpr double kReachBandwidth = 3.5;

struct LearnedReach {
  PoseDmp dmp;
  double T = 1;               // s
  double lead = 0, tail = 0;  // s, completed at the ends where the recording was cut (5.4)
  double rmse = 0;            // of the origin of G where it was measured, m
};

// From smoothed poses X_OG at even steps of `dt`, the reach from its start to the contact,
// completed to rest at both ends.
LearnedReach LearnReach(const std::vector<Pose>& X_OG, double dt, int basis_functions);

// Hand of a rollout: H = G X_GH.
struct HandPath {
  std::vector<Pose> X_OG;            // at even steps from t = 0
  std::vector<double> acceleration;  // |a| of H's origin, m/s^2
  double t_switch = 0;               // s, largest speed of that origin between 0 and T (Eq. (7))
};
HandPath RollOutHand(const PoseDmp& dmp, const Pose& X_GH, double T, double dt, int count);

}  // namespace springgrasp
