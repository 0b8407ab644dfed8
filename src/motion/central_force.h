// The central force that opens and closes the hand, from the acceleration of the reach (Eq. (7)):
//
//   f(t) = -gamma |a(t)| for t < t_switch, +gamma |a(t)| from there on.
//
// t_switch is the first sample of largest speed. The paper asks for the smallest |a|, which also
// occurs at both ends and is ill defined under noise; at the largest speed of a straight reach
// |a| = 0. Delay, closing gain, blending, lag of single fingers and holding force are extensions
// for human timing, off by default.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "motion/motion_samples.h"

namespace springgrasp {

// A force over time as the spring integrator takes it: f is smooth between the kinks, at which the
// integrator restarts its steps. Forces at a kink belong to the piece after it.
struct ForceProfile {
  std::function<double(double t)> f;  // N
  std::vector<double> kinks;          // s, increasing
  // Where fingers have times of their own: fills the force on each at t. Empty: f for all.
  std::function<void(double t, Eigen::VectorXd& f)> each = {};

  void At(double t, Eigen::VectorXd& forces) const {
    if (each) {
      each(t, forces);
    } else {
      forces.setConstant(f(t));
    }
  }
};

struct CentralForce {
  Eigen::VectorXd t;      // s, increasing
  Eigen::VectorXd a;      // |a| at t, m/s^2; linear in between, zero outside
  double T = 1;           // s, end of the reach
  double t_switch = 0.5;  // s, before the delay
  double gamma = 1;       // kg
  double blend = 0;       // s, width over which the sign changes smoothly around t_switch
  double delay = 0;       // s, of the whole force
  double beta = 1;        // closing gain: multiplies f > 0
  double hold = 0;        // N; after T the force never falls below it
  Eigen::VectorXd lag;    // s, N: how much later a finger's force changes sign; empty: none
  bool ramp = false;      // nor, from the (delayed) switch on, below a ramp that rises to it at T
};

// First sample of largest speed. `v` has a row per sample.
double SwitchTime(const Eigen::VectorXd& t, const Eigen::MatrixXd& v);

// Eq. (7) from a movement's velocities and accelerations, gains at their defaults; T is the last
// time or `T` if given.
CentralForce MakeCentralForce(const MotionSamples& motion, double gamma = 1,
                              std::optional<double> T = {});

// The force at time t, N.
double EvaluateCentralForce(const CentralForce& force, double t);
// The force on each of f.size() fingers, N.
void EvaluateCentralForces(const CentralForce& force, double t, Eigen::VectorXd& f);

// Times at which the force jumps or bends by construction: start of the (delayed) force, switch,
// end of the reach, end of the table.
std::vector<double> CentralForceKinks(const CentralForce& force);

// As the integrator takes it; holds a copy of `force`.
ForceProfile MakeForceProfile(const CentralForce& force);
// A table, linear between its points (even ones are found fastest), end values held.
ForceProfile MakeForceProfile(const Eigen::VectorXd& t, const Eigen::VectorXd& f);
// Even steps from t = 0.
ForceProfile MakeForceProfile(const std::vector<double>& f, double dt);
ForceProfile ConstantForce(double f);

}  // namespace springgrasp
