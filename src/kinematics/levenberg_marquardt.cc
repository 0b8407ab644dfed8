#include "kinematics/levenberg_marquardt.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace springgrasp {

LevenbergMarquardtResult MinimizeLeastSquares(const LeastSquaresProblem& problem,
                                              const Eigen::VectorXd& start,
                                              const LevenbergMarquardtOptions& options) {
  const Eigen::Index n = start.size();
  LevenbergMarquardtResult result;
  result.x = start.cwiseMax(problem.lower).cwiseMin(problem.upper);
  Eigen::VectorXd r(problem.num_residuals), r_trial(problem.num_residuals);
  Eigen::MatrixXd J(problem.num_residuals, n), A(n, n);
  Eigen::VectorXd gradient(n), step(n), x_trial(n), diagonal(n);
  Eigen::LLT<Eigen::MatrixXd> factor(n);
  problem.evaluate(result.x, r, &J);
  result.cost = 0.5 * r.squaredNorm();
  double damping = options.initial_damping;
  double growth = 2;
  while (result.iterations < options.max_iterations) {
    ++result.iterations;
    gradient.noalias() = J.transpose() * r;
    A.setZero();
    A.selfadjointView<Eigen::Lower>().rankUpdate(J.transpose());
    A.triangularView<Eigen::StrictlyUpper>() = A.transpose();
    // Hold variables that press against their bound.
    double largest_gradient = 0;
    for (Eigen::Index i = 0; i < n; ++i) {
      const bool held = (result.x[i] <= problem.lower[i] && gradient[i] > 0) ||
                        (result.x[i] >= problem.upper[i] && gradient[i] < 0);
      if (held) {
        gradient[i] = 0;
        A.row(i).setZero();
        A.col(i).setZero();
        A(i, i) = 1;
      }
      largest_gradient = std::max(largest_gradient, std::abs(gradient[i]));
    }
    if (largest_gradient < options.gradient_tolerance) {
      result.converged = true;
      break;
    }
    diagonal = A.diagonal().cwiseMax(1e-12);
    bool improved = false;
    for (int attempt = 0; attempt < 30 && !improved; ++attempt) {
      Eigen::MatrixXd& damped = A;
      damped.diagonal() = diagonal * (1 + damping);
      factor.compute(damped);
      step = factor.solve(-gradient);
      x_trial = (result.x + step).cwiseMax(problem.lower).cwiseMin(problem.upper);
      step = x_trial - result.x;
      if (!(step.cwiseAbs().maxCoeff() > options.step_tolerance)) {
        result.converged = true;
        break;
      }
      problem.evaluate(x_trial, r_trial, nullptr);
      const double cost = 0.5 * r_trial.squaredNorm();
      if (cost < result.cost) {
        improved = true;
        result.x = x_trial;
        result.cost = cost;
        damping = std::max(damping / 3, 1e-12);
        growth = 2;
      } else {
        damping = std::max(damping, 1e-12) * growth;
        growth *= 2;
      }
    }
    if (!improved) {
      result.converged = true;
      break;
    }
    problem.evaluate(result.x, r, &J);
  }
  return result;
}

void NumericalJacobian(const LeastSquaresProblem& problem, const Eigen::VectorXd& x, double step,
                       Eigen::MatrixXd& J) {
  Eigen::VectorXd high = x, low = x, r_high(problem.num_residuals), r_low(problem.num_residuals);
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    high[i] = std::min(x[i] + step, problem.upper[i]);
    low[i] = std::max(x[i] - step, problem.lower[i]);
    if (high[i] > low[i]) {
      problem.evaluate(high, r_high, nullptr);
      problem.evaluate(low, r_low, nullptr);
      J.col(i) = (r_high - r_low) / (high[i] - low[i]);
    } else {
      J.col(i).setZero();
    }
    high[i] = low[i] = x[i];
  }
}

}  // namespace springgrasp
