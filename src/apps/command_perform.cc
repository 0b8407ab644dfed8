// springgrasp perform: one grasp of the library in physics.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "apps/command.h"
#include "base/error.h"
#include "base/files.h"
#include "base/random.h"
#include "experiment/perform_grasp.h"
#include "grasp/grasp.h"

namespace springgrasp {
namespace {

struct Options {
  std::string grasp, scene, directory, video, camera;
  std::uint64_t seed = 0;
};

std::string FormatResult(const TrialResult& result) {
  std::string text =
      fmt::format("outcome: {}\nphase: {}\n", OutcomeName(result.outcome), result.phase);
  if (!result.message.empty()) text += fmt::format("message: \"{}\"\n", result.message);
  text += "values:\n";
  for (const auto& [name, value] : result.values) text += fmt::format("  {}: {}\n", name, value);
  return text;
}

int Perform(const Options& options) {
  CheckOutputPath(options.video);
  const Grasp grasp = ReadGrasp(options.grasp);
  Scene scene = ReadScene(options.scene);
  ThrowUnless(!scene.objects.empty(), "{}: the scene has no object to grasp", options.scene);
  RandomEngine engine = MakeStream(options.seed, 0, "pose");
  DrawObjectPoses(scene, engine);
  const std::filesystem::path folder(options.directory);
  CheckOutputPath((folder / "outcome.yaml").string());
  MakeFolderOf((folder / "outcome.yaml").string());
  MakeFolderOf(options.video);
  PerformGraspOptions perform;
  perform.actuation = MakeStream(options.seed, 0, "actuation");
  perform.video = options.video;
  perform.camera = options.camera;
  perform.trajectory = (folder / "trajectory.csv").string();
  perform.motion = (folder / "motion.csv").string();
  const TrialResult result = PerformGrasp(grasp, scene, perform);
  const std::string text = FormatResult(result);
  WriteFileAtomically((folder / "outcome.yaml").string(), text);
  fmt::print("{}", text);
  return kDone;
}

}  // namespace

void AddPerformCommand(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = AddCommand(
      app, "perform", "Performs a learned grasp once in a simulated scene and judges it.",
      "experiments/first_grasps/pinch.yaml --scene scenes/pinch_ball.yaml -o out/perform");
  command->add_option("grasp", options->grasp, "grasp YAML of `learn`")->required();
  command->add_option("--scene", options->scene, "scene YAML")->required();
  command->add_option("--seed", options->seed, "of the object's pose")->capture_default_str();
  command->add_option("-o,--output", options->directory, "folder for outcome and trajectories")
      ->required();
  command->add_option("--video", options->video, "video of robot and object (.mp4)");
  command->add_option("--camera", options->camera,
                      "camera of the video (default: the scene's overview cameras)");
  command->callback([options, &exit_code] { exit_code = Perform(*options); });
}

}  // namespace springgrasp
