// Spring constants while a grasp is being watched (Eq. (8)-(9), frame by frame): the triangular
// factor of all rows seen so far is updated by every frame and solved whenever asked. At the end
// the answer is that of EstimateSprings' regression over the same states.
#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>

#include "grasp/spring_estimation.h"
#include "grasp/spring_system.h"

namespace springgrasp {

// The rows X k = b, kept as the triangular factor of [X b]: (E + 1) x (E + 1), whatever their
// number.
class OnlineRegression {
 public:
  explicit OnlineRegression(Eigen::Index springs);
  void Add(const Eigen::Ref<const Eigen::MatrixXd>& X, const Eigen::Ref<const Eigen::VectorXd>& b);
  Eigen::Index rows() const { return rows_; }
  // As SolveRegression over all rows.
  SpringRegression Solve(double rcond = 1e-10) const;
  // As SolveNonNegative over all rows.
  Eigen::VectorXd SolveNonNegative() const;

 private:
  Eigen::Index springs_, rows_ = 0;
  Eigen::MatrixXd factor_;
};

// Frames in, constants out. Velocities and accelerations come from cubics through the last frames,
// so that a frame counts `lag` frames after it was seen.
class OnlineEstimation {
 public:
  // `system`: everything but k known. `half_window`: frames on either side of the cubics.
  OnlineEstimation(const SpringSystem& system, int half_window = 4);
  int lag() const { return half_window_; }
  // Tips (dim x N, m) at t (s, increasing) and the central force there (N). Every tip must be seen:
  // leave out the frame otherwise.
  void AddFrame(double t, const Eigen::Ref<const Eigen::MatrixXd>& p, double f);
  const OnlineRegression& regression() const { return regression_; }

 private:
  struct Frame {
    double t, f;
    Eigen::VectorXd p;
  };
  SpringSystem system_;
  int half_window_;
  std::deque<Frame> frames_;
  OnlineRegression regression_;
  SpringTerms terms_;
  Eigen::MatrixXd X_;
  Eigen::VectorXd b_;
};

// The states that OnlineEstimation finds at the middle frame of a window of positions (samples x
// n): position, velocity and acceleration (3 x n) of the cubic that fits them best.
Eigen::MatrixXd StateOfWindow(const Eigen::Ref<const Eigen::VectorXd>& t,
                              const Eigen::Ref<const Eigen::MatrixXd>& p);

}  // namespace springgrasp
