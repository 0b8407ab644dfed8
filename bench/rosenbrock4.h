// The springs integrated by Boost.Odeint's rosenbrock4, to be compared with.
#pragma once

#include <Eigen/Core>

#include "grasp/spring_system.h"
#include "motion/central_force.h"

namespace springgrasp {

// Positions (times x dim N) from p0, v0 at times[0], steps adapted to `tolerance` (absolute and
// relative), restarted at the kinks of the force; with the analytic Jacobian.
Eigen::MatrixXd IntegrateByRosenbrock4(const SpringSystem& system, const ForceProfile& force,
                                       const Eigen::MatrixXd& p0, const Eigen::MatrixXd& v0,
                                       const Eigen::VectorXd& times, double tolerance);

}  // namespace springgrasp
