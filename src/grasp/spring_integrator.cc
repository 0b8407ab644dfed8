#include "grasp/spring_integrator.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace springgrasp {
namespace {

using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Positions are integrated twice from the stage accelerations: A A and b'A of the tableau.
constexpr double kAA[2][2] = {{kGaussA[0][0] * kGaussA[0][0] + kGaussA[0][1] * kGaussA[1][0],
                               kGaussA[0][0] * kGaussA[0][1] + kGaussA[0][1] * kGaussA[1][1]},
                              {kGaussA[1][0] * kGaussA[0][0] + kGaussA[1][1] * kGaussA[1][0],
                               kGaussA[1][0] * kGaussA[0][1] + kGaussA[1][1] * kGaussA[1][1]}};
constexpr double kBA[2] = {0.5 * (kGaussA[0][0] + kGaussA[1][0]),
                           0.5 * (kGaussA[0][1] + kGaussA[1][1])};

// A matrix made for a step that differs by less than this part is good enough for Newton.
constexpr double kSameStep = 0.02;
// A matrix by which the error falls to no less than this part is renewed for the next step.
constexpr double kSlow = 0.2;

Map<const VectorXd> Flat(const MatrixXd& points) { return {points.data(), points.size()}; }
Map<VectorXd> Flat(MatrixXd& points) { return {points.data(), points.size()}; }

}  // namespace

SpringStepper::SpringStepper(const SpringSystem& system, const SpringIntegration& options)
    : system_(system), options_(options) {
  CheckSpringSystem(system);
  const Index n = system.num_coordinates();
  for (int i = 0; i < 2; ++i) {
    stages_.p[i].setZero(system.dim, system.num_fingers());
    stages_.v[i].setZero(system.dim, system.num_fingers());
    stages_.a[i].setZero(n);
    stages_.f[i].setZero(system.num_fingers());
  }
  Jp_.setZero(n, n);
  Jv_.setZero(n, n);
  newton_.setIdentity(2 * n, 2 * n);
  residual_.setZero(2 * n);
  past_.setZero(n, 4);
  force_.setZero(system.num_fingers());
  change_.setZero(2 * n);
  lu_ = Eigen::PartialPivLU<MatrixXd>(newton_);
  EvaluateSprings(system_, stages_.p[0], stages_.v[0], 0, terms_);
}

// The matrix of Newton's method, with the Jacobian at the step's start.
void SpringStepper::Factor(const VectorXd& f, double h, const MatrixXd& p, const MatrixXd& v) {
  const Index n = system_.num_coordinates();
  EvaluateSprings(system_, p, v, f, terms_);
  SpringJacobian(system_, p, v, terms_, Jp_, Jv_);
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) {
      auto block = newton_.block(i * n, j * n, n, n);
      block = -h * h * kAA[i][j] * Jp_ - h * kGaussA[i][j] * Jv_;
      if (i == j) block.diagonal().array() += 1;
    }
  }
  lu_.compute(newton_);
  factored_h_ = h;
}

// Newton starts from the polynomial through the stages of up to two steps before.
void SpringStepper::Predict(double t, double h) {
  for (int i = 0; i < 2; ++i) {
    const double time = t + kGaussC[i] * h;
    stages_.a[i].setZero();
    for (int k = 4 - known_; k < 4; ++k) {
      double weight = 1;
      for (int j = 4 - known_; j < 4; ++j) {
        if (j != k) weight *= (time - past_t_[j]) / (past_t_[k] - past_t_[j]);
      }
      stages_.a[i] += weight * past_.col(k);
    }
  }
}

// The stage accelerations of Eq. (5) by Newton's method with a matrix made before. False if it
// converges slowly or not at all.
bool SpringStepper::Solve(double h, const MatrixXd& p, const MatrixXd& v) {
  const Index n = system_.num_coordinates();
  const double size = 1 + std::max(p.cwiseAbs().maxCoeff(), v.cwiseAbs().maxCoeff());
  double before = 0;
  for (int iteration = 0; iteration < options_.max_iterations; ++iteration) {
    for (int i = 0; i < 2; ++i) {
      Flat(stages_.v[i]) =
          Flat(v) + h * (kGaussA[i][0] * stages_.a[0] + kGaussA[i][1] * stages_.a[1]);
      Flat(stages_.p[i]) = Flat(p) + (h * kGaussC[i]) * Flat(v) +
                           (h * h) * (kAA[i][0] * stages_.a[0] + kAA[i][1] * stages_.a[1]);
      EvaluateSprings(system_, stages_.p[i], stages_.v[i], stages_.f[i], terms_);
      residual_.segment(i * n, n) = Flat(terms_.acc) - stages_.a[i];
    }
    // PartialPivLU::solve would allocate a result of its own.
    change_.noalias() = lu_.permutationP() * residual_;
    lu_.matrixLU().triangularView<Eigen::UnitLower>().solveInPlace(change_);
    lu_.matrixLU().triangularView<Eigen::Upper>().solveInPlace(change_);
    stages_.a[0] += change_.head(n);
    stages_.a[1] += change_.tail(n);
    const double change = h * change_.cwiseAbs().maxCoeff();
    if (!std::isfinite(change)) return false;
    if (change < options_.tolerance * size) return true;
    // With a fixed matrix the error falls by the same rate every time: that tells what is left.
    const double rate = before > 0 ? change / before : 0;
    if (rate > 0 && rate < 1 && change * rate < options_.tolerance * size * (1 - rate)) return true;
    if (rate > kSlow) factored_h_ = 0;
    before = change;
  }
  return false;
}

