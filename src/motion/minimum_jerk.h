// Minimum-jerk movements: the polynomials that human point-to-point movements follow.
#pragma once

#include <Eigen/Core>

#include "motion/motion_samples.h"

namespace springgrasp {

// State of a movement at an instant, n coordinates.
struct MotionState {
  Eigen::VectorXd x, v, a;
};

// Quintic between two states: least integral of squared jerk.
struct MinimumJerk {
  double T = 1;                  // s
  Eigen::MatrixXd coefficients;  // n x 6, of 1, t, ..., t^5 (t in s)
};
MinimumJerk MakeMinimumJerk(const MotionState& start, const MotionState& end, double T);
// The state at t, held to [0, T].
MotionState EvaluateMinimumJerk(const MinimumJerk& segment, double t);

// Position fraction of a rest-to-rest movement at phase s = t / T in [0, 1]: 10 s^3 - 15 s^4 + 6
// s^5.
double MinimumJerkPosition(double s);
// d/ds of it; at most 1.875.
double MinimumJerkSpeed(double s);

// From `state` to rest in time T, the place of rest chosen for least jerk: a segment matching
// position, velocity and acceleration.
MinimumJerk StopFrom(const MotionState& state, double T);

// A movement cut at its ends, completed to rest. `begin` and `end` are the times added (s), 0 where
// the speed was already below 5 % of the peak.
struct CompletedMotion {
  MotionSamples samples;  // t starts at 0; the original rows lie at t - t.front() + begin
  double begin = 0, end = 0;
};
// Adds minimum-jerk segments from rest and to rest, sampled at the median step of `samples`. Their
// durations are those of the missing parts of a minimum-jerk speed bell with the same peak, at
// least `min_time`. `columns`: the coordinates that count for speed, the first ones.
CompletedMotion CompleteToRest(const MotionSamples& samples, int columns = 3,
                               double min_time = 0.1);

}  // namespace springgrasp
