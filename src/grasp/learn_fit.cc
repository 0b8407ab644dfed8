#include "grasp/learn_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "grasp/aperture.h"
#include "grasp/spring_estimation.h"
#include "motion/smoothing.h"

namespace springgrasp {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr int kMostRows = 60;        // measured instants used; more are thinned out
constexpr double kStiffness = 0.03;  // k/kc where nothing was observed, and where the fit starts
constexpr double kBystander = 0.4;   // weight of a finger that takes no part in the grasp
constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

// Where a fit starts. `reach` is gamma A / (m times the mean opening).
struct Start {
  double reach, delay, closing, t_switch;
};
constexpr Start kHumanStarts[] = {
    {40, 0.1, 0.6, 0.55}, {40, 0.02, 0.5, 0.65}, {40, 0.2, 1, 0.45}, {10, 0.2, 3, 0.7}};
constexpr Start kPaperStarts[] = {{40, 0, 1, 0.5}, {15, 0, 1, 0.5}, {5, 0, 1, 0.5}};
constexpr Start kUnforcedStarts[] = {{0, 0, 1, 0.5}};

double Between(double a, double b, double fraction) { return (1 - fraction) * a + fraction * b; }

// Rows of the trajectory fit: measured tips, the fingers resting while the start was completed, and
// the contacts held from T to 1.3 T.
SpringObservation MakeObservation(const FitProblem& problem, const std::vector<int>& fingers,
                                  const FingerRun& run) {
  SpringObservation out;
  out.system = MakeSystem(run, fingers);
  out.force = MakeRunForce(run, fingers, problem.acceleration, problem.dt);
  out.weight.resize(static_cast<Eigen::Index>(fingers.size()));
  for (std::size_t n = 0; n < fingers.size(); ++n) {
    out.weight[static_cast<Eigen::Index>(n)] = run.involved[fingers[n]] ? 1 : kBystander;
  }

  std::vector<double> t;
  std::vector<PerFinger<std::optional<Vector3d>>> p;
  PerFinger<std::optional<Vector3d>> row;
  const auto rest = [&](const Fingertips& tips, bool all) {
    for (const int i : fingers) {
      row[i].reset();
      if (all || run.involved[i]) row[i] = tips[i];
    }
  };
  rest(run.p_HF, true);
  do {
    t.push_back(0.04 * static_cast<double>(t.size()));
    p.push_back(row);
  } while (t.back() + 0.04 < problem.lead);
  const std::size_t every = problem.sample_t.size() / kMostRows + 1;
  for (std::size_t n = 0; n < problem.sample_t.size(); n += every) {
    if (problem.sample_t[n] < t.back() + 1e-6) continue;
    t.push_back(problem.sample_t[n]);
    p.push_back(problem.sample_p_HF[n]);
  }
  const std::size_t measured = t.size();
  rest(run.p_HC, false);
  const double step = 0.3 * run.T / std::max(5.0, 0.25 * static_cast<double>(measured));
  for (double held = run.T + step; held < 1.3 * run.T; held += step) {
    t.push_back(held);
    p.push_back(row);
  }

  const int dim = run.dim;
  const auto rows = static_cast<Eigen::Index>(t.size());
  const Eigen::Index columns = dim * static_cast<Eigen::Index>(fingers.size());
  out.t = VectorXd::Map(t.data(), rows);
  out.p = MatrixXd::Constant(rows, columns, kMissing);
  out.p_smooth = out.v = out.a = out.p;
  // Smoothed states of the regression.
  const auto even = static_cast<Eigen::Index>(problem.p_HF.size());
  MatrixXd x(even, columns);
  for (Eigen::Index n = 0; n < even; ++n) {
    x.row(n) = SystemPoints(run, fingers, problem.p_HF[static_cast<std::size_t>(n)]).reshaped();
  }
  const VectorXd even_t = VectorXd::LinSpaced(even, 0, static_cast<double>(even - 1) * problem.dt);
  const MotionSamples smooth = DifferentiateSamples(even_t, x);
  for (Eigen::Index n = 0; n < rows; ++n) {
    const auto& tips = p[static_cast<std::size_t>(n)];
    Fingertips known = run.p_HF;
    for (const int i : fingers) {
      if (tips[i]) known[i] = *tips[i];
    }
    const MatrixXd points = SystemPoints(run, fingers, known);
    const double position = std::min(out.t[n] / problem.dt, static_cast<double>(even - 1));
    const auto k = std::min(static_cast<Eigen::Index>(position), even - 2);
    const double fraction = position - static_cast<double>(k);
    const bool in_recording = out.t[n] >= problem.lead && static_cast<std::size_t>(n) < measured;
    for (std::size_t f = 0; f < fingers.size(); ++f) {
      if (!tips[fingers[f]]) continue;
      const auto column = static_cast<Eigen::Index>(f) * dim;
      out.p.row(n).segment(column, dim) = points.col(static_cast<Eigen::Index>(f)).transpose();
      if (!in_recording) continue;
      for (Eigen::Index c = column; c < column + dim; ++c) {
        out.p_smooth(n, c) = Between(smooth.x(k, c), smooth.x(k + 1, c), fraction);
        out.v(n, c) = Between(smooth.v(k, c), smooth.v(k + 1, c), fraction);
        out.a(n, c) = Between(smooth.a(k, c), smooth.a(k + 1, c), fraction);
      }
    }
  }
  // Where the fit of the start begins.
  out.p_smooth.row(0) = SystemPoints(run, fingers, run.p_HF).reshaped().transpose();
  out.v.row(0).setZero();
  return out;
}

// Edges between listed fingers, in the order in which MakeSystem keeps them.
std::vector<std::size_t> EdgesBetween(const FingerRun& run, const std::vector<int>& fingers) {
  std::vector<std::size_t> edges;
  const auto listed = [&](int i) {
    return std::find(fingers.begin(), fingers.end(), i) != fingers.end();
  };
  for (std::size_t e = 0; e < run.edges.size(); ++e) {
    if (listed(run.edges[e].first) && listed(run.edges[e].second)) edges.push_back(e);
  }
  return edges;
}

void Apply(const SpringEstimate& estimate, const std::vector<std::size_t>& edges, FingerRun& run) {
  SpringGains& gains = run.gains;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    gains.k[edges[e]] = std::max(0.0, estimate.k[static_cast<Eigen::Index>(e)]);
  }
  gains.gamma = estimate.gamma;
  gains.closing = estimate.beta;
  gains.delay = estimate.delay;
  run.t_switch = estimate.t_switch;
}

