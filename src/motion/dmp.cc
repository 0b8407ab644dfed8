#include "motion/dmp.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace springgrasp {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

void CheckSamples(const MotionSamples& samples) {
  const Index m = samples.size();
  ThrowUnless(m >= 4, "movement primitive: {} samples, at least 4 are needed", m);
  for (const MatrixXd* values : {&samples.x, &samples.v, &samples.a}) {
    ThrowUnless(values->rows() == m && values->cols() == samples.x.cols(),
                "movement primitive: {} times, but positions, velocities or accelerations of size "
                "{}x{}",
                m, values->rows(), values->cols());
    ThrowUnless(values->allFinite(), "movement primitive: a sample is not finite");
  }
  for (Index i = 1; i < m; ++i) {
    ThrowUnless(samples.t[i] > samples.t[i - 1],
                "movement primitive: times must increase; {} follows {}", samples.t[i],
                samples.t[i - 1]);
  }
}

// s psi_i(s) / sum psi(s) of all bases, into `row`.
void BasisRow(const Dmp& dmp, double s, VectorXd& row) {
  constexpr double kNothing = -40;  // exp of it does not change a sum of which 1 is a part
  row = (-dmp.widths.array() * (s - dmp.centers.array()).square()).matrix();
  const double largest = row.maxCoeff();
  double sum = 0;
  for (double& value : row) {
    value -= largest;
    value = value < kNothing ? 0 : std::exp(value);
    sum += value;
  }
  row *= s / sum;
}

// Least squares for the weights, each sample counted by `importance`.
void Regress(const MotionSamples& samples, const VectorXd& importance, Dmp& dmp) {
  const Index m = samples.size();
  MatrixXd basis(m, dmp.centers.size());
  MatrixXd target(m, dmp.dimension());
  VectorXd row(dmp.centers.size());
  for (Index i = 0; i < m; ++i) {
    const double s = std::exp(-dmp.alpha * (samples.t[i] - samples.t[0]) / dmp.tau);
    BasisRow(dmp, s, row);
    const double weight = std::sqrt(importance[i]);
    basis.row(i) = weight * row.transpose();
    // Eq. (10) solved for f(s).
    target.row(i) =
        weight *
        ((dmp.tau * dmp.tau * samples.a.row(i) + dmp.D * dmp.tau * samples.v.row(i)) / dmp.K -
         (dmp.g.transpose() - samples.x.row(i)) + s * (dmp.g - dmp.x0).transpose());
  }
  // Columns of late bases are small because s is: scale them before the rank is judged.
  VectorXd scale = basis.colwise().norm();
  for (double& value : scale) value = value > 0 ? value : 1;
  const MatrixXd scaled = basis * scale.cwiseInverse().asDiagonal();
  dmp.weights =
      scale.cwiseInverse().asDiagonal() * scaled.completeOrthogonalDecomposition().solve(target);
}

// Right-hand side of Eq. (10) as a physical acceleration.
struct Acceleration {
  const Dmp& dmp;
  double tau2 = dmp.tau * dmp.tau;
  // constant + forcing part at one phase
  void Drive(double s, VectorXd& row, VectorXd& drive) const {
    BasisRow(dmp, s, row);
    drive.noalias() = dmp.weights.transpose() * row;
    drive += (1 - s) * dmp.g + s * dmp.x0;
    drive *= dmp.K / tau2;
  }
};

// Classical Runge-Kutta over the linear system x'' = drive(t) - (K/tau^2) x - (D/tau) x'.
class Integrator {
 public:
  explicit Integrator(const Dmp& dmp)
      : acceleration_{dmp}, stiffness_(dmp.K / (dmp.tau * dmp.tau)), damping_(dmp.D / dmp.tau) {
    row_.resize(dmp.centers.size());
    for (VectorXd* drive : {&drive0_, &drive1_, &drive2_}) drive->resize(dmp.dimension());
  }

  // Advances x, v from phase s by h seconds in `count` equal steps; s becomes exp(-alpha h/tau) s.
  void Advance(double h, double& s, VectorXd& x, VectorXd& v) {
    const Dmp& dmp = acceleration_.dmp;
    const int count = std::max(1, static_cast<int>(std::ceil(h / (kDmpStep * dmp.tau) - 1e-9)));
    const double dt = h / count;
    const double half = std::exp(-0.5 * dmp.alpha * dt / dmp.tau);
    const double s0 = s;
    acceleration_.Drive(s, row_, drive0_);
    for (int i = 0; i < count; ++i) {
      acceleration_.Drive(s * half, row_, drive1_);
      s = s0 * std::exp(-dmp.alpha * (i + 1) * dt / dmp.tau);
      acceleration_.Drive(s, row_, drive2_);
      a1_ = drive0_ - stiffness_ * x - damping_ * v;
      v2_ = v + (0.5 * dt) * a1_;
      a2_ = drive1_ - stiffness_ * (x + (0.5 * dt) * v) - damping_ * v2_;
      v3_ = v + (0.5 * dt) * a2_;
      a3_ = drive1_ - stiffness_ * (x + (0.5 * dt) * v2_) - damping_ * v3_;
      v4_ = v + dt * a3_;
      a4_ = drive2_ - stiffness_ * (x + dt * v3_) - damping_ * v4_;
      x += (dt / 6) * (v + 2 * v2_ + 2 * v3_ + v4_);
      v += (dt / 6) * (a1_ + 2 * a2_ + 2 * a3_ + a4_);
      drive0_.swap(drive2_);
    }
  }

