#include "motion/movement_time.h"

#include "base/error.h"

namespace springgrasp {

MovementTime FindMovementTime(const Eigen::VectorXd& t, const Eigen::MatrixXd& v, double fraction) {
  ThrowUnless(t.size() > 0 && v.rows() == t.size(), "movement time: {} times, {} velocities",
              t.size(), v.rows());
  const Eigen::VectorXd speed = v.rowwise().norm();
  Eigen::Index peak = 0;
  MovementTime out;
  out.peak_speed = speed.maxCoeff(&peak);
  out.t_peak = t[peak];
  const double threshold = fraction * out.peak_speed;
  const auto crossing = [&](Eigen::Index slow, Eigen::Index fast) {
    const double part = (threshold - speed[slow]) / (speed[fast] - speed[slow]);
    return t[slow] + part * (t[fast] - t[slow]);
  };
  out.last = t.size() - 1;
  while (out.first < peak && speed[out.first] < threshold) ++out.first;
  while (out.last > peak && speed[out.last] < threshold) --out.last;
  out.cut_at_begin = out.first == 0 && speed[0] > threshold;
  out.cut_at_end = out.last == t.size() - 1 && speed[out.last] > threshold;
  out.begin = out.first == 0 ? t[0] : crossing(out.first - 1, out.first);
  out.end = out.last == t.size() - 1 ? t[out.last] : crossing(out.last + 1, out.last);
  return out;
}

}  // namespace springgrasp
