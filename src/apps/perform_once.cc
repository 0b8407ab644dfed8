#include "apps/perform_once.h"

#include <fmt/format.h>

#include <filesystem>

#include "base/files.h"
#include "base/random.h"
#include "experiment/perform_grasp.h"

namespace springgrasp {
namespace {

std::string FormatResult(const TrialResult& result) {
  std::string text =
      fmt::format("outcome: {}\nphase: {}\n", OutcomeName(result.outcome), result.phase);
  if (!result.message.empty()) text += fmt::format("message: \"{}\"\n", result.message);
  text += "values:\n";
  for (const auto& [name, value] : result.values) text += fmt::format("  {}: {}\n", name, value);
  return text;
}

std::string In(const std::string& folder, const std::string& file) {
  return (std::filesystem::path(folder) / file).string();
}

}  // namespace

void AddPerformOnceOptions(CLI::App& command, PerformOnceOptions& options) {
  command.add_option("--seed", options.seed, "of the object's pose")->capture_default_str();
  command
      .add_option("-o,--output", options.directory,
                  "folder for outcome, trajectories and all else that is made")
      ->required();
  command.add_option("--video", options.video, "video of robot and object (.mp4)");
  command.add_option("--camera", options.camera,
                     "camera of the video (default: the scene's overview cameras)");
}

void CheckOutputPaths(const PerformOnceOptions& options) {
  CheckOutputPath(options.video);
  CheckOutputPath(In(options.directory, "outcome.yaml"));
}

void PerformOnce(const Grasp& grasp, Scene scene, const PerformOnceOptions& options) {
  RandomEngine engine = MakeStream(options.seed, 0, "pose");
  DrawObjectPoses(scene, engine);
  MakeFolderOf(In(options.directory, "outcome.yaml"));
  MakeFolderOf(options.video);
  PerformGraspOptions perform;
  perform.actuation = MakeStream(options.seed, 0, "actuation");
  perform.video = options.video;
  perform.camera = options.camera;
  perform.trajectory = In(options.directory, "trajectory.csv");
  perform.motion = In(options.directory, "motion.csv");
  const TrialResult result = PerformGrasp(grasp, scene, perform);
  const std::string text = FormatResult(result);
  WriteFileAtomically(In(options.directory, "outcome.yaml"), text);
  fmt::print("{}", text);
}

}  // namespace springgrasp
