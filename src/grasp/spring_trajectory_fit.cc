#include "grasp/spring_trajectory_fit.h"

#include <algorithm>
#include <cmath>

namespace springgrasp {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

MatrixXd PointsOf(const RowVectorXd& row, int dim) {
  return Eigen::Map<const MatrixXd>(row.data(), dim, row.size() / dim);
}

std::vector<SpringGain> GainsToFit(const FittedGains& fit) {
  std::vector<SpringGain> gains;
  if (fit.gamma) gains.push_back(SpringGain::kGamma);
  if (fit.beta) gains.push_back(SpringGain::kBeta);
  if (fit.delay) gains.push_back(SpringGain::kDelay);
  if (fit.t_switch) gains.push_back(SpringGain::kSwitch);
  if (fit.damping) gains.push_back(SpringGain::kDamping);
  if (fit.contact) gains.push_back(SpringGain::kContact);
  if (fit.contact) gains.push_back(SpringGain::kContactDamping);
  return gains;
}

void ApplyGain(SpringGain gain, double value, SpringEstimate& estimate) {
  switch (gain) {
    case SpringGain::kGamma:
      estimate.gamma = std::exp(value);
      break;
    case SpringGain::kBeta:
      estimate.beta = std::exp(value);
      break;
    case SpringGain::kDelay:
      estimate.delay = value;
      break;
    case SpringGain::kSwitch:
      estimate.t_switch = value;
      break;
    case SpringGain::kDamping:
      estimate.damping_factor = std::exp(value);
      break;
    case SpringGain::kContact:
      estimate.kc_factor = std::exp(value);
      break;
    case SpringGain::kContactDamping:
      estimate.dc_factor = std::exp(value);
      break;
  }
}

// Start and bounds of a gain.
struct GainRange {
  double start, lower, upper;
};
GainRange RangeOf(SpringGain gain, const CentralForce& force) {
  const double kLog = std::log(100.0);
  switch (gain) {
    case SpringGain::kGamma: {
      const double log_gamma = std::log(std::max(force.gamma, 1e-9));
      return {log_gamma, log_gamma - kLog, log_gamma + kLog};
    }
    case SpringGain::kBeta: {
      const double log_beta = std::log(std::max(force.beta, 1e-3));
      return {log_beta, std::log(0.1), std::log(100.0)};
    }
    case SpringGain::kDelay:
      return {force.delay, 0, 0.5 * force.T};
    case SpringGain::kSwitch:
      return {force.t_switch, 0.02 * force.T, 0.98 * force.T};
    default:
      return {0, -kLog, kLog};
  }
}

}  // namespace

TrajectoryFit::TrajectoryFit(const std::vector<SpringObservation>& observations,
                             const EstimationOptions& options, const SpringEstimate& initial)
    : observations_(observations), options_(options), initial_(initial) {
  parameters_.gains = GainsToFit(options.fit);
  parameters_.start = options.fit_start;
  E_ = static_cast<Index>(observations[0].system.springs.size());
  G_ = static_cast<Index>(parameters_.gains.size());
  n_ = observations[0].system.num_coordinates();
  for (const SpringObservation& o : observations) {
    for (const double x : o.p.reshaped()) residuals_ += std::isfinite(x) ? 1 : 0;
  }
  priors_ = options.gain_prior > 0 ? G_ : 0;
}

Index TrajectoryFit::num_unknowns() const {
  return E_ + G_ + (options_.fit_start ? 2 * n_ * static_cast<Index>(observations_.size()) : 0);
}

VectorXd TrajectoryFit::Start() const {
  VectorXd x = VectorXd::Zero(num_unknowns());
  x.head(E_) = initial_.k.cwiseMax(0.0);
  for (Index g = 0; g < G_; ++g) {
    x[E_ + g] =
        RangeOf(parameters_.gains[static_cast<std::size_t>(g)], observations_[0].force).start;
  }
  if (!options_.fit_start) return x;
  for (std::size_t i = 0; i < observations_.size(); ++i) {
    const Index at = StartIndex(i);
    x.segment(at, n_) = observations_[i].p_smooth.row(0).transpose();
    x.segment(at + n_, n_) = observations_[i].v.row(0).transpose();
  }
  return x;
}

