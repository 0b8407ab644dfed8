#include "grasp/spring_sensitivity.h"

#include <cmath>

#include "base/error.h"

namespace springgrasp {
namespace {

using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Rows are contiguous: elimination works on whole rows.
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Solves A X = B by elimination with row exchanges; B becomes X, A is used up. Allocates nothing.
void SolveInPlace(RowMatrix& A, RowMatrix& B) {
  const Index n = A.rows();
  for (Index k = 0; k < n; ++k) {
    Index pivot = k;
    for (Index i = k + 1; i < n; ++i) {
      if (std::abs(A(i, k)) > std::abs(A(pivot, k))) pivot = i;
    }
    if (pivot != k) {
      A.row(k).swap(A.row(pivot));
      B.row(k).swap(B.row(pivot));
    }
    for (Index i = k + 1; i < n; ++i) {
      const double part = A(i, k) / A(k, k);
      if (part == 0) continue;
      A.row(i).tail(n - k - 1) -= part * A.row(k).tail(n - k - 1);
      B.row(i) -= part * B.row(k);
    }
  }
  for (Index k = n - 1; k >= 0; --k) {
    B.row(k) /= A(k, k);
    for (Index i = 0; i < k; ++i) B.row(i) -= A(i, k) * B.row(k);
  }
}

// The force a little below and above a gain that acts through it, for one finger's lag.
struct Varied {
  CentralForce lower, upper;
  double step = 1e-5;
};
Varied Vary(const CentralForce& force, SpringGain gain, double lag) {
  Varied out{force, force};
  for (CentralForce* side : {&out.lower, &out.upper}) {
    side->lag.resize(0);
    side->t_switch += lag;
  }
  switch (gain) {
    case SpringGain::kGamma:
      out.lower.gamma *= std::exp(-out.step);
      out.upper.gamma *= std::exp(out.step);
      break;
    case SpringGain::kBeta:
      out.lower.beta *= std::exp(-out.step);
      out.upper.beta *= std::exp(out.step);
      break;
    case SpringGain::kDelay:
      out.step *= force.T;
      out.lower.delay -= out.step;
      out.upper.delay += out.step;
      break;
    case SpringGain::kSwitch:
      out.step *= force.T;
      out.lower.t_switch -= out.step;
      out.upper.t_switch += out.step;
      break;
    default:
      break;
  }
  return out;
}

// Carries d(p, v)/dtheta along with the stepper.
class Sensitivities {
 public:
  Sensitivities(const SpringSystem& system, const CentralForce& force,
                const SpringParameters& parameters)
      : system_(system), parameters_(parameters), n_(system.num_coordinates()) {
    const Index q = parameters.count(system);
    P.setZero(n_, q);
    V.setZero(n_, q);
    if (parameters.start) {
      P.middleCols(q - 2 * n_, n_).setIdentity();
      V.rightCols(n_).setIdentity();
    }
    matrix_.setZero(2 * n_, 2 * n_);
    right_.setZero(2 * n_, q);
    for (const SpringGain gain : parameters.gains) {
      MatrixXd tables(kTable, std::max<Index>(1, force.lag.size()));
      for (Index i = 0; i < tables.cols() && gain <= SpringGain::kSwitch; ++i) {
        tables.col(i) = Table(force, gain, force.lag.size() > 0 ? force.lag[i] : 0);
      }
      tables_.push_back(std::move(tables));
    }
    dt_ = (last_ - first_) / static_cast<double>(kTable - 1);
  }

  void OnStep(const SpringStepper::Stages& stages) {
    const double h = stages.h;
    for (int i = 0; i < 2; ++i) {
      EvaluateSprings(system_, stages.p[i], stages.v[i], stages.f[i], terms_);
      SpringJacobian(system_, stages.p[i], stages.v[i], terms_, Jp_, Jv_);
      for (int j = 0; j < 2; ++j) {
        const double aa = kGaussA[i][0] * kGaussA[0][j] + kGaussA[i][1] * kGaussA[1][j];
        auto block = matrix_.block(i * n_, j * n_, n_, n_);
        block = -h * h * aa * Jp_ - h * kGaussA[i][j] * Jv_;
        if (i == j) block.diagonal().array() += 1;
      }
      auto rows = right_.middleRows(i * n_, n_);
      stage_ = P + (h * kGaussC[i]) * V;
      rows.noalias() = Jp_ * stage_;
      rows.noalias() += Jv_ * V;
      AddExplicit(stages, i, rows);
    }
    SolveInPlace(matrix_, right_);
    const double b0 = 0.5 * (kGaussA[0][0] + kGaussA[1][0]);
    const double b1 = 0.5 * (kGaussA[0][1] + kGaussA[1][1]);
    P += h * V + (h * h) * (b0 * right_.topRows(n_) + b1 * right_.bottomRows(n_));
    V += (0.5 * h) * (right_.topRows(n_) + right_.bottomRows(n_));
  }

  RowMatrix P, V;  // n x parameters

