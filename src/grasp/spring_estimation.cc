#include "grasp/spring_estimation.h"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/fingers.h"
#include "grasp/spring_trajectory_fit.h"
#include "kinematics/levenberg_marquardt.h"
#include "motion/smoothing.h"

namespace springgrasp {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

MatrixXd PointsOf(const RowVectorXd& row, int dim) {
  return Eigen::Map<const MatrixXd>(row.data(), dim, row.size() / dim);
}

// --- Input -----------------------------------------------------------------------------------

void CheckObservations(const std::vector<SpringObservation>& observations) {
  ThrowUnless(!observations.empty(), "spring estimation: no observation");
  const SpringSystem& first = observations[0].system;
  ThrowUnless(!first.springs.empty(), "spring estimation: the system has no springs");
  for (const SpringObservation& o : observations) {
    CheckSpringSystem(o.system);
    bool same = o.system.springs.size() == first.springs.size() &&
                o.system.num_fingers() == first.num_fingers() && o.system.dim == first.dim;
    for (std::size_t e = 0; same && e < first.springs.size(); ++e) {
      same = o.system.springs[e].i == first.springs[e].i &&
             o.system.springs[e].j == first.springs[e].j;
    }
    ThrowUnless(same, "spring estimation: observations differ in fingers, dimension or springs");
    const Index m = o.t.size(), n = o.system.num_coordinates();
    const auto fits = [&](const MatrixXd& x) {
      return x.size() == 0 || (x.rows() == m && x.cols() == n);
    };
    ThrowUnless(
        m >= 4 && o.p.rows() == m && o.p.cols() == n && fits(o.p_smooth) && fits(o.v) && fits(o.a),
        "spring estimation: {} times, positions {}x{}; expected at least 4 times and {} "
        "columns",
        m, o.p.rows(), o.p.cols(), n);
    for (Index i = 1; i < m; ++i) {
      ThrowUnless(o.t[i] > o.t[i - 1], "spring estimation: times must increase; {} follows {}",
                  o.t[i], o.t[i - 1]);
    }
  }
}

// Fills in smoothed states where the caller gave none.
void Smooth(SpringObservation& o, double noise) {
  if (o.v.size() > 0 && o.a.size() > 0) {
    if (o.p_smooth.size() == 0) o.p_smooth = o.p;
    return;
  }
  const int dim = o.system.dim;
  o.p_smooth.resize(o.p.rows(), o.p.cols());
  o.v = o.a = o.p_smooth;
  const double rate = static_cast<double>(o.t.size() - 1) / (o.t[o.t.size() - 1] - o.t[0]);
  for (int i = 0; i < o.system.num_fingers(); ++i) {
    const MatrixXd x = o.p.middleCols(dim * i, dim);
    Index seen = 0;
    for (Index k = 0; k < x.rows(); ++k) seen += x.row(k).allFinite() ? 1 : 0;
    ThrowUnless(seen >= 4,
                "spring estimation: finger {} was seen in {} samples, at least 4 are needed; leave "
                "it out of the system",
                i, seen);
    const double deviation = noise > 0 ? noise : EstimateNoise(o.t, x);
    const MotionSamples smooth = SmoothSamples(o.t, x, ChooseCutoff(deviation, rate), o.t);
    o.p_smooth.middleCols(dim * i, dim) = smooth.x;
    o.v.middleCols(dim * i, dim) = smooth.v;
    o.a.middleCols(dim * i, dim) = smooth.a;
  }
}

// --- Eq. (8)-(9) ---------------------------------------------------------------------------------

// Whether the rows of finger i use only states that are known in this frame.
std::vector<bool> UsableFingers(const SpringSystem& system, const RowVectorXd& states) {
  const int N = system.num_fingers();
  std::vector<bool> known(static_cast<std::size_t>(N)), usable;
  for (int i = 0; i < N; ++i) {
    known[static_cast<std::size_t>(i)] = states.segment(system.dim * i, system.dim).allFinite();
  }
  usable = known;
  bool all_involved = true;
  for (std::size_t i = 0; i < known.size(); ++i) {
    all_involved = all_involved && (known[i] || !system.involved[i]);
  }
  for (std::size_t i = 1; i < known.size(); ++i) {
    // Eq. (4) needs every involved finger.
    if (system.involved[i] && !all_involved) usable[i] = false;
  }
  for (const Spring& spring : system.springs) {
    const auto i = static_cast<std::size_t>(spring.i), j = static_cast<std::size_t>(spring.j);
    if (!known[i] || !known[j]) usable[i] = usable[j] = false;
  }
  return usable;
}

void StackRows(const std::vector<SpringObservation>& observations, double trim, MatrixXd& X,
               VectorXd& b) {
  const SpringSystem& first = observations[0].system;
  const int dim = first.dim, n = first.num_coordinates();
  Index capacity = 0, used = 0;
  for (const SpringObservation& o : observations) capacity += o.t.size() * n;
  X.resize(capacity, static_cast<Index>(first.springs.size()));
  b.resize(capacity);
  MatrixXd X_frame(n, X.cols());
  VectorXd f(first.num_fingers());
  VectorXd b_frame(n);
  SpringTerms terms;
  for (const SpringObservation& o : observations) {
    const double begin = o.t[0] + trim, end = o.t[o.t.size() - 1] - trim;
    for (Index k = 0; k < o.t.size(); ++k) {
      if (o.t[k] < begin || o.t[k] > end) continue;
      const RowVectorXd sum = o.p_smooth.row(k) + o.v.row(k) + o.a.row(k);
      const std::vector<bool> usable = UsableFingers(o.system, sum);
      const auto finite = [](const RowVectorXd& row) {
        return row.unaryExpr([](double x) { return std::isfinite(x) ? x : 0.0; }).eval();
      };
      EvaluateCentralForces(o.force, o.t[k], f);
      RegressionRows(o.system, PointsOf(finite(o.p_smooth.row(k)), dim),
                     PointsOf(finite(o.v.row(k)), dim), PointsOf(finite(o.a.row(k)), dim), f, terms,
                     X_frame, b_frame);
      for (int i = 0; i < o.system.num_fingers(); ++i) {
        if (!usable[static_cast<std::size_t>(i)]) continue;
        X.middleRows(used, dim) = X_frame.middleRows(dim * i, dim);
        b.segment(used, dim) = b_frame.segment(dim * i, dim);
        used += dim;
      }
    }
  }
  X.conservativeResize(used, Eigen::NoChange);
  b.conservativeResize(used);
  ThrowUnless(X.rows() >= X.cols(), "spring estimation: {} usable rows for {} constants", X.rows(),
              X.cols());
}

// Standard errors of k from the Jacobian, and its condition with columns scaled to norm 1.
void Uncertainty(const MatrixXd& J, double noise, Index springs, SpringEstimate& estimate) {
  VectorXd scale = J.colwise().norm();
  const double largest = scale.maxCoeff();
  for (double& value : scale) value = value > 1e-12 * largest ? value : kInfinity;
  const VectorXd inverse = scale.cwiseInverse();
  const Eigen::BDCSVD<MatrixXd> svd(J * inverse.asDiagonal(), Eigen::ComputeThinV);
  const VectorXd& sigma = svd.singularValues();
  const double smallest = sigma[sigma.size() - 1];
  estimate.condition_number = smallest > 1e-12 * sigma[0] ? sigma[0] / smallest : kInfinity;
  estimate.standard_error.resize(springs);
  for (Index e = 0; e < springs; ++e) {
    double variance = 0;
    for (Index i = 0; i < sigma.size(); ++i) {
      const double part = svd.matrixV()(e, i) * inverse[e];
      if (part != 0)
        variance += sigma[i] > 1e-12 * sigma[0] ? part * part / (sigma[i] * sigma[i]) : kInfinity;
    }
    estimate.standard_error[e] = inverse[e] == 0 ? kInfinity : noise * std::sqrt(variance);
  }
}

std::string FingerName(int finger, int num_fingers) {
  return num_fingers == kNumFingers ? std::string(kFingerNames[static_cast<std::size_t>(finger)])
                                    : fmt::format("finger {}", finger);
}

void Remark(const SpringSystem& system, SpringEstimate& estimate) {
  for (std::size_t e = 0; e < system.springs.size(); ++e) {
    const double k = estimate.k[static_cast<Index>(e)];
    const double error = estimate.standard_error[static_cast<Index>(e)];
    const std::string name = FingerName(system.springs[e].i, system.num_fingers()) + "-" +
                             FingerName(system.springs[e].j, system.num_fingers());
    std::string remark = RemarkOnSpring(name, k, error);
    if (!remark.empty()) estimate.remarks.push_back(std::move(remark));
  }
}

std::vector<VectorXd> FingerErrors(const std::vector<SpringObservation>& observations,
                                   const std::vector<SpringTrajectory>& reproduced) {
  std::vector<VectorXd> out;
  for (std::size_t k = 0; k < reproduced.size(); ++k) {
    const SpringObservation& o = observations[k];
    VectorXd rmse(o.system.num_fingers());
    for (int i = 0; i < o.system.num_fingers(); ++i) {
      double sum = 0;
      Index count = 0;
      for (Index s = 0; s < o.t.size(); ++s) {
        const RowVectorXd error =
            (reproduced[k].p - o.p).row(s).segment(o.system.dim * i, o.system.dim);
        if (!error.allFinite()) continue;
        sum += error.squaredNorm();
        ++count;
      }
      rmse[i] = count > 0 ? std::sqrt(sum / static_cast<double>(count)) : kNaN;
    }
    out.push_back(rmse);
  }
  return out;
}

}  // namespace

