// Springs against Boost.Odeint's implicit solver at equal accuracy, and what learning costs.
#include <benchmark/benchmark.h>

#include <boost/numeric/odeint.hpp>
#include <chrono>

#include "grasp/spring_estimation.h"
#include "grasp/spring_integrator.h"
#include "grasp/spring_online.h"
#include "grasp/spring_test_systems.h"

namespace springgrasp {
namespace {

using Clock = std::chrono::steady_clock;
using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;
namespace odeint = boost::numeric::odeint;
using UblasVector = boost::numeric::ublas::vector<double>;
using UblasMatrix = boost::numeric::ublas::matrix<double>;

constexpr double kAccuracy = 1e-7;  // m
constexpr int kDim = 3;
constexpr int kCoordinates = 15;

// One second of the power grasp of the tests in 3-D.
struct Case {
  SpringSystem system = GraspSystem(true, kDim);
  MatrixXd p0 = GraspStart(kDim), v0 = MatrixXd::Zero(kDim, 5);
  ForceProfile force = MakeForceProfile(ReachForce(0.04, 0.01));
  VectorXd times = EvenTimes(1.0, 0.1);
};

MatrixXd Ours(const Case& c, double step) {
  SpringIntegration options;
  options.step = step;
  return IntegrateSprings(c.system, c.force, c.p0, c.v0, c.times, options)->p;
}

// The same equations for Odeint: state (p, v), with the analytic Jacobian.
struct System {
  const Case& c;
  mutable SpringTerms terms;
  mutable MatrixXd p = MatrixXd::Zero(kDim, 5), v = p, Jp, Jv;