// Reproduction errors of a run against the smoothed track while it was measured; returns the RMS
// over all fingers, the distance of the involved tips from their contacts at T included.
double Reproduce(const FitProblem& problem, const FingerRun& run, FitResult& result) {
  const auto motion = SimulateFingers(run, problem.acceleration, problem.dt);
  if (!motion || problem.sample_t.empty()) return std::numeric_limits<double>::infinity();
  PerFinger<double> sum = {};
  double total = 0;
  double count = 0;
  const auto at = [&](const std::vector<Fingertips>& tips, double t, int i) -> Vector3d {
    const double position = t / problem.dt;
    const auto n = std::min(static_cast<std::size_t>(position), tips.size() - 2);
    const double fraction = std::min(1.0, position - static_cast<double>(n));
    return (1 - fraction) * tips[n][i] + fraction * tips[n + 1][i];
  };
  double aperture_sum = 0;
  int apertures = 0;
  for (std::size_t n = 0; n < problem.sample_t.size(); ++n) {
    bool whole = true;
    Fingertips made, seen;
    for (int i = 0; i < kNumFingers; ++i) {
      made[i] = at(motion->p_HF, problem.sample_t[n], i);
      seen[i] = at(problem.p_HF, problem.sample_t[n], i);
      whole = whole && (problem.sample_p_HF[n][i] || !run.involved[i] || !problem.observed[i]);
    }
    if (whole) {
      const double error = Aperture(made, run.involved) - Aperture(seen, run.involved);
      aperture_sum += error * error;
      ++apertures;
    }
    for (int i = 0; i < kNumFingers; ++i) {
      if (!problem.sample_p_HF[n][i]) continue;
      const double square = (made[i] - seen[i]).squaredNorm();
      sum[i] += square;
      ++result.samples[i];
      const double weight = run.involved[i] ? 1 : kBystander * kBystander;
      total += weight * square;
      count += weight;
    }
  }
  result.aperture_rmse = std::sqrt(aperture_sum / std::max(1, apertures));
  std::vector<Fingertips> reach = motion->p_HF;
  reach.resize(problem.p_HF.size());  // to T
  std::size_t widest = 0;
  for (std::size_t n = 0; n < reach.size(); ++n) {
    const double aperture = Aperture(reach[n], run.involved);
    if (aperture <= result.aperture) continue;
    result.aperture = aperture;
    widest = n;
  }
  result.aperture_time = WidestStep(reach, run.involved, widest) * problem.dt / run.T;
  const double weight = 0.1 * count;
  for (int i = 0; i < kNumFingers; ++i) {
    if (result.samples[i] > 0) result.rmse[i] = std::sqrt(sum[i] / result.samples[i]);
    if (!run.involved[i]) continue;
    const auto end = std::min(static_cast<std::size_t>(std::lround(run.T / problem.dt)),
                              motion->p_HF.size() - 1);
    total += weight * (motion->p_HF[end][i] - run.p_HC[i]).squaredNorm();
    count += weight;
  }
  return std::sqrt(total / std::max(1.0, count));
}

}  // namespace

