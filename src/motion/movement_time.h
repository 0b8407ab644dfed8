// When a movement begins and ends.
#pragma once

#include <Eigen/Core>

namespace springgrasp {

struct MovementTime {
  double begin = 0, end = 0;          // s
  Eigen::Index first = 0, last = 0;   // samples at or just inside these times
  double peak_speed = 0, t_peak = 0;  // m/s, s
  bool cut_at_begin = false;          // faster than the threshold at the first / last sample
  bool cut_at_end = false;

  double duration() const { return end - begin; }
};

// First to last time at 5 % of peak speed (fraction), crossings interpolated linearly. `v` has a
// row per sample.
MovementTime FindMovementTime(const Eigen::VectorXd& t, const Eigen::MatrixXd& v,
                              double fraction = 0.05);

}  // namespace springgrasp
