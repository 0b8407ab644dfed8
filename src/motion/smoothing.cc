#include "motion/smoothing.h"

#include <Eigen/QR>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"

namespace springgrasp {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kTwoPi = 6.28318530717958647692;
constexpr int kDegree = 5;
using Basis = std::array<double, kDegree + 1>;

// The uniform B-splines of one degree that are not zero at u in [0, 1) of their interval.
Basis UniformBasis(double u, int degree) {
  Basis b{};
  b[0] = 1;
  for (int k = 1; k <= degree; ++k) {
    double saved = 0;
    for (int j = 0; j < k; ++j) {
      const double left = (u + (k - 1 - j)) / k;  // weight of the old spline j for its successor
      const double old = b[static_cast<std::size_t>(j)];
      b[static_cast<std::size_t>(j)] = saved + (1 - left) * old;
      saved = left * old;
    }
    b[static_cast<std::size_t>(k)] = saved;
  }
  return b;
}

// Weights of the kDegree + 1 coefficients from `first` on for the given derivative at u.
Basis DerivativeBasis(double u, int derivative, double spacing) {
  const Basis lower = UniformBasis(u, kDegree - derivative);
  Basis out = lower;
  for (int d = 0; d < derivative; ++d) {
    // Each derivative is a difference of coefficients over the spacing.
    Basis next{};
    for (int j = 0; j <= kDegree; ++j) {
      const double value = out[static_cast<std::size_t>(j)] / spacing;
      next[static_cast<std::size_t>(j)] -= value;
      if (j + 1 <= kDegree) next[static_cast<std::size_t>(j + 1)] += value;
    }
    out = next;
  }
  return out;
}

struct Place {
  Index first = 0;
  double u = 0;
};

Place Locate(double t0, double spacing, Index num_coefficients, double t) {
  const Index intervals = num_coefficients - kDegree;
  const double x = std::clamp((t - t0) / spacing, 0.0, static_cast<double>(intervals));
  const Index first = std::min(static_cast<Index>(x), intervals - 1);
  return {first, x - static_cast<double>(first)};
}

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::vector<Index> UsableRows(const VectorXd& t, const MatrixXd& x) {
  ThrowUnless(x.rows() == t.size(), "smoothing: {} times, {} samples", t.size(), x.rows());
  std::vector<Index> rows;
  for (Index i = 0; i < t.size(); ++i) {
    if (!x.row(i).allFinite()) continue;
    if (!rows.empty() && t[i] <= t[rows.back()]) {
      Fail("smoothing: times must increase; {} follows {}", t[i], t[rows.back()]);
    }
    rows.push_back(i);
  }
  return rows;
}

}  // namespace

SmoothCurve FitSmoothCurve(const VectorXd& t, const MatrixXd& x, double cutoff,
                           const VectorXd& weights) {
  ThrowUnless(cutoff > 0, "smoothing: cutoff is {} Hz, must be positive", cutoff);
  ThrowUnless(weights.size() == 0 || weights.size() == t.size(), "smoothing: {} weights for {}",
              weights.size(), t.size());
  const std::vector<Index> rows = UsableRows(t, x);
  ThrowUnless(rows.size() >= 4, "smoothing: {} usable samples, at least 4 are needed", rows.size());
  std::vector<double> steps;
  for (std::size_t i = 1; i < rows.size(); ++i) steps.push_back(t[rows[i]] - t[rows[i - 1]]);
  const double step = Median(steps);

  SmoothCurve curve;
  const double duration = t[t.size() - 1] - t[0];
  // Knots five to a period of the cutoff: what they cannot follow is attenuated 200 times anyway.
  const auto intervals = static_cast<Index>(std::clamp(std::ceil(duration * 5 * cutoff), 1.0, 1e5));
  curve.t0 = t[0];
  curve.spacing = duration / static_cast<double>(intervals);
  const Index n = intervals + kDegree;

  std::vector<Eigen::Triplet<double>> entries;
  MatrixXd right = MatrixXd::Zero(n, x.cols());
  for (const Index i : rows) {
    const Place place = Locate(curve.t0, curve.spacing, n, t[i]);
    const Basis b = UniformBasis(place.u, kDegree);
    const double weight = step * (weights.size() ? weights[i] : 1.0);
    for (Index j = 0; j <= kDegree; ++j) {
      const double bj = b[static_cast<std::size_t>(j)];
      right.row(place.first + j) += weight * bj * x.row(i);
      for (Index k = 0; k <= kDegree; ++k) {
        entries.emplace_back(place.first + j, place.first + k,
                             weight * bj * b[static_cast<std::size_t>(k)]);
      }
    }
  }
  // Integral of the squared third derivative, a quadratic spline whose coefficients are third
  // differences; products of quadratic B-splines integrate to kGram.
  const double lambda = std::pow(kTwoPi * cutoff, -6) * std::pow(curve.spacing, -5);
  constexpr std::array<double, 4> kThird = {-1, 3, -3, 1};
  constexpr std::array<double, 3> kGram = {11.0 / 20, 13.0 / 60, 1.0 / 120};
  for (Index i = 0; i + 3 < n; ++i) {
    for (Index j = std::max<Index>(i - 2, 0); j < std::min(i + 3, n - 3); ++j) {
      const double gram = lambda * kGram[static_cast<std::size_t>(std::abs(i - j))];
      for (Index a = 0; a < 4; ++a) {
        for (Index b = 0; b < 4; ++b) {
          entries.emplace_back(
              i + a, j + b,
              gram * kThird[static_cast<std::size_t>(a)] * kThird[static_cast<std::size_t>(b)]);
        }
      }
    }
  }
  Eigen::SparseMatrix<double> normal(n, n);
  normal.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(normal);
  ThrowUnless(factor.info() == Eigen::Success, "smoothing: the samples do not determine a curve");
  curve.coefficients = factor.solve(right);
  return curve;
}

