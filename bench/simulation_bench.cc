// What a simulated second costs: bare mj_step, and the same through Simulation with its checks.
#include <benchmark/benchmark.h>

#include "base/files.h"
#include "sim/scene_builder.h"
#include "sim/simulation.h"

namespace springgrasp {
namespace {

ModelPtr PowerScene() {
  return BuildModel(ReadScene(SourceFolder() + "/scenes/power_cylinder.yaml"));
}

void BareSteps(benchmark::State& state) {
  const ModelPtr model = PowerScene();
  const DataPtr data = MakeData(*model);
  for (auto _ : state) mj_step(model.get(), data.get());
  state.counters["simulated_per_real"] = benchmark::Counter(
      static_cast<double>(state.iterations()) * model->opt.timestep, benchmark::Counter::kIsRate);
}
BENCHMARK(BareSteps);

void SimulationSteps(benchmark::State& state) {
  Simulation simulation(PowerScene());
  for (auto _ : state) simulation.Step();
  state.counters["simulated_per_real"] = benchmark::Counter(
      static_cast<double>(state.iterations()) * simulation.timestep(), benchmark::Counter::kIsRate);
}
BENCHMARK(SimulationSteps);

}  // namespace
}  // namespace springgrasp
