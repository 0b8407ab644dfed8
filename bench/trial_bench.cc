// What a trial costs beside its physics: the whole of Perform (control at every step, contacts
// read, verdict) against the bare mj_step loop of the same model with the same commands. Planning,
// observation and videos are not in it.
#include <benchmark/benchmark.h>

#include <vector>

#include "base/files.h"
#include "experiment/perform_grasp.h"
#include "sim/scene_builder.h"

namespace springgrasp {
namespace {

struct Commands {
  std::vector<mjtNum> ctrl, force;  // of the motors and valves; on all bodies
};

// A planned pinch, and the commands that performing it gave at every step.
struct PlannedTrial {
  PlannedTrial()
      : scene(ReadScene(SourceFolder() + "/scenes/pinch_ball.yaml")),
        grasp(ReadGrasp(SourceFolder() + "/models/grasps/pinch.yaml")) {
    Simulation simulation = Start();
    const RobotIo robot(simulation.model(), "r");
    const RobotBody body = MakeRobotBody(simulation, "r");
    PlanRequest request;
    request.object = BelieveObject(scene, 0);
    request.table_height = scene.table.height;
    request.arm_start = robot.Read(simulation).arm_q;
    plan = PlanGrasp(body, grasp, request).plan.value();
    Run([this](const Simulation& now, Phase) {
      const mjData& data = now.data();
      const mjModel& m = now.model();
      steps.push_back(
          {{data.ctrl, data.ctrl + m.nu}, {data.xfrc_applied, data.xfrc_applied + 6 * m.nbody}});
    });
  }

  static BuildOptions Looks() {
    BuildOptions build;
    build.with_looks = false;
    return build;
  }
  Simulation Start() const { return Simulation(BuildModel(scene, Looks())); }

  Performance Run(const StepObserver& observer) {
    Simulation simulation = Start();
    const RobotIo robot(simulation.model(), "r");
    const RobotBody body = MakeRobotBody(simulation, "r");
    return Run(simulation, robot, body, observer);
  }
  Performance Run(Simulation& simulation, const RobotIo& robot, const RobotBody& body,
                  const StepObserver& observer) {
    robot.Place(plan.arm.front(), plan.hand.front(), simulation);
    simulation.Forward();
    PerformOptions options;
    options.shape = *scene.objects[0].shape;
    options.max_finger_force = scene.max_finger_force;
    return Perform(simulation, robot, scene.objects[0].name, body, plan, options, observer);
  }

  Scene scene;
  Grasp grasp;
  GraspPlan plan;
  std::vector<Commands> steps;
};

PlannedTrial& Trial() {
  static PlannedTrial trial;
  return trial;
}

void BareSteps(benchmark::State& state) {
  PlannedTrial& trial = Trial();
  for (auto _ : state) {
    state.PauseTiming();
    Simulation simulation = trial.Start();
    const RobotIo robot(simulation.model(), "r");
    robot.Place(trial.plan.arm.front(), trial.plan.hand.front(), simulation);
    simulation.Forward();
    mjData& data = simulation.mutable_data();
    const mjModel& model = simulation.model();
    state.ResumeTiming();
    for (const Commands& step : trial.steps) {
      mju_copy(data.ctrl, step.ctrl.data(), model.nu);
      mju_copy(data.xfrc_applied, step.force.data(), 6 * model.nbody);
      mj_step(&model, &data);
    }
  }
  state.counters["steps"] = static_cast<double>(trial.steps.size());
}
BENCHMARK(BareSteps)->Unit(benchmark::kMillisecond)->MinTime(3);

void WholeTrial(benchmark::State& state) {
  PlannedTrial& trial = Trial();
  double simulated = 0;
  for (auto _ : state) {
    state.PauseTiming();
    Simulation simulation = trial.Start();
    const RobotIo robot(simulation.model(), "r");
    const RobotBody body = MakeRobotBody(simulation, "r");
    state.ResumeTiming();
    simulated = trial.Run(simulation, robot, body, {}).duration;
  }
  state.counters["simulated_s"] = simulated;
}
BENCHMARK(WholeTrial)->Unit(benchmark::kMillisecond)->MinTime(3);

}  // namespace
}  // namespace springgrasp