  // Acceleration at (s, x, v), into `a`.
  template <typename Out>
  void At(double s, const VectorXd& x, const VectorXd& v, Out&& a) {
    acceleration_.Drive(s, row_, drive0_);
    a = drive0_ - stiffness_ * x - damping_ * v;
  }

 private:
  Acceleration acceleration_;
  double stiffness_, damping_;
  VectorXd row_, drive0_, drive1_, drive2_;
  VectorXd a1_, a2_, a3_, a4_, v2_, v3_, v4_;
};

void CheckDmp(const Dmp& dmp) {
  ThrowUnless(dmp.tau > 0 && dmp.K > 0, "movement primitive: tau and K must be positive");
  ThrowUnless(dmp.centers.size() > 0 && dmp.widths.size() == dmp.centers.size() &&
                  dmp.weights.rows() == dmp.centers.size() &&
                  dmp.weights.cols() == dmp.dimension() && dmp.g.size() == dmp.dimension(),
              "movement primitive: sizes of centers, widths, weights, x0 and g do not agree");
}

VectorXd InitialVelocity(const Dmp& dmp, const VectorXd& v0) {
  if (v0.size() == 0) return VectorXd::Zero(dmp.dimension());
  ThrowUnless(v0.size() == dmp.dimension(),
              "movement primitive: initial velocity has {} entries, expected {}", v0.size(),
              dmp.dimension());
  return v0;
}

}  // namespace

Dmp MakeDmp(const VectorXd& x0, const VectorXd& g, const DmpOptions& options) {
  ThrowUnless(options.num_basis >= 2, "movement primitive: {} basis functions, at least 2",
              options.num_basis);
  ThrowUnless(options.K > 0 && options.tau >= 0, "movement primitive: K must be positive");
  ThrowUnless(x0.size() == g.size(), "movement primitive: start has {} entries, goal {}", x0.size(),
              g.size());
  Dmp dmp;
  dmp.K = options.K;
  dmp.D = 2 * std::sqrt(options.K);
  dmp.tau = options.tau > 0 ? options.tau : 1;
  const Index n = options.num_basis;
  dmp.centers.resize(n);
  dmp.widths.resize(n);
  for (Index i = 0; i < n; ++i) {
    dmp.centers[i] = std::exp(-dmp.alpha * static_cast<double>(i) / static_cast<double>(n - 1));
  }
  for (Index i = 0; i + 1 < n; ++i) {
    const double width = 1.5 * (dmp.centers[i + 1] - dmp.centers[i]);
    dmp.widths[i] = 1 / (width * width);
  }
  dmp.widths[n - 1] = dmp.widths[n - 2];
  dmp.weights = MatrixXd::Zero(n, x0.size());
  dmp.x0 = x0;
  dmp.g = g;
  return dmp;
}

Dmp LearnDmp(const MotionSamples& samples, const DmpOptions& options) {
  CheckSamples(samples);
  const Index m = samples.size();
  DmpOptions complete = options;
  if (complete.tau <= 0) complete.tau = samples.t[m - 1] - samples.t[0];
  Dmp dmp = MakeDmp(samples.x.row(0).transpose(), samples.x.row(m - 1).transpose(), complete);
  VectorXd importance = VectorXd::Zero(m);
  for (Index i = 1; i < m; ++i) {
    const double half = 0.5 * (samples.t[i] - samples.t[i - 1]);
    importance[i - 1] += half;
    importance[i] += half;
  }
  Regress(samples, importance, dmp);
  return dmp;
}

void LearnDmpWeights(const MotionSamples& samples, Dmp& dmp) {
  CheckSamples(samples);
  dmp.x0 = samples.x.row(0).transpose();
  dmp.g = samples.x.row(samples.size() - 1).transpose();
  dmp.weights = MatrixXd::Zero(dmp.centers.size(), dmp.dimension());
  CheckDmp(dmp);
  Regress(samples, VectorXd::Ones(samples.size()), dmp);
}

VectorXd DmpForcing(const Dmp& dmp, double s) {
  VectorXd row(dmp.centers.size());
  BasisRow(dmp, s, row);
  return dmp.weights.transpose() * row;
}