std::string RemarkOnSpring(std::string_view name, double k, double standard_error) {
  if (!std::isfinite(standard_error)) {
    return fmt::format(
        "The data cannot determine the spring {}: its change of length shows in no sample.", name);
  }
  if (standard_error < k) return {};
  return fmt::format(
      "The data cannot determine the spring {}: {:.3g} N/m with a standard error of {:.3g} N/m.",
      name, k, standard_error);
}

SpringSystem WithEstimate(const SpringSystem& system, const SpringEstimate& estimate) {
  SpringSystem out = system;
  for (std::size_t e = 0; e < out.springs.size(); ++e) {
    out.springs[e].k = estimate.k[static_cast<Index>(e)];
    out.springs[e].d *= estimate.damping_factor;
  }
  out.kc *= estimate.kc_factor;
  out.dc *= estimate.dc_factor;
  return out;
}

CentralForce WithEstimate(const CentralForce& force, const SpringEstimate& estimate) {
  CentralForce out = force;
  if (estimate.fitted.gamma) out.gamma = estimate.gamma;
  if (estimate.fitted.beta) out.beta = estimate.beta;
  if (estimate.fitted.delay) out.delay = estimate.delay;
  if (estimate.fitted.t_switch) out.t_switch = estimate.t_switch;
  return out;
}

