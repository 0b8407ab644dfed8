// One trial: demonstration -> cameras -> tracker -> grasp -> plan -> physics -> outcome.
#pragma once

#include "experiment/trial_result.h"
#include "experiment/trial_spec.h"

namespace springgrasp {

// Deterministic in `spec`; what is recorded changes no result. Files go below output.folder:
// demonstration.csv, truth.csv, grasp.yaml, motion.csv, trajectory.csv, grasp.mp4, tracking.mp4.
// Throws Error for a demonstration or scene that cannot be used.
TrialResult RunTrial(const TrialSpec& spec, const TrialOutput& output);

}  // namespace springgrasp