MotionSamples EvaluateSmoothCurve(const SmoothCurve& curve, const VectorXd& times) {
  const Index n = curve.coefficients.rows(), columns = curve.coefficients.cols();
  MotionSamples out;
  out.t = times;
  std::array<MatrixXd*, 3> targets = {&out.x, &out.v, &out.a};
  for (MatrixXd* values : targets) values->setZero(times.size(), columns);
  for (Index i = 0; i < times.size(); ++i) {
    const Place place = Locate(curve.t0, curve.spacing, n, times[i]);
    for (int d = 0; d < 3; ++d) {
      const Basis b = DerivativeBasis(place.u, d, curve.spacing);
      for (Index j = 0; j <= kDegree; ++j) {
        targets[static_cast<std::size_t>(d)]->row(i) +=
            b[static_cast<std::size_t>(j)] * curve.coefficients.row(place.first + j);
      }
    }
  }
  return out;
}

MotionSamples SmoothSamples(const VectorXd& t, const MatrixXd& x, double cutoff,
                            const VectorXd& times) {
  return EvaluateSmoothCurve(FitSmoothCurve(t, x, cutoff), times);
}

double EstimateNoise(const VectorXd& t, const MatrixXd& x) {
  const std::vector<Index> rows = UsableRows(t, x);
  std::vector<double> residuals;
  for (std::size_t i = 2; i + 2 < rows.size(); ++i) {
    const std::array<Index, 4> near = {rows[i - 2], rows[i - 1], rows[i + 1], rows[i + 2]};
    // Lagrange weights of the cubic through the neighbours.
    Eigen::RowVectorXd value = x.row(rows[i]);
    double variance = 1;
    for (const Index a : near) {
      double weight = 1;
      for (const Index b : near) {
        if (a != b) weight *= (t[rows[i]] - t[b]) / (t[a] - t[b]);
      }
      value -= weight * x.row(a);
      variance += weight * weight;
    }
    for (const double r : value) residuals.push_back(std::abs(r) / std::sqrt(variance));
  }
  constexpr double kMedianOfNormal = 0.6744897501960817;
  return residuals.empty() ? 0 : Median(residuals) / kMedianOfNormal;
}

double ChooseCutoff(double noise, double rate) {
  // 5 Hz at 1 mm and 23 Hz, one less for each doubling of the noise (spring-model note, section 7).
  const double effective = std::max(noise, 1e-6) * std::sqrt(23 / rate);
  const double cutoff = 5 - std::log2(effective / 1e-3);
  return std::min(std::clamp(cutoff, 2.5, 12.0), rate / 3);
}