  void Load(const UblasVector& x) const {
    for (int i = 0; i < kCoordinates; ++i) {
      p.data()[i] = x[i];
      v.data()[i] = x[i + kCoordinates];
    }
  }
  void operator()(const UblasVector& x, UblasVector& dxdt, double t) const {
    Load(x);
    EvaluateSprings(c.system, p, v, c.force.f(t), terms);
    for (int i = 0; i < kCoordinates; ++i) {
      dxdt[i] = v.data()[i];
      dxdt[i + kCoordinates] = terms.acc.data()[i];
    }
  }
  void operator()(const UblasVector& x, UblasMatrix& J, double t, UblasVector& dfdt) const {
    Load(x);
    const double f = c.force.f(t);
    EvaluateSprings(c.system, p, v, f, terms);
    SpringJacobian(c.system, p, v, f, terms, Jp, Jv);
    J = boost::numeric::ublas::zero_matrix<double>(2 * kCoordinates, 2 * kCoordinates);
    for (int i = 0; i < kCoordinates; ++i) {
      J(i, i + kCoordinates) = 1;
      for (int j = 0; j < kCoordinates; ++j) {
        J(i + kCoordinates, j) = Jp(i, j);
        J(i + kCoordinates, j + kCoordinates) = Jv(i, j);
      }
    }
    // By time only the force changes.
    constexpr double kStep = 1e-6;
    const MatrixXd before = terms.acc;
    EvaluateSprings(c.system, p, v, c.force.f(t + kStep), terms);
    for (int i = 0; i < kCoordinates; ++i) {
      dfdt[i] = 0;
      dfdt[i + kCoordinates] = (terms.acc.data()[i] - before.data()[i]) / kStep;
    }
  }
};

MatrixXd Rosenbrock(const Case& c, double tolerance) {
  const System system{c, {}};
  UblasVector x(2 * kCoordinates);
  for (int i = 0; i < kCoordinates; ++i) {
    x[i] = c.p0.data()[i];
    x[i + kCoordinates] = 0;
  }
  MatrixXd out(c.times.size(), kCoordinates);
  for (Index n = 0; n < c.times.size(); ++n) {
    double t = n == 0 ? 0 : c.times[n - 1];
    while (t < c.times[n]) {
      // Restarted at the kinks of the force, as ours.
      const auto kink = std::upper_bound(c.force.kinks.begin(), c.force.kinks.end(), t + 1e-12);
      const double stop = kink == c.force.kinks.end() ? c.times[n] : std::min(*kink, c.times[n]);
      auto stepper = odeint::make_controlled<odeint::rosenbrock4<double>>(tolerance, tolerance);
      odeint::integrate_adaptive(stepper, std::make_pair(std::cref(system), std::cref(system)), x,
                                 t, stop, std::min(0.01, stop - t));
      t = stop;
    }
    for (int i = 0; i < kCoordinates; ++i) out(n, i) = x[i];
  }
  return out;
}

template <typename F>
double Seconds(F&& run) {
  const auto start = Clock::now();
  run();
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Both at the coarsest setting that keeps the accuracy, timed by turns.
void RatioToRosenbrock4(benchmark::State& state) {
  const Case c;
  const MatrixXd truth = Ours(c, 1e-4);
  const auto error = [&](const MatrixXd& p) { return (p - truth).cwiseAbs().maxCoeff(); };
  double step = 0.02;
  while (error(Ours(c, step)) > kAccuracy) step *= 0.9;
  double tolerance = 1e-3;
  while (error(Rosenbrock(c, tolerance)) > kAccuracy) tolerance *= 0.7;
  double ours = 0, rosenbrock = 0;
  for (auto _ : state) {
    ours += Seconds([&] { benchmark::DoNotOptimize(Ours(c, step)); });
    rosenbrock += Seconds([&] { benchmark::DoNotOptimize(Rosenbrock(c, tolerance)); });
  }
  const auto n = static_cast<double>(state.iterations());
  state.counters["ours_ms"] = 1e3 * ours / n;
  state.counters["rosenbrock4_ms"] = 1e3 * rosenbrock / n;
  state.counters["ratio"] = rosenbrock / ours;
  state.counters["our_step_ms"] = 1e3 * step;
  state.counters["our_error_m"] = error(Ours(c, step));
  state.counters["rosenbrock4_error_m"] = error(Rosenbrock(c, tolerance));
}
BENCHMARK(RatioToRosenbrock4)->Unit(benchmark::kMillisecond)->MinTime(2);

// A 3 s demonstration at 30 Hz with 1 mm noise.
SpringObservation Demonstration() {
  const Case c;
  SpringObservation o;
  o.system = c.system;
  o.force = ReachForce(0.04, 0.01);
  o.t = EvenTimes(3.0, 1.0 / 30);
  o.p = IntegrateSprings(c.system, c.force, c.p0, c.v0, o.t)->p;
  RandomEngine engine = MakeStream(1, 0, "spring_bench");
  for (double& x : o.p.reshaped()) x += 0.001 * Normal(engine);
  return o;
}

void SvdEstimation(benchmark::State& state) {
  const SpringObservation o = Demonstration();
  for (auto _ : state) {
    benchmark::DoNotOptimize(EstimateSprings({o}, {.trajectory_fit = false}));
  }
}
BENCHMARK(SvdEstimation)->Unit(benchmark::kMillisecond);

void FullRecipe(benchmark::State& state) {
  const SpringObservation o = Demonstration();
  EstimationOptions options;
  options.fit.gamma = options.fit.beta = options.fit.delay = true;
  options.step = 0.01;
  for (auto _ : state) benchmark::DoNotOptimize(EstimateSprings({o}, options));
}
BENCHMARK(FullRecipe)->Unit(benchmark::kMillisecond);

// One frame in, and all constants solved for.
void OnlineUpdate(benchmark::State& state) {
  const SpringObservation o = Demonstration();
  OnlineEstimation online(o.system);
  double t = 0;
  Index i = 0;
  for (auto _ : state) {
    const Eigen::RowVectorXd p = o.p.row(i);
    online.AddFrame(t, Map<const MatrixXd>(p.data(), kDim, 5), 0.0);
    if (online.regression().rows() > 0) {
      benchmark::DoNotOptimize(online.regression().Solve());
    }
    t += 1.0 / 30;
    i = (i + 1) % o.t.size();
  }
}
BENCHMARK(OnlineUpdate)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace springgrasp
