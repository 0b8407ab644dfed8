// Spring constants and gains of a grasp from the observed fingertips.
#pragma once

#include <optional>
#include <vector>

#include "base/fingers.h"
#include "grasp/generate_fingers.h"

namespace springgrasp {

// What is not fitted. Chosen on synthesised demonstrations of the four types (seeds 1 and 2): a
// slow auxiliary spring leaves opening and closing to the central force, which is what people's
// hands look like; dampers between fingers drag the fingers that take no part.
struct GainRule {
  double omega_T = 5;  // T sqrt(kc / m): the auxiliary springs alone close slowly
  double zeta = 12;    // over-damped, as the paper assumes; below some 10 tips swing about contacts
  double damping = 0.02;  // d_e / dc
  double ambient = 0.2;   // d0 / dc: fingers without a contact stay where they are in the hand
};
GainRule RuleOf(bool human);

struct FitProblem {
  FingerRun run;  // start, contacts, edges, T, t_switch; gains are found
  ReachScales scales;
  std::vector<double> acceleration;  // |a| of H's origin from t = 0 on, even steps of `dt`
  std::vector<Fingertips> p_HF;      // smoothed tips from 0 to T, even steps of `dt`
  double dt = 0.01;                  // s
  std::vector<double> sample_t;      // s, measured instants between 0 and T
  std::vector<PerFinger<std::optional<Eigen::Vector3d>>> sample_p_HF;
  double lead = 0;  // s, completed before the recording: the fingers rest
  PerFinger<bool> observed = {};
  double noise = 0;    // deviation of a measured coordinate, m
  bool human = true;   // fit delay and closing gain
  bool forced = true;  // fit the gain of Eq. (7), else f_cen = 0
  bool fit_switch = false;
  GainRule rule;
};

struct FitResult {
  DimensionlessGains gains;
  double t_switch = 0.5;                // s
  std::vector<double> standard_errors;  // of k, per edge, N/m; 0 where not estimated
  double condition_number = 0;          // of the scaled regression (Eq. (8))
  // Of what these values generate against the smoothed track, while it was measured.
  PerFinger<double> rmse = {};  // m
  PerFinger<int> samples = {};
  double aperture = 0, aperture_time = 0;  // reproduced, m and of T
  double aperture_rmse = 0;                // m
};

// k by Eq. (8) (SVD, NNLS), then together with gamma, delay, closing gain and switch time by
// Levenberg-Marquardt on the simulated trajectory, from several starting gains; the values that
// reproduce the fingers best are kept. Contact stiffness and all damping follow the rule.
FitResult FitSprings(const FitProblem& problem);

}  // namespace springgrasp
