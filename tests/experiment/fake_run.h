// Runs of the small experiment whose trials are made up.
#pragma once

#include <chrono>
#include <cmath>
#include <limits>
#include <string>
#include <thread>

#include "base/files.h"
#include "experiment/export.h"
#include "experiment/runner.h"
#include "experiment/small_experiment.h"

namespace springgrasp {

// Depends on the trial alone, not on time or process.
inline TrialResult FakeTrial(const TrialSpec& spec, const TrialOutput& output) {
  TrialResult result;
  result.outcome = spec.repetition % 2 == 0 ? Outcome::kSuccess : Outcome::kMissed;
  result.phase = "done";
  result.message = spec.repetition % 2 == 0 ? "" : "index, \"the finger\",\nhas no contact";
  result.values["slip_mm"] = std::sqrt(spec.scene.objects[0].mass + spec.repetition);
  if (spec.repetition == 2) result.values["rare"] = -std::numeric_limits<double>::infinity();
  result.values["never"] = std::nan("");
  result.wall_s["perform"] = 1.25;
  if (!output.folder.empty()) WriteFileAtomically(output.folder + "/trajectory.csv", "t\n");
  return result;
}

inline TrialResult SlowTrial(const TrialSpec& spec, const TrialOutput& output) {
  std::this_thread::sleep_for(std::chrono::milliseconds(15));
  return FakeTrial(spec, output);
}

inline ResultStore OpenStore(const Experiment& experiment, const std::string& directory) {
  return ResultStore::OpenForRun(directory, DescribeRun(experiment, ExpandExperiment(experiment)));
}

inline RunEnd RunInto(const Experiment& experiment, const std::string& directory,
                      RunOptions options = {}, const TrialFunction& trial = FakeTrial) {
  ResultStore store = OpenStore(experiment, directory);
  return RunTrials(ExpandExperiment(experiment), store, trial, options);
}

inline std::string Exported(const std::string& directory) {
  return ExportCsv(ResultStore::OpenForReading(directory).Trials(), false);
}

}  // namespace springgrasp