bool SpringStepper::TryStep(const ForceProfile& force, double t, double h, const MatrixXd& p,
                            const MatrixXd& v) {
  for (int i = 0; i < 2; ++i) force.At(t + kGaussC[i] * h, stages_.f[i]);
  stages_.t = t;
  stages_.h = h;
  if (known_ > 0 && std::abs(end_ - t) > 1e-9 * h) known_ = 0;
  // The matrix of a step before serves as long as Newton converges with it.
  if (known_ > 0 && std::abs(factored_h_ - h) < kSameStep * h) {
    Predict(t, h);
    if (Solve(h, p, v)) return true;
  }
  force.At(t + 0.5 * h, force_);
  Factor(force_, h, p, v);
  if (known_ > 0) {
    Predict(t, h);
  } else {
    for (VectorXd& a : stages_.a) a = Flat(terms_.acc);
  }
  return Solve(h, p, v);
}

bool SpringStepper::StepHalving(const ForceProfile& force, double t, double h, int depth,
                                MatrixXd& p, MatrixXd& v) {
  if (TryStep(force, t, h, p, v)) {
    Flat(p) += h * Flat(v) + (h * h) * (kBA[0] * stages_.a[0] + kBA[1] * stages_.a[1]);
    Flat(v) += (0.5 * h) * (stages_.a[0] + stages_.a[1]);
    for (int i = 0; i < 2; ++i) {
      past_t_[i] = past_t_[i + 2];
      past_t_[i + 2] = t + kGaussC[i] * h;
      past_.col(i) = past_.col(i + 2);
      past_.col(i + 2) = stages_.a[i];
    }
    known_ = std::min(4, known_ + 2);
    end_ = t + h;
    if (on_step) on_step(stages_);
    return p.allFinite() && v.allFinite();
  }
  if (depth >= options_.max_halvings) return false;
  return StepHalving(force, t, 0.5 * h, depth + 1, p, v) &&
         StepHalving(force, t + 0.5 * h, 0.5 * h, depth + 1, p, v);
}

bool SpringStepper::Step(const ForceProfile& force, double t, double h, MatrixXd& p, MatrixXd& v) {
  return StepHalving(force, t, h, 0, p, v);
}

bool AdvanceSprings(SpringStepper& stepper, const ForceProfile& force, double t0, double t1,
                    double step, MatrixXd& p, MatrixXd& v) {
  double t = t0;
  while (t < t1) {
    const auto kink = std::upper_bound(force.kinks.begin(), force.kinks.end(), t);
    const double stop = kink == force.kinks.end() ? t1 : std::min(*kink, t1);
    const int count = std::max(1, static_cast<int>(std::ceil((stop - t) / step - 1e-9)));
    const double h = (stop - t) / count;
    for (int i = 0; i < count; ++i) {
      if (!stepper.Step(force, t + i * h, h, p, v)) return false;
    }
    t = stop;
  }
  return true;
}

std::optional<SpringTrajectory> IntegrateSprings(const SpringSystem& system,
                                                 const ForceProfile& force, const MatrixXd& p0,
                                                 const MatrixXd& v0, const VectorXd& times,
                                                 const SpringIntegration& options) {
  ThrowUnless(p0.rows() == system.dim && p0.cols() == system.num_fingers() &&
                  v0.rows() == p0.rows() && v0.cols() == p0.cols(),
              "springs: start is {}x{} and {}x{}, expected {}x{}", p0.rows(), p0.cols(), v0.rows(),
              v0.cols(), system.dim, system.num_fingers());
  ThrowUnless(options.step > 0, "springs: step is {} s, must be positive", options.step);
  SpringStepper stepper(system, options);
  SpringTrajectory out;
  out.t = times;
  out.p.resize(times.size(), system.num_coordinates());
  out.v.resize(times.size(), system.num_coordinates());
  MatrixXd p = p0, v = v0;
  for (Index i = 0; i < times.size(); ++i) {
    if (i > 0) {
      ThrowUnless(times[i] > times[i - 1], "springs: times must increase; {} follows {}", times[i],
                  times[i - 1]);
      if (!AdvanceSprings(stepper, force, times[i - 1], times[i], options.step, p, v)) return {};
    }
    out.p.row(i) = Flat(p).transpose();
    out.v.row(i) = Flat(v).transpose();
  }
  return out;
}

}  // namespace springgrasp
