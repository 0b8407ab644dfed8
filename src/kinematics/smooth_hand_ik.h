// Joint angles of the human hand through a whole motion at once: where fingertips lie at the end of
// a finger's reach or beyond, or leave it freedom, the joints still move smoothly.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "kinematics/hand_ik.h"

namespace springgrasp {

// Per finger, over all instants (dt apart) and within the joint ranges, the least of
//   tip    |p - p_known|^2 / tip_deviation^2, beyond `outlier` growing only with the distance
//   rest, link  as SolveHandIk
//   speed  |q_k - q_(k-1)|^2 / (speed_deviation dt)^2
//   bend   |q_(k+1) - 2 q_k + q_(k-1)|^2 / (acceleration_deviation dt^2)^2
struct SmoothHandOptions {
  HandIkOptions ik = {};
  double dt = 0.005;                    // s
  double outlier = 0.003;               // m
  double speed_deviation = 4;           // rad/s
  double acceleration_deviation = 150;  // rad/s^2
  int max_iterations = 15;
};

// Gauss-Newton from SolveHandMotion's solution; deterministic.
std::vector<Eigen::VectorXd> SolveHandMotionSmoothly(const HumanHand& hand,
                                                     const std::vector<KnownTips>& p_HF,
                                                     const SmoothHandOptions& options = {});

}  // namespace springgrasp
