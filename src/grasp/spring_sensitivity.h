// The spring trajectory together with its exact derivatives by parameters: those of the discrete
// Gauss-Legendre scheme, found by one linear solve per step.
#pragma once

#include <Eigen/Core>

#include "grasp/spring_integrator.h"
#include "grasp/spring_system.h"
#include "motion/central_force.h"

namespace springgrasp {

// What a trajectory may depend on, in the order of the columns: k of every spring (N/m), the gains
// that are asked for, then p(0) and v(0) finger-major.
enum class SpringGain { kGamma, kBeta, kDelay, kSwitch, kDamping, kContact, kContactDamping };
struct SpringParameters {
  std::vector<SpringGain> gains;  // gamma, beta, damping and contact as logarithms of factors
  bool start = true;

  Eigen::Index count(const SpringSystem& system) const {
    return static_cast<Eigen::Index>(system.springs.size() + gains.size()) +
           (start ? 2 * system.num_coordinates() : 0);
  }
};

// Like IntegrateSprings; `dp` (samples dim N x parameters, sample-major rows) receives the
// derivatives of the positions. Derivatives by t_switch need force.blend > 0.
std::optional<SpringTrajectory> IntegrateWithSensitivities(
    const SpringSystem& system, const CentralForce& force, const SpringParameters& parameters,
    const Eigen::MatrixXd& p0, const Eigen::MatrixXd& v0, const Eigen::VectorXd& times,
    const SpringIntegration& options, Eigen::MatrixXd& dp);

}  // namespace springgrasp
