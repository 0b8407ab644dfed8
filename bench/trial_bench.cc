// What a trial costs beside its physics: the whole of Perform (control at every step, contacts
// read, verdict) against the bare mj_step loop of the same model with the same commands. Planning,
// observation and videos are not in it. TwoJobs and TwoBareProcesses: the same by the run engine's
// two workers, stored, against two processes that do nothing else.
#include <benchmark/benchmark.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <vector>

#include "base/files.h"
#include "experiment/perform_grasp.h"
#include "experiment/runner.h"
#include "sim/scene_builder.h"

namespace springgrasp {
namespace {

struct Commands {
  std::vector<mjtNum> ctrl, force;  // of the motors and valves; on all bodies
};

// A planned pinch, and the commands that performing it gave at every step.
struct PreparedTrial {
  PreparedTrial()
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

PreparedTrial& Trial() {
  static PreparedTrial trial;
  return trial;
}

void PlaceAtStart(Simulation& simulation) {
  const RobotIo robot(simulation.model(), "r");
  robot.Place(Trial().plan.arm.front(), Trial().plan.hand.front(), simulation);
  simulation.Forward();
}

void StepAll(Simulation& simulation) {
  mjData& data = simulation.mutable_data();
  const mjModel& model = simulation.model();
  for (const Commands& step : Trial().steps) {
    mju_copy(data.ctrl, step.ctrl.data(), model.nu);
    mju_copy(data.xfrc_applied, step.force.data(), 6 * model.nbody);
    mj_step(&model, &data);
  }
}

void BareSteps(benchmark::State& state) {
  PreparedTrial& trial = Trial();
  for (auto _ : state) {
    state.PauseTiming();
    Simulation simulation = trial.Start();
    PlaceAtStart(simulation);
    state.ResumeTiming();
    StepAll(simulation);
  }
  state.counters["steps"] = static_cast<double>(trial.steps.size());
}
BENCHMARK(BareSteps)->Unit(benchmark::kMillisecond)->MinTime(3);

void WholeTrial(benchmark::State& state) {
  PreparedTrial& trial = Trial();
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

constexpr int kTrialsEach = 24;

// Model and trial are made anew each time, here and in the run engine.
void TwoBareProcesses(benchmark::State& state) {
  Trial();
  for (auto _ : state) {
    pid_t children[2];
    for (pid_t& child : children) {
      child = fork();
      if (child != 0) continue;
      for (int i = 0; i < kTrialsEach; ++i) {
        Simulation simulation = Trial().Start();
        PlaceAtStart(simulation);
        StepAll(simulation);
      }
      _exit(0);
    }
    for (const pid_t child : children) waitpid(child, nullptr, 0);
  }
  state.SetItemsProcessed(state.iterations() * 2 * kTrialsEach);
}
BENCHMARK(TwoBareProcesses)->Unit(benchmark::kMillisecond)->UseRealTime()->MinTime(8);

void TwoJobs(benchmark::State& state) {
  Trial();
  const Experiment experiment = ParseExperiment(
      fmt::format("name: bench\nseed: 1\nrepetitions: {}\nrecord: {{trajectories: none}}\ncases:\n"
                  "  - {{name: pinch, scene: pinch_ball.yaml, grasp: pinch}}\n",
                  2 * kTrialsEach),
      "bench.yaml");
  const std::vector<PlannedTrial> trials = ExpandExperiment(experiment);
  const ScratchFolder folder(std::filesystem::temp_directory_path());
  int run = 0;
  RunOptions options;
  options.jobs = 2;
  for (auto _ : state) {
    ResultStore store = ResultStore::OpenForRun(fmt::format("{}/{}", folder.path(), run++),
                                                DescribeRun(experiment, trials));
    RunTrials(
        trials, store,
        [](const TrialSpec&, const TrialOutput&) {
          TrialResult result;
          result.values["simulated_s"] = Trial().Run({}).duration;
          return result;
        },
        options);
  }
  state.SetItemsProcessed(state.iterations() * 2 * kTrialsEach);
}
BENCHMARK(TwoJobs)->Unit(benchmark::kMillisecond)->UseRealTime()->MinTime(8);

}  // namespace
}  // namespace springgrasp