SpringEstimate EstimateSprings(const std::vector<SpringObservation>& given,
                               const EstimationOptions& options) {
  CheckObservations(given);
  std::vector<SpringObservation> observations = given;
  for (SpringObservation& o : observations) {
    Smooth(o, options.noise);
    // A sharp switch has no derivative by its time.
    if (options.fit.t_switch && options.trajectory_fit && o.force.blend <= 0) {
      o.force.blend = 0.05 * o.force.T;
    }
  }
  SpringEstimate estimate;
  const CentralForce& force = observations[0].force;
  estimate.gamma = force.gamma;
  estimate.beta = force.beta;
  estimate.delay = force.delay;
  estimate.t_switch = force.t_switch;

  MatrixXd X;
  VectorXd b;
  StackRows(observations, options.trim, X, b);
  estimate.linear = SolveRegression(X, b, options.rcond);
  estimate.k = estimate.linear.k;
  estimate.standard_error = estimate.linear.standard_error;
  estimate.condition_number = estimate.linear.condition_number;
  estimate.k_non_negative = SolveNonNegative(X, b);
  if (options.non_negative) estimate.k = estimate.k_non_negative;

  EstimationOptions fit_options = options;
  if (!options.trajectory_fit) fit_options.fit = {};
  estimate.fitted = fit_options.fit;
  const SpringEstimate initial = estimate;
  const TrajectoryFit fit(observations, fit_options, initial);
  VectorXd x = fit.Start();
  if (!options.non_negative && !options.trajectory_fit) x.head(fit.num_springs()) = estimate.k;
  if (options.trajectory_fit) {
    ThrowUnless(fit.num_measured() > fit.num_unknowns(),
                "spring estimation: {} measured coordinates for {} unknowns", fit.num_measured(),
                fit.num_unknowns());
    LeastSquaresProblem problem;
    problem.num_residuals = static_cast<int>(fit.num_residuals());
    problem.evaluate = [&](const VectorXd& at, VectorXd& r, MatrixXd* J) {
      fit.Evaluate(at, r, J);
    };
    fit.Bounds(problem.lower, problem.upper);
    LevenbergMarquardtOptions solver;
    solver.max_iterations = options.max_iterations;
    solver.gradient_tolerance = 1e-11;
    solver.step_tolerance = 1e-9;
    const LevenbergMarquardtResult result = MinimizeLeastSquares(problem, x, solver);
    x = result.x;
    estimate = fit.At(x);
    estimate.converged = result.converged;
    estimate.iterations = result.iterations;
    VectorXd r(fit.num_residuals());
    MatrixXd J(fit.num_residuals(), fit.num_unknowns());
    fit.Evaluate(x, r, &J);
    const double freedom = static_cast<double>(fit.num_measured() - fit.num_unknowns());
    estimate.noise = options.noise > 0
                         ? options.noise
                         : std::sqrt(r.head(fit.num_measured()).squaredNorm() / freedom);
    Uncertainty(J, estimate.noise, fit.num_springs(), estimate);
  }
  for (std::size_t i = 0; options.reproduce && i < observations.size(); ++i) {
    auto trajectory = fit.Simulate(x, i, nullptr);
    if (!trajectory) {
      estimate.converged = false;
      SpringTrajectory none;
      none.t = observations[i].t;
      none.p = none.v = MatrixXd::Constant(none.t.size(), observations[i].p.cols(), kNaN);
      trajectory = none;
    }
    estimate.reproduced.push_back(*trajectory);
  }
  estimate.finger_rmse = FingerErrors(observations, estimate.reproduced);
  Remark(observations[0].system, estimate);
  return estimate;
}

}  // namespace springgrasp
