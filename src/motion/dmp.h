// Dynamic movement primitive of the reach, the goal-difference form of the paper:
//
//   tau dv/dt = K (g - x) - D v - K (g - x0) s + K f(s)                           Eq. (10)
//   tau dx/dt = v                                                                 Eq. (11)
//   f(s) = s sum_i w_i psi_i(s) / sum_i psi_i(s),  psi_i = exp(-h_i (s - c_i)^2)  Eq. (12)
//   tau ds/dt = -alpha s,  so s = exp(-alpha t / tau)                             Eq. (13)
//
// The v of Eq. (10) is the scaled velocity; everything below takes and gives physical velocities
// v / tau and accelerations. The forcing term is found from Eq. (10) (the paper says Eq. (11)). The
// primitive does not depend on where or how fast it is used: translation and time scaling are
// exact, goal and start changes have the closed form DmpGoalResponse. It is not scale invariant:
// the forcing keeps its size when g - x0 grows.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "base/pose.h"
#include "motion/dmp_obstacle.h"
#include "motion/motion_samples.h"

namespace springgrasp {

struct Dmp {
  double K = 150;                    // 1; K / tau^2 acts as a spring constant per mass
  double D = 24.49489742783178;      // critically damped: 2 sqrt(K)
  double alpha = 4.605170185988091;  // -ln(0.01): s(tau) = 0.01
  double tau = 1;                    // s, duration of the movement
  Eigen::VectorXd centers, widths;   // of the basis functions, in s
  Eigen::MatrixXd weights;           // bases x dimension
  Eigen::VectorXd x0, g;             // start and goal, size dimension

  Eigen::Index dimension() const { return x0.size(); }
};

struct DmpOptions {
  int num_basis = 20;
  double K = 150;
  double tau = 0;  // s; 0: the duration of the samples
};

// A primitive at rest in x0 (weights zero) with evenly timed basis functions: c_i = exp(-alpha i /
// (n - 1)), h_i = 1 / (1.5 (c_{i+1} - c_i))^2, the last one repeated.
Dmp MakeDmp(const Eigen::VectorXd& x0, const Eigen::VectorXd& g, const DmpOptions& options = {});

// Least squares for the weights; x0 is the first and g the last row of samples.x. Uneven samples
// and gaps are weighted by the time they stand for. Throws Error for fewer than 4 samples, a
// non-finite value, or times that do not increase.
Dmp LearnDmp(const MotionSamples& samples, const DmpOptions& options = {});
// The same for a primitive whose basis (K, D, alpha, tau, centers, widths) is given, every sample
// with the same weight: the plain regression of the paper.
void LearnDmpWeights(const MotionSamples& samples, Dmp& dmp);

// Eq. (12) at phase s, evaluated with the largest exponent subtracted: finite far from all centres.
Eigen::VectorXd DmpForcing(const Dmp& dmp, double s);

// Largest step of the integration inside the functions below, as a fraction of tau.
inline constexpr double kDmpStep = 5e-4;

// Integrates from t = 0 to the given increasing times (the first may be 0; 1.5 tau is allowed and
// recommended for moved goals). `v0` is the physical initial velocity, zero if empty. The phase is
// exact, the motion by classical Runge-Kutta with steps of at most kDmpStep tau.
MotionSamples RolloutDmp(const Dmp& dmp, const Eigen::VectorXd& times,
                         const Eigen::VectorXd& v0 = {});
// The same at even steps: 0, dt, 2 dt, ..., up to `duration` (included if it is a multiple).
MotionSamples RolloutDmp(const Dmp& dmp, double duration, double dt,
                         const Eigen::VectorXd& v0 = {});

// Response of x to a unit change of the goal at time t, B(t) of x(t; g') = x(t; g) + B (g' - g) and
// x(t; x0') = x(t; x0) + (1 - B) (x0' - x0), for a critically damped primitive.
double DmpGoalResponse(const Dmp& dmp, double t);

// A primitive that is executed step by step, with feedback. All in physical units.
struct DmpState {
  Eigen::VectorXd x, v;
  double s = 1;  // phase
};
struct DmpCoupling {
  // Extra acceleration at state x, v; none if empty.
  std::function<Eigen::VectorXd(const Eigen::VectorXd& x, const Eigen::VectorXd& v)> acceleration;
  // Kept clear of, one after the other: where two clearances overlap the last one rules.
  std::vector<SphereObstacle> obstacles;
  // Phase stopping: tau ds/dt = -alpha s / (1 + phase_stopping |measured - x|^2), 1/m^2; and the
  // plan waits with the phase.
  double phase_stopping = 0;
  std::optional<Eigen::VectorXd> measured;  // position that the robot reached
};
DmpState StartDmp(const Dmp& dmp, const Eigen::VectorXd& v0 = {});
// Advances by dt. Without coupling the result equals RolloutDmp.
void StepDmp(const Dmp& dmp, double dt, DmpState& state, const DmpCoupling& coupling = {});
// Acceleration at a state.
Eigen::VectorXd DmpAcceleration(const Dmp& dmp, const DmpState& state,
                                const DmpCoupling& coupling = {});

// Position and orientation on one phase. Orientation in logarithm form: R_WB = R_ref Exp(w), with w
// (rad) as coordinates 3-5 of one six-dimensional primitive (Ude et al., ICRA 2014, use the same
// logarithm at the goal). R_ref is the goal orientation of the demonstration, so w ends at or near
// zero; it is exact for turns below 180 degrees from there. Moving the goal moves R_ref with it, so
// rotating start and goal rotates the whole movement.
struct PoseDmp {
  Dmp motion;  // x, y, z (m) and w (rad)
  Eigen::Quaterniond R_ref = Eigen::Quaterniond::Identity();
};

struct PoseMotion {
  Eigen::VectorXd t;  // s
  std::vector<Pose> X_WB;
  Eigen::MatrixXd velocity;      // samples x 6: of the origin (m/s), angular in W (rad/s)
  Eigen::MatrixXd acceleration;  // samples x 3: of the origin, m/s^2
};

// Coordinates (samples x 6) of poses about R_ref, w unwrapped so that it is continuous in time.
Eigen::MatrixXd PoseCoordinates(const std::vector<Pose>& X_WB, const Eigen::Quaterniond& R_ref);
Pose PoseFromCoordinates(const Eigen::Matrix<double, 6, 1>& x, const Eigen::Quaterniond& R_ref);

// Learns from poses whose coordinates about R_ref were smoothed and differentiated by the caller.
PoseDmp LearnPoseDmp(const MotionSamples& coordinates, const Eigen::Quaterniond& R_ref,
                     const DmpOptions& options = {});
// Learns from poses at `t` that are already smooth: derivatives by DifferentiateSamples.
PoseDmp LearnPoseDmp(const Eigen::VectorXd& t, const std::vector<Pose>& X_WB,
                     const DmpOptions& options = {});

Pose StartPose(const PoseDmp& dmp);
Pose GoalPose(const PoseDmp& dmp);
// The primitive for another start and goal; tau unchanged.
PoseDmp WithEndpoints(const PoseDmp& dmp, const Pose& X_WStart, const Pose& X_WGoal);

// Rolls out at the given times. `velocity0` is the initial velocity of the origin and angular
// velocity in W (6 entries), zero if empty.
PoseMotion RolloutPoseDmp(const PoseDmp& dmp, const Eigen::VectorXd& times,
                          const Eigen::VectorXd& velocity0 = {});

// Even times 0, dt, 2 dt, ... up to `duration`.
Eigen::VectorXd EvenTimes(double duration, double dt);

}  // namespace springgrasp
