#include "experiment/trial.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <functional>
#include <optional>

#include "base/error.h"
#include "base/random.h"
#include "experiment/demonstrator_hand.h"
#include "experiment/observation_key.h"
#include "experiment/observe.h"
#include "experiment/perform_grasp.h"
#include "experiment/trial_observe.h"
#include "grasp/blend.h"
#include "grasp/generate.h"
#include "grasp/learn.h"
#include "grasp/library.h"
#include "grasp/shown_reach.h"
#include "grasp/transfer.h"
#include "sim/kinematic_tree_of.h"
#include "sim/scene_builder.h"

namespace springgrasp {
namespace {

constexpr int kPlaybackSteps = 201;  // over a reach

bool Substituted(const TrialSpec& spec, const std::string& stage) {
  return std::find(spec.substitute.begin(), spec.substitute.end(), stage) != spec.substitute.end();
}

// What the learner is given: tracked, or truth in the place of some of it.
Demonstration DemonstrationFor(const TrialSpec& spec, const SeenDemonstration& seen) {
  Demonstration demonstration = seen.tracked;
  for (std::size_t i = 0; i < demonstration.samples.size(); ++i) {
    DemonstrationSample& sample = demonstration.samples[i];
    const DemonstrationSample& truth = seen.truth.samples[i];
    if (Substituted(spec, "tracks")) sample.p_WF = truth.p_WF;
    if (Substituted(spec, "hand_pose")) {
      sample.p_WH = truth.p_WH;
      sample.R_WH = truth.R_WH;
    }
  }
  return demonstration;
}

// The baseline: the same reach, with the fingers held as an open hand all the time.
void HoldOpen(double hand_length, Demonstration& demonstration) {
  const ModelPtr model = LoadModelFile(ModelPath("mmm_hand/mmm_hand_r.xml"));
  const DemonstratorHand hand = MakeDemonstratorHand(KinematicTreeOf(*model, "mmm_hand"));
  PerFinger<Eigen::Vector3d> p_HF = ComputeHandShape(hand, hand.open).tips;
  for (Eigen::Vector3d& p : p_HF) p *= hand_length / kMmmHandLength;
  for (DemonstrationSample& sample : demonstration.samples) {
    sample.p_WF.fill(std::nullopt);
    if (!sample.p_WH || !sample.R_WH) continue;
    const Pose X_WH = MakePose(*sample.p_WH, *sample.R_WH);
    for (int f = 0; f < kNumFingers; ++f) sample.p_WF[f] = X_WH * p_HF[f];
  }
}

std::map<std::string, double> Measurements(const ObservationErrors& e) {
  std::map<std::string, double> v;
  v["tracking_median_mm"] = 1e3 * e.median_all;
  double worst = 0, coverage = 1;
  for (int f = 0; f < kNumFingers; ++f) {
    if (e.counted[f] == 0) continue;
    v[fmt::format("tracking_{}_mm", kFingerNames[f])] = 1e3 * e.median[f];
    worst = std::max(worst, e.p95[f]);
    coverage = std::min(coverage, e.coverage[f]);
  }
  v["tracking_95_mm"] = 1e3 * worst;
  v["coverage"] = coverage;
  v["label_swaps"] = e.label_swaps;
  v["wrist_error_mm"] = 1e3 * e.wrist_median;
  v["wrist_error_deg"] = e.wrist_rotation_median_deg;
  return v;
}

// `scene`: poses drawn. A wanted overlay is drawn in any case.
const SeenDemonstration& See(const TrialSpec& spec, const Scene& scene, const std::string& overlay,
                             TrialMemory& memory) {
  if (!overlay.empty()) memory.seen = {};
  return memory.seen.Get(ObservationKey(spec), [&] {
    RandomEngine engine = MakeStream(spec.seed, spec.repetition, "observation");
    ObserveOptions options;
    options.fps = scene.demonstrator.fps;
    options.overlay = overlay;
    options.measure_visible = false;
    const Observation seen = Observe(scene, engine, options);
    return SeenDemonstration{seen.tracked, seen.truth, seen.shown.involved,
                             Measurements(seen.errors)};
  });
}

Grasp LearnFrom(const TrialSpec& spec, const Demonstration& demonstration) {
  LearnOptions options;
  options.type = spec.grasp_type;
  options.dim = spec.dim;
  options.profile = spec.profile;
  options.hand_length = spec.scene.demonstrator.hand_length;
  return LearnGrasp(demonstration, options);
}

// Contacts and springs may be those of a grasp that is learned from the truth.
const Grasp& Learn(const TrialSpec& spec, const Demonstration& demonstration,
                   const Demonstration& truth, TrialMemory& memory) {
  return memory.grasp.Get(LearningKey(spec), [&] {
    Grasp grasp = LearnFrom(spec, demonstration);
    const bool contacts = Substituted(spec, "contacts"), springs = Substituted(spec, "k");
    if (!contacts && !springs) return grasp;
    const Grasp true_grasp = LearnFrom(spec, truth);
    if (contacts) TakeContacts(true_grasp, grasp);
    if (springs) TakeSprings(true_grasp, grasp);
    return grasp;
  });
}

void RecordGrasp(const Grasp& grasp, TrialResult& result) {
  auto& v = result.values;
  double sum = 0;
  int count = 0;
  for (int f = 0; f < kNumFingers; ++f) {
    if (grasp.quality.samples[f] == 0) continue;
    v[fmt::format("reproduction_{}_mm", kFingerNames[f])] = 1e3 * grasp.quality.rmse[f];
    if (!grasp.involved[f]) continue;
    sum += grasp.quality.rmse[f] * grasp.quality.rmse[f];
    ++count;
  }
  if (count > 0) v["reproduction_mm"] = 1e3 * std::sqrt(sum / count);
  v["reach_rmse_mm"] = 1e3 * grasp.quality.reach_rmse;
  v["condition_number"] = grasp.quality.condition_number;
  for (const GraspEdge& edge : grasp.edges) {
    v[fmt::format("k_{}{}", edge.i, edge.j)] = edge.k;
    v[fmt::format("k_se_{}{}", edge.i, edge.j)] = edge.standard_error;
  }
}

// Measures wall time per stage; decides nothing.
class Stopwatch {
 public:
  explicit Stopwatch(TrialResult& result) : result_(result) {}
  void Lap(const std::string& stage) {
    const auto now = std::chrono::steady_clock::now();
    result_.wall_s[stage] = std::chrono::duration<double>(now - last_).count();
    last_ = now;
  }