MatrixXd FiltFilt(const MatrixXd& x, double dt, double cutoff) {
  ThrowUnless(dt > 0 && cutoff > 0 && cutoff < 0.5 / dt,
              "low-pass: cutoff is {} Hz, must be between 0 and half the rate of {} Hz", cutoff,
              1 / dt);
  ThrowUnless(x.rows() >= 2, "low-pass: {} samples, at least 2 are needed", x.rows());
  // Bilinear transform of the Butterworth prototype.
  const double c = 1 / std::tan(0.5 * kTwoPi * cutoff * dt);
  const double a0 = 1 + std::sqrt(2.0) * c + c * c;
  const double b0 = 1 / a0, b1 = 2 * b0, a1 = 2 * (1 - c * c) / a0;
  const double a2 = (1 - std::sqrt(2.0) * c + c * c) / a0;
  // The padding lets the start-up die out.
  const auto settle = static_cast<Index>(std::ceil(3.0 / (cutoff * dt)));
  const Index pad = std::min(x.rows() - 1, std::max<Index>(9, settle));
  const Index n = x.rows() + 2 * pad;
  MatrixXd out(x.rows(), x.cols());
  VectorXd y(n);
  for (Index column = 0; column < x.cols(); ++column) {
    for (Index i = 0; i < n; ++i) {
      const Index k = i - pad, last = x.rows() - 1;
      if (k < 0) {
        y[i] = 2 * x(0, column) - x(-k, column);
      } else if (k > last) {
        y[i] = 2 * x(last, column) - x(2 * last - k, column);
      } else {
        y[i] = x(k, column);
      }
    }
    for (int pass = 0; pass < 2; ++pass) {
      // State of the filter at rest with the first value as input.
      double z1 = y[0] * (1 - b0), z2 = y[0] * (b0 - a2);
      for (Index i = 0; i < n; ++i) {
        const double input = y[i];
        y[i] = b0 * input + z1;
        z1 = b1 * input - a1 * y[i] + z2;
        z2 = b0 * input - a2 * y[i];
      }
      y.reverseInPlace();
    }
    out.col(column) = y.segment(pad, x.rows());
  }
  return out;
}

std::vector<Eigen::Vector3d> SmoothEvenly(const std::vector<Eigen::Vector3d>& x, double dt,
                                          double noise, double rate) {
  const auto n = static_cast<Index>(x.size());
  ThrowUnless(dt > 0, "smoothing: step is {} s, must be positive", dt);
  MatrixXd samples(n, 3);
  VectorXd t(n);
  for (Index i = 0; i < n; ++i) {
    samples.row(i) = x[static_cast<std::size_t>(i)].transpose();
    t[i] = static_cast<double>(i) * dt;
  }
  const double cutoff = ChooseCutoff(noise, rate > 0 ? rate : 1 / dt);
  const MotionSamples smooth = SmoothSamples(t, samples, cutoff, t);
  std::vector<Eigen::Vector3d> out(x.size());
  for (Index i = 0; i < n; ++i) out[static_cast<std::size_t>(i)] = smooth.x.row(i).transpose();
  return out;
}

MotionSamples DifferentiateSamples(const VectorXd& t, const MatrixXd& x) {
  const std::vector<Index> rows = UsableRows(t, x);
  ThrowUnless(rows.size() >= 5 && static_cast<Index>(rows.size()) == t.size(),
              "derivatives: {} usable samples of {}, at least 5 and no gaps are needed",
              rows.size(), t.size());
  MotionSamples out;
  out.t = t;
  out.x = x;
  out.v.resize(x.rows(), x.cols());
  out.a.resize(x.rows(), x.cols());
  for (Index i = 0; i < t.size(); ++i) {
    const Index first = std::clamp<Index>(i - 2, 0, t.size() - 5);
    const double scale = 0.25 * (t[first + 4] - t[first]);
    Eigen::Matrix<double, 5, 4> powers;
    for (Index k = 0; k < 5; ++k) {
      const double s = (t[first + k] - t[i]) / scale;
      powers.row(k) << 1, s, s * s, s * s * s;
    }
    const MatrixXd fit = powers.householderQr().solve(x.middleRows(first, 5));
    out.v.row(i) = fit.row(1) / scale;
    out.a.row(i) = 2 * fit.row(2) / (scale * scale);
  }
  return out;
}

}  // namespace springgrasp
