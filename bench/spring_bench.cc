// Springs against Boost.Odeint's implicit solver at equal accuracy, and what learning costs.
#include <benchmark/benchmark.h>

#include <ctime>

#include "grasp/spring_estimation.h"
#include "grasp/spring_integrator.h"
#include "grasp/spring_online.h"
#include "grasp/spring_test_systems.h"
#include "rosenbrock4.h"

namespace springgrasp {
namespace {

using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kAccuracy = 1e-7;   // m
constexpr double kTolerance = 1e-9;  // m/s, of our Newton
constexpr int kDim = 3;

// Eq. (7) of a straight minimum-jerk reach of 0.3 m in 1 s: smooth, so that the order of both
// integrators counts and not how they step over the corners of a table.
double SmoothForce(double t) { return -0.04 * 0.3 * (60 * t - 180 * t * t + 120 * t * t * t); }

// The power grasp of the tests in 3-D, force shared as profile human does.
SpringSystem PowerGrasp() {
  SpringSystem system = GraspSystem(true, kDim);
  system.ratio = ForceRatio::kBalanced;
  return system;
}

// One second of it.
struct Case {
  SpringSystem system = PowerGrasp();
  MatrixXd p0 = GraspStart(kDim), v0 = MatrixXd::Zero(kDim, 5);
  ForceProfile force = {&SmoothForce, {}};
  VectorXd times = EvenTimes(1.0, 0.5);
};

MatrixXd Ours(const Case& c, const SpringIntegration& options) {
  return IntegrateSprings(c.system, c.force, c.p0, c.v0, c.times, options)->p;
}

// By Odeint, in rosenbrock4.cc.
MatrixXd Rosenbrock(const Case& c, double tolerance) {
  return IntegrateByRosenbrock4(c.system, c.force, c.p0, c.v0, c.times, tolerance);
}

// Of this thread's processor: other processes on the machine do not count.
double Now() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

template <typename F>
double Seconds(F&& run) {
  const double start = Now();
  run();
  return Now() - start;
}

// Both at the coarsest setting that keeps the accuracy, timed by turns.
void RatioToRosenbrock4(benchmark::State& state) {
  const Case c;
  const MatrixXd truth = Ours(c, {.step = 1e-4, .tolerance = 1e-14});
  const auto error = [&](const MatrixXd& p) { return (p - truth).cwiseAbs().maxCoeff(); };
  double step = 0.1;
  while (error(Ours(c, {.step = step, .tolerance = kTolerance})) > kAccuracy) step *= 0.97;
  double tolerance = 1e-3;
  while (error(Rosenbrock(c, tolerance)) > kAccuracy) tolerance *= 0.9;
  double ours = 0, rosenbrock = 0;
  for (auto _ : state) {
    ours += Seconds(
        [&] { benchmark::DoNotOptimize(Ours(c, {.step = step, .tolerance = kTolerance})); });
    rosenbrock += Seconds([&] { benchmark::DoNotOptimize(Rosenbrock(c, tolerance)); });
  }
  const auto n = static_cast<double>(state.iterations());
  state.counters["ours_ms"] = 1e3 * ours / n;
  state.counters["rosenbrock4_ms"] = 1e3 * rosenbrock / n;
  state.counters["ratio"] = rosenbrock / ours;
  state.counters["our_step_ms"] = 1e3 * step;
  state.counters["our_error_m"] = error(Ours(c, {.step = step, .tolerance = kTolerance}));
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
    benchmark::DoNotOptimize(EstimateSprings({o}, {.trajectory_fit = false, .reproduce = false}));
  }
}
BENCHMARK(SvdEstimation)->Unit(benchmark::kMillisecond);

void FullRecipe(benchmark::State& state) {
  const SpringObservation o = Demonstration();
  EstimationOptions options;
  options.fit.gamma = options.fit.beta = options.fit.delay = true;
  options.step = 0.02;
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
