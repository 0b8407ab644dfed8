// Levenberg-Marquardt for least squares under bounds: the solver the paper names for Eq. (15)-(16),
// shared by hand inverse kinematics, contact postures and spring estimation. (The mapping itself
// has one of fixed size, in hand_mapping.cc.)
#pragma once

#include <Eigen/Core>
#include <functional>

namespace springgrasp {

// minimise 1/2 |r(x)|^2 subject to lower <= x <= upper.
struct LeastSquaresProblem {
  // Fills r (num_residuals) and, when J is not null, J (num_residuals x n) = dr/dx. The solver
  // never calls outside the bounds.
  std::function<void(const Eigen::VectorXd& x, Eigen::VectorXd& r, Eigen::MatrixXd* J)> evaluate;
  int num_residuals = 0;
  Eigen::VectorXd lower, upper;  // size n
};

struct LevenbergMarquardtOptions {
  int max_iterations = 100;
  double gradient_tolerance = 1e-10;  // on the largest entry of the projected gradient
  double step_tolerance = 1e-12;      // on the largest entry of the step
  double initial_damping = 1e-3;      // relative to the diagonal of J'J
};

struct LevenbergMarquardtResult {
  Eigen::VectorXd x;
  double cost = 0;  // 1/2 |r|^2
  int iterations = 0;
  bool converged = false;
};

// Projected Levenberg-Marquardt: variables at a bound whose gradient points outward are held for
// the step. `x` is clamped into the bounds first. Deterministic: stops by counts and tolerances.
LevenbergMarquardtResult MinimizeLeastSquares(const LeastSquaresProblem& problem,
                                              const Eigen::VectorXd& x,
                                              const LevenbergMarquardtOptions& options = {});

// Fills J by central differences of `evaluate` (one-sided at a bound), for problems without an
// analytic Jacobian and for tests.
void NumericalJacobian(const LeastSquaresProblem& problem, const Eigen::VectorXd& x, double step,
                       Eigen::MatrixXd& J);

}  // namespace springgrasp
