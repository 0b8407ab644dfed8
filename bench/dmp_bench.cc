// Rollout of a six-dimensional movement primitive with 50 bases against a straightforward loop.
#include <benchmark/benchmark.h>

#include <chrono>
#include <cmath>

#include "base/random.h"
#include "motion/dmp.h"

namespace springgrasp {
namespace {

using Clock = std::chrono::steady_clock;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Dmp RandomDmp() {
  RandomEngine engine = MakeStream(1, 0, "dmp_bench");
  VectorXd x0(6), g(6);
  for (double& x : x0) x = Uniform(engine, -0.3, 0.3);
  for (double& x : g) x = Uniform(engine, -0.3, 0.3);
  Dmp dmp = MakeDmp(x0, g, {.num_basis = 50});
  for (double& w : dmp.weights.reshaped()) w = Uniform(engine, -1, 1);
  return dmp;
}

// Eq. (10)-(13) written down as they stand: every dimension by itself, Eq. (12) at every
// evaluation.
MatrixXd Straightforward(const Dmp& dmp, double duration, double dt) {
  const auto rows = static_cast<Index>(std::floor(duration / dt + 1e-9)) + 1;
  MatrixXd out(rows, dmp.dimension());
  for (Index c = 0; c < dmp.dimension(); ++c) {
    const auto forcing = [&](double s) {
      double above = 0, below = 0;
      for (Index i = 0; i < dmp.centers.size(); ++i) {
        const double d = s - dmp.centers[i];
        const double psi = std::exp(-dmp.widths[i] * d * d);
        above += dmp.weights(i, c) * psi;
        below += psi;
      }
      return s * above / below;
    };
    const auto slope = [&](double x, double v, double s) {
      return (dmp.K * (dmp.g[c] - x) - dmp.D * v - dmp.K * (dmp.g[c] - dmp.x0[c]) * s +
              dmp.K * forcing(s)) /
             dmp.tau;
    };
    const int per_row = static_cast<int>(std::ceil(dt / (kDmpStep * dmp.tau) - 1e-9));
    const double h = dt / per_row;
    double x = dmp.x0[c], v = 0, t = 0;
    out(0, c) = x;
    for (Index row = 1; row < rows; ++row) {
      for (int n = 0; n < per_row; ++n, t += h) {
        const auto s = [&](double at) { return std::exp(-dmp.alpha * at / dmp.tau); };
        const double x1 = v / dmp.tau, v1 = slope(x, v, s(t));
        const double x2 = (v + 0.5 * h * v1) / dmp.tau;
        const double v2 = slope(x + 0.5 * h * x1, v + 0.5 * h * v1, s(t + 0.5 * h));
        const double x3 = (v + 0.5 * h * v2) / dmp.tau;
        const double v3 = slope(x + 0.5 * h * x2, v + 0.5 * h * v2, s(t + 0.5 * h));
        const double x4 = (v + h * v3) / dmp.tau, v4 = slope(x + h * x3, v + h * v3, s(t + h));
        x += h / 6 * (x1 + 2 * x2 + 2 * x3 + x4);
        v += h / 6 * (v1 + 2 * v2 + 2 * v3 + v4);
      }
      out(row, c) = x;
    }
  }
  return out;
}

template <typename F>
double Seconds(F&& run) {
  const auto start = Clock::now();
  run();
  return std::chrono::duration<double>(Clock::now() - start).count();
}

void RatioToAStraightforwardLoop(benchmark::State& state) {
  const Dmp dmp = RandomDmp();
  double ours = 0, plain = 0;
  for (auto _ : state) {
    ours += Seconds([&] { benchmark::DoNotOptimize(RolloutDmp(dmp, 1.0, 0.01)); });
    plain += Seconds([&] { benchmark::DoNotOptimize(Straightforward(dmp, 1.0, 0.01)); });
  }
  const auto n = static_cast<double>(state.iterations());
  state.counters["ours_ms"] = 1e3 * ours / n;
  state.counters["loop_ms"] = 1e3 * plain / n;
  state.counters["ratio"] = plain / ours;
  state.counters["difference"] =
      (RolloutDmp(dmp, 1.0, 0.01).x - Straightforward(dmp, 1.0, 0.01)).cwiseAbs().maxCoeff();
}
BENCHMARK(RatioToAStraightforwardLoop)->Unit(benchmark::kMillisecond)->MinTime(2);

}  // namespace
}  // namespace springgrasp
