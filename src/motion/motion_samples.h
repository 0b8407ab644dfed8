// A sampled movement: what recordings become, what primitives are learned from, and what they roll
// out to.
#pragma once

#include <Eigen/Core>

namespace springgrasp {

// One row per instant, one column per coordinate. Derivatives are physical (per second), not scaled
// by a primitive's tau. Times increase strictly but need not be even.
struct MotionSamples {
  Eigen::VectorXd t;        // s
  Eigen::MatrixXd x, v, a;  // samples x n: m, m/s, m/s^2 (or rad, ...)

  Eigen::Index size() const { return t.size(); }
  Eigen::Index dimension() const { return x.cols(); }
};

}  // namespace springgrasp
