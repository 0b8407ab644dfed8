// Spring constants from observed fingertips, Eq. (8) and Eq. (9): the paper's regression by
// singular values, then with k >= 0, then by Levenberg-Marquardt on the simulated trajectory.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "grasp/spring_integrator.h"
#include "grasp/spring_system.h"
#include "motion/central_force.h"

namespace springgrasp {

// One observed grasp. Several are pooled: they share the springs' constants and the fitted gains,
// and differ in contacts, start and force.
struct SpringObservation {
  SpringSystem system;  // k is ignored, everything else known
  CentralForce force;   // gamma, beta, delay, t_switch: known, or where the fit starts
  Eigen::VectorXd t;    // s
  // samples x dim N, finger-major. p as measured (for the trajectory fit), NaN where not seen.
  Eigen::MatrixXd p;
  // Smoothed states for the regression, same size; rows with a NaN in a finger are left out for
  // that finger and the fingers its springs lead to. If p_smooth is empty p is used.
  Eigen::MatrixXd p_smooth, v, a;
  Eigen::VectorXd weight;  // N: of a finger's errors in the trajectory fit; empty: 1
};

// What the trajectory fit may change besides k and the start.
struct FittedGains {
  bool gamma = false, beta = false, delay = false, t_switch = false;
  bool damping = false;  // one factor on every d_e
  bool contact = false;  // one factor on kc and one on dc
  bool any() const { return gamma || beta || delay || t_switch || damping || contact; }
};

struct EstimationOptions {
  bool non_negative = true;    // NNLS after the SVD
  bool trajectory_fit = true;  // Levenberg-Marquardt after that
  FittedGains fit = {};
  bool fit_start = true;  // p(0), v(0) of every observation
  double rcond = 1e-10;   // relative threshold of singular values
  double trim = 0;        // s dropped at both ends for the regression
  double noise = 0;       // m, deviation of a coordinate of p; 0: from the residuals
  double step = 0.005;    // s, largest integration step of the fit
  int max_iterations = 40;
  bool reproduce = true;  // simulate what was found: finger_rmse, reproduced
  // A weak pull of log gains to their start (deviation of the factor's logarithm), 0: none.
  double gain_prior = 0;
};

// The paper's regression.
struct SpringRegression {
  Eigen::VectorXd k;                // per spring, N/m
  Eigen::VectorXd standard_error;   // from the residuals, N/m
  Eigen::VectorXd singular_values;  // of X as it stands
  double condition_number = 0;      // of X with columns scaled to norm 1
  int rank = 0;
  double residual = 0;  // RMS of Eq. (8), N
};

// Rows of Eq. (8), Eq. (9) of one frame: X (dim N x springs) and the right-hand side
//   b = -m a - sum d_e xd_e + involved (-kc xc - dc v - f_i u_i) - d0 v,   X k = b.
void RegressionRows(const SpringSystem& system, const Eigen::Ref<const Eigen::MatrixXd>& p,
                    const Eigen::Ref<const Eigen::MatrixXd>& v,
                    const Eigen::Ref<const Eigen::MatrixXd>& a, double f, SpringTerms& terms,
                    Eigen::Ref<Eigen::MatrixXd> X, Eigen::Ref<Eigen::VectorXd> b);
// The same with a force for each finger.
void RegressionRows(const SpringSystem& system, const Eigen::Ref<const Eigen::MatrixXd>& p,
                    const Eigen::Ref<const Eigen::MatrixXd>& v,
                    const Eigen::Ref<const Eigen::MatrixXd>& a, const Eigen::VectorXd& f,
                    SpringTerms& terms, Eigen::Ref<Eigen::MatrixXd> X,
                    Eigen::Ref<Eigen::VectorXd> b);

// Solves X k = b by SVD with scaled columns; an empty column (a spring at rest length throughout)
// gives k = 0 and infinite standard error.
SpringRegression SolveRegression(const Eigen::MatrixXd& X, const Eigen::VectorXd& b, double rcond);

// min |X k - b| subject to k >= 0 (Lawson and Hanson).
Eigen::VectorXd SolveNonNegative(const Eigen::MatrixXd& X, const Eigen::VectorXd& b);

struct SpringEstimate {
  Eigen::VectorXd k;               // the last method's, N/m
  Eigen::VectorXd standard_error;  // N/m; infinity where the data say nothing
  SpringRegression linear;         // the paper's SVD
  Eigen::VectorXd k_non_negative;  // NNLS
  double condition_number = 0;     // of the last method's scaled Jacobian
  FittedGains fitted;              // which gains below are fitted
  bool converged = true;
  int iterations = 0;
  // Fitted gains, or those given. Factors for damping (on d_e), kc and dc.
  double gamma = 1, beta = 1, delay = 0, t_switch = 0;
  double damping_factor = 1, kc_factor = 1, dc_factor = 1;
  double noise = 0;                          // m, deviation of a coordinate used for the errors
  std::vector<Eigen::VectorXd> finger_rmse;  // per observation, per finger, m; NaN if not seen
  std::vector<SpringTrajectory> reproduced;  // per observation, at its times
  // One plain sentence for each constant that the data cannot determine.
  std::vector<std::string> remarks;
};

// A plain sentence on the spring `name` (as thumb-index) if its standard error is as large as k, or
// infinite: it shows in no sample. Empty if the data determine k.
std::string RemarkOnSpring(std::string_view name, double k, double standard_error);

// The full recipe. Throws Error if observations disagree in springs or sizes, or if there are fewer
// rows than constants.
SpringEstimate EstimateSprings(const std::vector<SpringObservation>& observations,
                               const EstimationOptions& options = {});

// The observation's system and force with an estimate put in.
SpringSystem WithEstimate(const SpringSystem& system, const SpringEstimate& estimate);
CentralForce WithEstimate(const CentralForce& force, const SpringEstimate& estimate);

}  // namespace springgrasp
