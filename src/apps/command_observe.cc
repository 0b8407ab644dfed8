// springgrasp observe: the simulated demonstrator before the robot's eyes, or recorded video.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "apps/command.h"
#include "apps/recorded_options.h"
#include "base/error.h"
#include "experiment/observe.h"
#include "experiment/table.h"

namespace springgrasp {
namespace {

struct Options {
  std::string scene, output, overlay, truth, frames;
  std::uint64_t seed = 1;
  double fps = 0;
  std::optional<double> noise;
  std::optional<std::string> tracker;
  ObserveRecordedOptions recorded;
  bool particles = false;
  bool recorded_only = false;  // an option of recorded video was given
};

TrackerKind Kind(const Options& options) {
  const auto found = std::find(kTrackerKinds.begin(), kTrackerKinds.end(),
                               options.tracker.value_or(std::string(kTrackerKinds[0])));
  return static_cast<TrackerKind>(found - kTrackerKinds.begin());
}

int RunRecorded(Options options) {
  ObserveRecordedOptions& recorded = options.recorded;
  ThrowUnless(options.frames.empty() && !options.noise,
              "--save-frames and --noise are for a scene, not for recorded video");
  recorded.particles = options.particles;
  for (const std::string& path : {options.output, options.overlay}) CheckOutputPath(path);
  recorded.output = options.output;
  recorded.overlay = options.overlay;
  recorded.truth = options.truth;
  recorded.tracker = Kind(options);
  recorded.fps = options.fps;
  recorded.seed = options.seed;
  return ObserveRecorded(recorded);
}

void Print(const Observation& observation) {
  const ObservationErrors& errors = observation.errors;
  std::vector<std::vector<std::string>> rows = {
      {"finger", "median mm", "95 % mm", "tracked while visible %"}};
  for (int f = 0; f < kNumFingers; ++f) {
    if (errors.counted[f] == 0) continue;
    rows.push_back({std::string(kFingerNames[f]), fmt::format("{:.2f}", 1e3 * errors.median[f]),
                    fmt::format("{:.2f}", 1e3 * errors.p95[f]),
                    fmt::format("{:.0f}", 100 * errors.coverage[f])});
  }
  fmt::print("{}", AlignColumns(rows));
  fmt::print("hand: median {:.1f} mm, {:.1f} deg, seen in {:.0f} % of frames\n",
             1e3 * errors.wrist_median, errors.wrist_rotation_median_deg,
             100 * errors.wrist_coverage);
  fmt::print("hand length: {:.0f} mm as estimated in the lead-in\n",
             1e3 * kMmmHandLength * observation.summary.hand_scale);
}

int RunObserve(const Options& options) {
  const bool recorded = IsRecorded(options.recorded);
  ThrowUnless(recorded != !options.scene.empty(),
              "observe takes either a scene or --left, --right, --intrinsics and --extrinsics");
  if (recorded) return RunRecorded(options);
  ThrowUnless(!options.recorded_only,
              "--camera-pose, --marker-hue, --cap-* and --hand are for recorded video, not for a "
              "scene, whose demonstrator has them");
  for (const std::string& path : {options.output, options.overlay, options.truth}) {
    CheckOutputPath(path);
  }
  const Scene scene = ReadScene(options.scene);
  ObserveOptions observe;
  observe.fps = options.fps > 0 ? options.fps : scene.demonstrator.fps;
  observe.noise = options.noise;
  observe.tracker = options.tracker;
  observe.overlay = options.overlay;
  observe.particles = options.particles;
  observe.frames_folder = options.frames;
  RandomEngine engine = MakeStream(options.seed, 0, "observation");
  MakeFolderOf(options.overlay);
  if (!options.frames.empty()) std::filesystem::create_directories(options.frames);
  const Observation observation = Observe(scene, engine, observe);
  MakeFolderOf(options.output);
  MakeFolderOf(options.truth);
  if (!options.truth.empty()) WriteDemonstration(observation.truth, options.truth);
  WriteDemonstration(observation.tracked, options.output);
  fmt::print("{}: {} samples\n", options.output, observation.tracked.samples.size());
  Print(observation);
  return kDone;
}

}  // namespace

void AddObserveCommand(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = AddCommand(
      app, "observe",
      "Tracks a demonstration before the robot's wide-angle cameras, or on recorded stereo video.",
      "scenes/pinch_ball.yaml -o out/pinch.csv --overlay out/pinch.mp4");
  command->add_option("scene", options->scene, "scene YAML with a demonstrator");
  const std::vector<CLI::Option*> recorded_only = AddRecordedOptions(*command, options->recorded);
  command->add_option("-o,--output", options->output, "demonstration CSV: what was tracked")
      ->required();
  command->add_option("--truth", options->truth,
                      "scene: demonstration CSV to write, what was shown; recorded video: CSV to "
                      "read and compare with");
  command->add_option("--overlay", options->overlay, "video of the tracking (.mp4)");
  command->add_flag("--particles", options->particles, "draw the particles into the overlay");
  command->add_option("--save-frames", options->frames, "folder for the pictures of both eyes");
  command
      ->add_option("--fps", options->fps, "frames per second (default: the scene's, the video's)")
      ->check(CLI::Range(5.0, 1000.0));
  command->add_option("--noise", options->noise, "deviation of the grey values, 0 to 255")
      ->check(CLI::Range(0.0, 255.0));
  command
      ->add_option("--tracker", options->tracker,
                   "outline, or paper: section III-B and no more (default: the scene's, outline)")
      ->check(CLI::IsMember(std::vector<std::string>(kTrackerKinds.begin(), kTrackerKinds.end())));
  command->add_option("--seed", options->seed, "of the random streams")->capture_default_str();
  command->callback([options, recorded_only, &exit_code] {
    options->recorded_only = AnyGiven(recorded_only);
    exit_code = RunObserve(*options);
  });
}

}  // namespace springgrasp