 private:
  static constexpr Index kTable = 2001;

  // The force's derivative is tabulated once: it is asked for at every stage.
  VectorXd Table(const CentralForce& force, SpringGain gain, double lag) {
    first_ = std::min(force.t[0], 0.0);
    last_ = std::max(force.t[force.t.size() - 1], force.T) + force.delay + 0.1 * force.T;
    const Varied varied = Vary(force, gain, lag);
    VectorXd values(kTable);
    for (Index i = 0; i < kTable; ++i) {
      const double t = first_ + (last_ - first_) * static_cast<double>(i) / (kTable - 1);
      const double change =
          EvaluateCentralForce(varied.upper, t) - EvaluateCentralForce(varied.lower, t);
      values[i] = change / (2 * varied.step);
    }
    return values;
  }

  double At(const MatrixXd& tables, int finger, double t) const {
    const auto table = tables.col(std::min<Index>(finger, tables.cols() - 1));
    const double x = (t - first_) / dt_;
    if (x <= 0 || x >= kTable - 1) return 0;
    const auto i = static_cast<Index>(x);
    const double fraction = x - static_cast<double>(i);
    return (1 - fraction) * table[i] + fraction * table[i + 1];
  }

  // d acc / d theta at fixed state.
  template <typename Rows>
  void AddExplicit(const SpringStepper::Stages& stages, int stage, Rows& rows) const {
    const int dim = system_.dim;
    const auto E = static_cast<Index>(system_.springs.size());
    for (Index e = 0; e < E; ++e) {
      const Spring& spring = system_.springs[static_cast<std::size_t>(e)];
      rows.col(e).segment(dim * spring.i, dim) -= terms_.x.col(e) / system_.mass[spring.i];
      rows.col(e).segment(dim * spring.j, dim) += terms_.x.col(e) / system_.mass[spring.j];
    }
    for (std::size_t g = 0; g < parameters_.gains.size(); ++g) {
      auto column = rows.col(E + static_cast<Index>(g));
      const SpringGain gain = parameters_.gains[g];
      if (gain == SpringGain::kDamping) {
        for (Index e = 0; e < E; ++e) {
          const Spring& spring = system_.springs[static_cast<std::size_t>(e)];
          const auto xdot = spring.d * terms_.xdot.col(e);
          column.segment(dim * spring.i, dim) -= xdot / system_.mass[spring.i];
          column.segment(dim * spring.j, dim) += xdot / system_.mass[spring.j];
        }
        continue;
      }
      for (int i = 0; i < system_.num_fingers(); ++i) {
        if (!system_.involved[static_cast<std::size_t>(i)]) continue;
        auto rows_i = column.segment(dim * i, dim);
        const double share = system_.share[i];
        if (gain == SpringGain::kContact) {
          rows_i -= (share * system_.kc / system_.mass[i]) * terms_.xc.col(i);
        } else if (gain == SpringGain::kContactDamping) {
          rows_i -= (share * system_.dc / system_.mass[i]) * stages.v[stage].col(i);
        } else {
          const double df = At(tables_[g], i, stages.t + kGaussC[stage] * stages.h);
          rows_i -= (share * terms_.ratio[i] * df / system_.mass[i]) * terms_.direction.col(i);
        }
      }
    }
  }

  const SpringSystem& system_;
  const SpringParameters& parameters_;
  Index n_;
  std::vector<MatrixXd> tables_;  // per gain: a column for all fingers, or for each
  double first_ = 0, last_ = 1, dt_ = 1;
  SpringTerms terms_;
  MatrixXd Jp_, Jv_;
  RowMatrix matrix_, right_, stage_;
};

}  // namespace

std::optional<SpringTrajectory> IntegrateWithSensitivities(
    const SpringSystem& system, const CentralForce& force, const SpringParameters& parameters,
    const MatrixXd& p0, const MatrixXd& v0, const VectorXd& times, const SpringIntegration& options,
    MatrixXd& dp) {
  const ForceProfile profile = MakeForceProfile(force);
  SpringStepper stepper(system, options);
  Sensitivities sensitivities(system, force, parameters);
  stepper.on_step = [&](const SpringStepper::Stages& stages) { sensitivities.OnStep(stages); };
  const Index n = system.num_coordinates(), m = times.size();
  SpringTrajectory out;
  out.t = times;
  out.p.resize(m, n);
  out.v.resize(m, n);
  dp.resize(m * n, parameters.count(system));
  MatrixXd p = p0, v = v0;
  for (Index i = 0; i < m; ++i) {
    if (i > 0 && !AdvanceSprings(stepper, profile, times[i - 1], times[i], options.step, p, v)) {
      return {};
    }
    out.p.row(i) = Map<const VectorXd>(p.data(), n).transpose();
    out.v.row(i) = Map<const VectorXd>(v.data(), n).transpose();
    dp.middleRows(i * n, n) = sensitivities.P;
  }
  return out;
}

}  // namespace springgrasp