MotionSamples RolloutDmp(const Dmp& dmp, const VectorXd& times, const VectorXd& v0) {
  CheckDmp(dmp);
  VectorXd x = dmp.x0;
  VectorXd v = InitialVelocity(dmp, v0);
  MotionSamples out;
  out.t = times;
  for (MatrixXd* values : {&out.x, &out.v, &out.a}) values->resize(times.size(), dmp.dimension());
  Integrator integrator(dmp);
  double t = 0, s = 1;
  for (Index i = 0; i < times.size(); ++i) {
    ThrowUnless(times[i] >= t,
                "movement primitive: times must start at 0 and increase; {} after {}", times[i], t);
    if (times[i] > t) integrator.Advance(times[i] - t, s, x, v);
    t = times[i];
    s = std::exp(-dmp.alpha * t / dmp.tau);
    out.x.row(i) = x.transpose();
    out.v.row(i) = v.transpose();
    VectorXd a;
    integrator.At(s, x, v, a);
    out.a.row(i) = a.transpose();
  }
  return out;
}

VectorXd EvenTimes(double duration, double dt) {
  ThrowUnless(dt > 0 && duration >= 0 && duration / dt < 1e8,
              "even times: duration {} s, step {} s", duration, dt);
  const auto n = static_cast<Index>(std::floor(duration / dt + 1e-9)) + 1;
  VectorXd times(n);
  for (Index i = 0; i < n; ++i) times[i] = static_cast<double>(i) * dt;
  return times;
}

MotionSamples RolloutDmp(const Dmp& dmp, double duration, double dt, const VectorXd& v0) {
  return RolloutDmp(dmp, EvenTimes(duration, dt), v0);
}

double DmpGoalResponse(const Dmp& dmp, double t) {
  const double u = t / dmp.tau;
  double om = std::sqrt(dmp.K);
  // The formula has a removable singularity at om = alpha.
  if (std::abs(om - dmp.alpha) < 1e-4 * dmp.alpha) om = dmp.alpha * (1 + 1e-4);
  const double decay = std::exp(-om * u);
  const double difference = om - dmp.alpha;
  return 1 - (1 + om * u) * decay -
         om * om / (difference * difference) *
             (std::exp(-dmp.alpha * u) - (1 + difference * u) * decay);
}

DmpState StartDmp(const Dmp& dmp, const VectorXd& v0) {
  CheckDmp(dmp);
  return {dmp.x0, InitialVelocity(dmp, v0), 1.0};
}

namespace {

// Acceleration at a state, into `a`.
void Couple(Integrator& integrator, const DmpState& state, const DmpCoupling& coupling,
            VectorXd& a) {
  integrator.At(state.s, state.x, state.v, a);
  if (coupling.acceleration) a += coupling.acceleration(state.x, state.v);
  for (const SphereObstacle& obstacle : coupling.obstacles) {
    AvoidObstacle(obstacle, state.x, state.v, a);
  }
}

}  // namespace

VectorXd DmpAcceleration(const Dmp& dmp, const DmpState& state, const DmpCoupling& coupling) {
  VectorXd a(dmp.dimension());
  Integrator integrator(dmp);
  Couple(integrator, state, coupling, a);
  return a;
}

void StepDmp(const Dmp& dmp, double dt, DmpState& state, const DmpCoupling& coupling) {
  double h = dt;
  if (coupling.measured && coupling.phase_stopping > 0) {
    h /= 1 + coupling.phase_stopping * (*coupling.measured - state.x).squaredNorm();
  }
  if (!coupling.acceleration && coupling.obstacles.empty()) {
    Integrator(dmp).Advance(h, state.s, state.x, state.v);
    return;
  }
  const int count = std::max(1, static_cast<int>(std::ceil(h / (kDmpStep * dmp.tau) - 1e-9)));
  const double step = h / count;
  const double half = std::exp(-0.5 * dmp.alpha * step / dmp.tau);
  Integrator integrator(dmp);
  DmpState k1 = state, k2 = state, k3 = state, k4 = state;
  VectorXd a1(dmp.dimension()), a2 = a1, a3 = a1, a4 = a1;
  for (int i = 0; i < count; ++i) {
    k1 = state;
    Couple(integrator, k1, coupling, a1);
    k2.x = k1.x + 0.5 * step * k1.v;
    k2.v = k1.v + 0.5 * step * a1;
    k2.s = k1.s * half;
    Couple(integrator, k2, coupling, a2);
    k3.x = k1.x + 0.5 * step * k2.v;
    k3.v = k1.v + 0.5 * step * a2;
    k3.s = k2.s;
    Couple(integrator, k3, coupling, a3);
    k4.x = k1.x + step * k3.v;
    k4.v = k1.v + step * a3;
    k4.s = k1.s * half * half;
    Couple(integrator, k4, coupling, a4);
    state.x += step / 6 * (k1.v + 2 * k2.v + 2 * k3.v + k4.v);
    state.v += step / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    state.s = k4.s;
  }
}

}  // namespace springgrasp
