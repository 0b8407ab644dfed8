// What a simulated second costs: bare mj_step, the same through Simulation with its checks, and
// the grasp variant (right arm and hand move, the rest is fixed) against the whole robot.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <string>
#include <vector>

#include "base/files.h"
#include "sim/model_index.h"
#include "sim/scene_builder.h"
#include "sim/simulation.h"

namespace springgrasp {
namespace {

Scene PowerScene() { return ReadScene(SourceFolder() + "/scenes/power_cylinder.yaml"); }

void CountSteps(benchmark::State& state, double timestep) {
  const auto steps = static_cast<double>(state.iterations());
  state.counters["steps_per_s"] = benchmark::Counter(steps, benchmark::Counter::kIsRate);
  state.counters["simulated_per_real"] =
      benchmark::Counter(steps * timestep, benchmark::Counter::kIsRate);
}

void BareSteps(benchmark::State& state) {
  const ModelPtr model = BuildModel(PowerScene());
  const DataPtr data = MakeData(*model);
  for (auto _ : state) mj_step(model.get(), data.get());
  CountSteps(state, model->opt.timestep);
}
BENCHMARK(BareSteps);

void SimulationSteps(benchmark::State& state) {
  Simulation simulation(BuildModel(PowerScene()));
  for (auto _ : state) simulation.Step();
  CountSteps(state, simulation.timestep());
}
BENCHMARK(SimulationSteps);

// Robot, table and object; joints held by strong damping, so that every step sees the same scene.
void Steps(benchmark::State& state, const std::vector<std::string>& active, bool contacts,
           bool looks = false) {
  Scene scene = PowerScene();
  scene.active = active;
  scene.physics.noslip_iterations = 0;
  BuildOptions options;
  options.with_looks = looks;
  const ModelPtr model = BuildModel(scene, options);
  for (int i = 0; i < model->nv; ++i) {
    if (model->jnt_type[model->dof_jntid[i]] != mjJNT_FREE) model->dof_damping[i] += 1e4;
  }
  if (!contacts) {
    model->opt.disableflags |= mjDSBL_CONTACT;
    std::fill_n(model->opt.gravity, 3, 0.0);  // the object would fall
  }
  const DataPtr data = MakeData(*model);
  mj_resetDataKeyframe(model.get(), data.get(), IdOf(*model, mjOBJ_KEY, "start"));
  for (auto _ : state) mj_step(model.get(), data.get());
  CountSteps(state, model->opt.timestep);
  state.counters["dof"] = model->nv;
  state.counters["contacts"] = data->ncon;
}

const std::vector<std::string> kWhole = {"platform",   "torso",    "head",     "right_arm",
                                         "right_hand", "left_arm", "left_hand"};
const std::vector<std::string> kGrasp = {"right_arm", "right_hand"};
BENCHMARK_CAPTURE(Steps, whole_robot_contacts, kWhole, true);
BENCHMARK_CAPTURE(Steps, grasp_variant_contacts, kGrasp, true);
BENCHMARK_CAPTURE(Steps, whole_robot_contacts_looks, kWhole, true, true);
BENCHMARK_CAPTURE(Steps, grasp_variant_contacts_looks, kGrasp, true, true);
BENCHMARK_CAPTURE(Steps, whole_robot_free, kWhole, false);
BENCHMARK_CAPTURE(Steps, grasp_variant_free, kGrasp, false);

}  // namespace
}  // namespace springgrasp