void TrajectoryFit::Bounds(VectorXd& lower, VectorXd& upper) const {
  lower = VectorXd::Constant(num_unknowns(), -1e6);
  upper = VectorXd::Constant(num_unknowns(), 1e6);
  lower.head(E_).setZero();
  // Stiffer than that, a spring is a rod.
  upper.head(E_).setConstant(1000 * std::max(observations_[0].system.kc, 1e-6));
  for (Index g = 0; g < G_; ++g) {
    const GainRange range =
        RangeOf(parameters_.gains[static_cast<std::size_t>(g)], observations_[0].force);
    lower[E_ + g] = range.lower;
    upper[E_ + g] = range.upper;
  }
}

SpringEstimate TrajectoryFit::At(const VectorXd& x) const {
  SpringEstimate estimate = initial_;
  estimate.k = x.head(E_);
  for (Index g = 0; g < G_; ++g) {
    ApplyGain(parameters_.gains[static_cast<std::size_t>(g)], x[E_ + g], estimate);
  }
  return estimate;
}

void TrajectoryFit::StartStates(const VectorXd& x, std::size_t i, MatrixXd& p0,
                                MatrixXd& v0) const {
  const int dim = observations_[i].system.dim;
  if (options_.fit_start) {
    p0 = PointsOf(x.segment(StartIndex(i), n_).transpose(), dim);
    v0 = PointsOf(x.segment(StartIndex(i) + n_, n_).transpose(), dim);
  } else {
    p0 = PointsOf(observations_[i].p_smooth.row(0), dim);
    v0 = PointsOf(observations_[i].v.row(0), dim);
  }
}

std::optional<SpringTrajectory> TrajectoryFit::Simulate(const VectorXd& x, std::size_t i,
                                                        MatrixXd* dp) const {
  const SpringEstimate estimate = At(x);
  const SpringObservation& o = observations_[i];
  const SpringSystem system = WithEstimate(o.system, estimate);
  const CentralForce force = WithEstimate(o.force, estimate);
  MatrixXd p0, v0;
  StartStates(x, i, p0, v0);
  const SpringIntegration integration = {.step = options_.step, .tolerance = 1e-9};
  if (dp == nullptr) {
    return IntegrateSprings(system, MakeForceProfile(force), p0, v0, o.t, integration);
  }
  return IntegrateWithSensitivities(system, force, parameters_, p0, v0, o.t, integration, *dp);
}

void TrajectoryFit::Evaluate(const VectorXd& x, VectorXd& r, MatrixXd* J) const {
  constexpr double kFailed = 10;  // m; a trajectory that runs away
  r.setConstant(num_residuals(), kFailed);
  if (J != nullptr) J->setZero(num_residuals(), num_unknowns());
  Index row = 0;
  MatrixXd dp;
  for (std::size_t i = 0; i < observations_.size(); ++i) {
    const SpringObservation& o = observations_[i];
    const auto simulated = Simulate(x, i, J == nullptr ? nullptr : &dp);
    const auto weight = [&](Index c) {
      return o.weight.size() > 0 ? o.weight[c / o.system.dim] : 1.0;
    };
    for (Index k = 0; k < o.t.size(); ++k) {
      for (Index c = 0; c < n_; ++c) {
        if (!std::isfinite(o.p(k, c))) continue;
        if (simulated) {
          r[row] = weight(c) * (simulated->p(k, c) - o.p(k, c));
          if (J != nullptr) {
            J->row(row).head(E_ + G_) = weight(c) * dp.row(k * n_ + c).head(E_ + G_);
            if (options_.fit_start) {
              J->row(row).segment(StartIndex(i), 2 * n_) =
                  weight(c) * dp.row(k * n_ + c).tail(2 * n_);
            }
          }
        }
        ++row;
      }
    }
  }
  for (Index g = 0; g < priors_; ++g) {
    const GainRange range =
        RangeOf(parameters_.gains[static_cast<std::size_t>(g)], observations_[0].force);
    const bool is_time = parameters_.gains[static_cast<std::size_t>(g)] == SpringGain::kDelay ||
                         parameters_.gains[static_cast<std::size_t>(g)] == SpringGain::kSwitch;
    const double scale = options_.gain_prior * (is_time ? observations_[0].force.T : 1.0);
    const double weight = (options_.noise > 0 ? options_.noise : 1e-3) / scale;
    r[row] = weight * (x[E_ + g] - range.start);
    if (J != nullptr) (*J)(row, E_ + g) = weight;
    ++row;
  }
}

}  // namespace springgrasp
