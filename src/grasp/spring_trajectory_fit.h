// Levenberg-Marquardt fit of the simulated fingertip trajectories (the last stage of
// spring_estimation.h): unknowns, bounds, residuals and their exact derivatives.
#pragma once

#include <optional>
#include <vector>

#include "grasp/spring_estimation.h"
#include "grasp/spring_sensitivity.h"

namespace springgrasp {

// The unknowns are k of every spring, the fitted gains, then p(0), v(0) of every observation. k
// itself, not its square root: the solver keeps bounds, and from a constant that the non-negative
// regression put to zero the square root could never leave (its derivative vanishes there).
class TrajectoryFit {
 public:
  // Keeps references to all three.
  TrajectoryFit(const std::vector<SpringObservation>& observations,
                const EstimationOptions& options, const SpringEstimate& initial);

  Eigen::Index num_springs() const { return E_; }
  Eigen::Index num_unknowns() const;
  Eigen::Index num_residuals() const { return residuals_ + priors_; }
  Eigen::Index num_measured() const { return residuals_; }  // the first residuals

  // Unknowns of the initial estimate, and their bounds.
  Eigen::VectorXd Start() const;
  void Bounds(Eigen::VectorXd& lower, Eigen::VectorXd& upper) const;
  // The estimate that a vector of unknowns stands for.
  SpringEstimate At(const Eigen::VectorXd& x) const;
  // Trajectory of an observation; nothing if it runs away. `dp` (may be null) as in
  // IntegrateWithSensitivities.
  std::optional<SpringTrajectory> Simulate(const Eigen::VectorXd& x, std::size_t observation,
                                           Eigen::MatrixXd* dp) const;
  // Residuals in m, and their derivatives unless J is null.
  void Evaluate(const Eigen::VectorXd& x, Eigen::VectorXd& r, Eigen::MatrixXd* J) const;

 private:
  Eigen::Index StartIndex(std::size_t observation) const {
    return E_ + G_ + 2 * n_ * static_cast<Eigen::Index>(observation);
  }
  void StartStates(const Eigen::VectorXd& x, std::size_t observation, Eigen::MatrixXd& p0,
                   Eigen::MatrixXd& v0) const;

  const std::vector<SpringObservation>& observations_;
  const EstimationOptions& options_;
  const SpringEstimate& initial_;
  SpringParameters parameters_;
  Eigen::Index E_ = 0, G_ = 0, n_ = 0, residuals_ = 0, priors_ = 0;
};

}  // namespace springgrasp