 private:
  TrialResult& result_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

// What is performed, and the demonstration that it was learned from (absent: not kept).
struct LearnedGrasp {
  Grasp grasp;
  std::optional<Demonstration> demonstration;
};

LearnedGrasp FromLibrary(const TrialSpec& spec) {
  LearnedGrasp learned{ReadGrasp(spec.grasp_file), {}};
  if (!spec.blend_file.empty()) {
    const std::optional<Shape>& shape = spec.scene.objects[0].shape;
    ThrowUnless(shape.has_value(), "{}: grasps meet on a shape, but the object has none",
                spec.scene.source);
    learned.grasp = BlendGrasps(learned.grasp, ReadGrasp(spec.blend_file), spec.blend_part, *shape,
                                GenerateOptions().tip_radius);
  }
  const std::string shown = DemonstrationOfEntry(spec.grasp_file);
  std::error_code ignored;
  if (std::filesystem::exists(shown, ignored)) learned.demonstration = ReadDemonstration(shown);
  return learned;
}

std::string PathIn(const TrialOutput& output, bool wanted, const char* name) {
  return wanted && !output.folder.empty() ? (std::filesystem::path(output.folder) / name).string()
                                          : std::string();
}

// Sees the demonstration and learns from it; nothing: `result` says why not.
std::optional<LearnedGrasp> SeeAndLearn(TrialMemory& memory, const TrialSpec& spec,
                                        const Scene& scene, const TrialOutput& output,
                                        TrialResult& result, Stopwatch& watch) {
  const SeenDemonstration& seen =
      See(spec, scene, PathIn(output, output.overlay, "tracking.mp4"), memory);
  result.values = seen.values;
  watch.Lap("observe");

  Demonstration demonstration = DemonstrationFor(spec, seen);
  if (spec.baseline == "open_hand") HoldOpen(scene.demonstrator.hand_length, demonstration);
  if (output.trajectories && !output.folder.empty()) {
    WriteDemonstration(demonstration, PathIn(output, true, "demonstration.csv"));
    WriteDemonstration(seen.truth, PathIn(output, true, "truth.csv"));
  }
  const std::string untracked = WhyUntracked(demonstration, seen.involved);
  if (!untracked.empty()) {
    result.outcome = Outcome::kUntracked;
    result.message = untracked;
    result.phase = "observe";
    return std::nullopt;
  }
  return LearnedGrasp{Learn(spec, demonstration, seen.truth, memory), demonstration};
}

TrialResult RunToPerform(TrialMemory& memory, const TrialSpec& spec, const TrialOutput& output) {
  ThrowUnless(!spec.scene.objects.empty(), "{}: the scene has no object to grasp",
              spec.scene.source);
  TrialResult result;
  Stopwatch watch(result);
  Scene scene = spec.scene;
  RandomEngine pose_engine = MakeStream(spec.seed, spec.repetition, "pose");
  DrawObjectPoses(scene, pose_engine);

  const std::optional<LearnedGrasp> learned =
      spec.grasp_file.empty() ? SeeAndLearn(memory, spec, scene, output, result, watch)
                              : FromLibrary(spec);
  if (!learned) return result;
  RecordGrasp(learned->grasp, result);
  if (output.trajectories) WriteGrasp(learned->grasp, PathIn(output, true, "grasp.yaml"));
  watch.Lap("learn");

  PerformGraspOptions perform;
  perform.criteria = spec.criteria;
  perform.actuation = MakeStream(spec.seed, spec.repetition, "actuation");
  perform.object_centre = spec.object_centre;
  perform.believe_truth = Substituted(spec, "object_pose");
  perform.exact_arm = Substituted(spec, "arm");
  perform.exact_fingers = Substituted(spec, "finger_joints");
  perform.video = PathIn(output, output.video, "grasp.mp4");
  perform.annotate = output.annotate;
  perform.motion = PathIn(output, output.trajectories, "motion.csv");
  perform.trajectory = PathIn(output, output.trajectories, "trajectory.csv");
  if (spec.baseline != "none" && spec.baseline != "open_hand") {
    perform.baseline = BaselineRequest{spec.baseline, {}, {}};
    if (spec.baseline == "playback") {
      perform.baseline->demonstrated =
          DemonstratedTips(*learned->demonstration, learned->grasp, kPlaybackSteps);
    }
  }
  perform.plan_key = PlanKey(spec);
  TrialResult performed = PerformGrasp(learned->grasp, scene, perform, memory.plans);
  result.outcome = performed.outcome;
  result.message = performed.message;
  result.phase = performed.phase;
  result.values.merge(performed.values);
  watch.Lap("perform");
  return result;
}

}  // namespace

TrialResult RunTrialWith(TrialMemory& memory, const TrialSpec& spec, const TrialOutput& output) {
  TrialResult result =
      spec.until == "observe" ? RunObserveTrial(spec, output) : RunToPerform(memory, spec, output);
  for (const auto& [key, value] : spec.drawn) result.values[key] = value;
  return result;
}

TrialResult RunTrial(const TrialSpec& spec, const TrialOutput& output) {
  TrialMemory memory;
  return RunTrialWith(memory, spec, output);
}

}  // namespace springgrasp