GainRule RuleOf(bool human) {
  if (human) return {};
  return {.omega_T = 8, .zeta = 1.9, .damping = 0.07, .ambient = 0};  // the note's literal set
}

FitResult FitSprings(const FitProblem& problem) {
  std::vector<int> fingers;
  for (int i = 0; i < kNumFingers; ++i) {
    if (problem.observed[i]) fingers.push_back(i);
  }
  const std::vector<std::size_t> edges = EdgesBetween(problem.run, fingers);
  EstimationOptions options;
  options.fit.gamma = problem.forced;
  options.fit.beta = options.fit.delay = problem.human;
  options.fit.t_switch = problem.fit_switch;
  options.trim = 0.05;
  options.gain_prior = 1;
  options.max_iterations = 25;
  options.step = 0.01 * problem.run.T;
  // The hand rests at the start: a fitted velocity would move an over-damped tip by a jump.
  options.fit_start = false;

  double opening = 0;
  int involved = 0;
  for (int i = 0; i < kNumFingers; ++i) {
    if (!problem.run.involved[i]) continue;
    opening += problem.run.opening[i].norm();
    ++involved;
  }
  opening = opening > 0 ? opening / involved : problem.scales.x0;

  FitResult best;
  double best_error = std::numeric_limits<double>::infinity();
  const double enough = 0.002 + 0.5 * problem.noise;
  const std::vector<Start> starts =
      problem.human    ? std::vector(std::begin(kHumanStarts), std::end(kHumanStarts))
      : problem.forced ? std::vector(std::begin(kPaperStarts), std::end(kPaperStarts))
                       : std::vector(std::begin(kUnforcedStarts), std::end(kUnforcedStarts));
  for (const Start& start : starts) {
    if (best_error < enough) break;
    DimensionlessGains gains;
    gains.omega_T = problem.rule.omega_T;
    gains.zeta = problem.rule.zeta;
    gains.reach = start.reach * opening / problem.scales.x0;
    gains.delay = start.delay;
    gains.closing = start.closing;
    gains.holding = problem.human ? 0.5 : 0;
    gains.stiffness.assign(problem.run.edges.size(), kStiffness);
    gains.damping.assign(problem.run.edges.size(), problem.rule.damping);
    FingerRun run = problem.run;
    if (problem.fit_switch) run.t_switch = start.t_switch * run.T;
    run.gains = RestoreGains(gains, run.gains.mass, problem.scales);
    run.ambient_damping = problem.rule.ambient * run.gains.dc;

    const SpringEstimate estimate =
        EstimateSprings({MakeObservation(problem, fingers, run)}, options);
    Apply(estimate, edges, run);
    FitResult result;
    result.standard_errors.assign(run.edges.size(), 0.0);
    for (std::size_t e = 0; e < edges.size(); ++e) {
      // Infinite where the data say nothing.
      const double error = estimate.standard_error[static_cast<Eigen::Index>(e)];
      if (std::isfinite(error)) result.standard_errors[edges[e]] = error;
    }
    result.gains = MakeDimensionless(run.gains, problem.scales);
    result.t_switch = run.t_switch;
    // Infinite where a spring shows in no frame; then that of the trajectory fit says more.
    for (const double condition : {estimate.condition_number, estimate.linear.condition_number}) {
      if (std::isfinite(condition)) result.condition_number = condition;
    }
    const double error = Reproduce(problem, run, result);
    if (error < best_error) {
      best_error = error;
      best = result;
    }
  }
  ThrowUnless(std::isfinite(best_error),
              "the fingertip springs could not be fitted: the movement runs away");
  return best;
}

}  // namespace springgrasp
