// springgrasp replay: one recorded trial again.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "apps/command.h"
#include "base/error.h"
#include "base/files.h"
#include "experiment/replay.h"
#include "experiment/trial.h"

namespace springgrasp {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string directory, trial, video;
};

int ReplayTrial(const Options& options) {
  CheckOutputPath(options.video);
  ResultStore store = ResultStore::OpenForReading(options.directory);
  const StoredTrial stored = FindTrial(store, options.trial);
  const PlannedTrial planned = PlanAgain(store, stored);
  ThrowUnless(options.video.empty() || planned.spec.until == "perform",
              "--video: trial {} ends with the tracking, there is no grasp to film",
              stored.plan.id);
  TrialResult now;
  if (options.video.empty()) {
    now = RunAgain(planned, RunTrial);
  } else {
    MakeFolderOf(options.video);
    const ScratchFolder folder(fs::absolute(options.video).parent_path());
    TrialOutput output;
    output.folder = folder.path();
    output.video = true;
    output.annotate = true;
    now = RunAgain(planned, RunTrial, output);
    const fs::path film = fs::path(folder.path()) / "grasp.mp4";
    if (fs::exists(film)) fs::rename(film, options.video);
  }
  const std::vector<std::string> differences = Differences(*stored.result, now);
  fmt::print("{} {} {}: {}\n", stored.plan.id, stored.plan.case_name, stored.plan.repetition,
             OutcomeName(now.outcome));
  if (!now.message.empty()) fmt::print("{}\n", now.message);
  for (const std::string& difference : differences) fmt::print("{}\n", difference);
  if (differences.empty()) {
    fmt::print("the same to the bit: outcome, phase and {} measurements\n",
               stored.result->values.size());
  }
  return differences.empty() ? kDone : kCheckFailed;
}

}  // namespace

void AddReplayCommand(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      AddCommand(app, "replay", "Runs one recorded trial again and compares it to the bit.",
                 "out/first_grasps power:0 --video out/replay.mp4");
  command->add_option("directory", options->directory, "results directory of `run`")->required();
  command
      ->add_option("trial", options->trial,
                   "its identity or how that begins, or <case>:<repetition>")
      ->required();
  command->add_option("--video", options->video,
                      "video of robot and object with phase, contact forces, planned and reached "
                      "fingertips (.mp4)");
  command->callback([options, &exit_code] { exit_code = ReplayTrial(*options); });
}

}  // namespace springgrasp
