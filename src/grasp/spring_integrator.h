// Integrates the spring system by the implicit fourth-order Runge-Kutta method that the paper asks
// for: two-stage Gauss-Legendre with Newton's method on the stage accelerations.
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <functional>
#include <optional>

#include "grasp/spring_system.h"
#include "motion/central_force.h"

namespace springgrasp {

// One row per time, coordinates finger-major (x0 y0 [z0] x1 ...).
struct SpringTrajectory {
  Eigen::VectorXd t;     // s
  Eigen::MatrixXd p, v;  // samples x dim N: m, m/s

  // Position of a finger at a sample, dim entries.
  Eigen::VectorXd Point(Eigen::Index sample, int finger, int dim) const {
    return p.row(sample).segment(finger * dim, dim).transpose();
  }
};

struct SpringIntegration {
  double step = 0.005;       // s, largest step
  double tolerance = 1e-12;  // Newton stops when h max|error of stage accelerations|, judged by its
                             // last two changes, < tolerance (1 + max |state|)
  int max_iterations = 12;   // then the step is halved
  int max_halvings = 12;
};

// From p0, v0 (dim x N) at times[0] to the given increasing times, the first row the start itself.
// Steps restart at the kinks of the force. Nothing if Newton fails in ever smaller steps or the
// state is not finite: the parameters let it run away.
std::optional<SpringTrajectory> IntegrateSprings(
    const SpringSystem& system, const ForceProfile& force, const Eigen::MatrixXd& p0,
    const Eigen::MatrixXd& v0, const Eigen::VectorXd& times, const SpringIntegration& options = {});

// The stepper underneath, for callers that go on without knowing the end. Allocates only in the
// constructor. Keeps a reference to `system`.
class SpringStepper {
 public:
  explicit SpringStepper(const SpringSystem& system, const SpringIntegration& options = {});

  // One step of size h from (t, p, v), in place, halved where Newton fails. `force` must be smooth
  // in (t, t + h). False if it failed; the state is then undefined.
  bool Step(const ForceProfile& force, double t, double h, Eigen::MatrixXd& p, Eigen::MatrixXd& v);

  // Of the last accepted step: stage times, positions, velocities, forces, for sensitivities.
  struct Stages {
    double t = 0, h = 0;
    Eigen::VectorXd f[2];        // N
    Eigen::MatrixXd p[2], v[2];  // dim x N
    Eigen::VectorXd a[2];        // dim N
  };
  const Stages& stages() const { return stages_; }

  // Called after every accepted (sub)step if set: OnStep(stages).
  std::function<void(const Stages&)> on_step;

 private:
  bool TryStep(const ForceProfile& force, double t, double h, const Eigen::MatrixXd& p,
               const Eigen::MatrixXd& v);
  bool Solve(double h, const Eigen::MatrixXd& p, const Eigen::MatrixXd& v);
  void Factor(const Eigen::VectorXd& f, double h, const Eigen::MatrixXd& p,
              const Eigen::MatrixXd& v);
  void Predict(double t, double h);
  bool StepHalving(const ForceProfile& force, double t, double h, int depth, Eigen::MatrixXd& p,
                   Eigen::MatrixXd& v);

  const SpringSystem& system_;
  SpringIntegration options_;
  SpringTerms terms_;
  Stages stages_;
  Eigen::MatrixXd Jp_, Jv_, newton_;
  Eigen::VectorXd residual_, change_, force_;
  // Accelerations at the stages of the last accepted steps without a gap between them.
  double past_t_[4] = {0, 0, 0, 0};
  Eigen::MatrixXd past_;  // dim N x 4
  int known_ = 0;         // of its columns, the last ones
  double end_ = 0;        // s, of the last accepted step
  Eigen::PartialPivLU<Eigen::MatrixXd> lu_;
  double factored_h_ = 0;  // s, the step that lu_ was made for; 0: make a new one
};

// Advances from t0 to t1 in equal steps of at most `step`, restarted at the kinks of the force.
bool AdvanceSprings(SpringStepper& stepper, const ForceProfile& force, double t0, double t1,
                    double step, Eigen::MatrixXd& p, Eigen::MatrixXd& v);

// Gauss-Legendre nodes and coefficients, two stages.
inline constexpr double kGaussC[2] = {0.21132486540518711775, 0.78867513459481288225};
inline constexpr double kGaussA[2][2] = {{0.25, -0.03867513459481288225},
                                         {0.53867513459481288225, 0.25}};

}  // namespace springgrasp
