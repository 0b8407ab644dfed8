// One trial: demonstration -> cameras -> tracker -> grasp -> plan -> physics -> outcome.
#pragma once

#include <map>

#include "base/last_value.h"
#include "demonstration/demonstration.h"
#include "experiment/plan_memory.h"
#include "experiment/trial_result.h"
#include "experiment/trial_spec.h"
#include "grasp/grasp.h"

namespace springgrasp {

// What was seen in an observation: the part of it that a trial uses.
struct SeenDemonstration {
  Demonstration tracked, truth;
  PerFinger<bool> involved = {};         // in the grasp that was shown
  std::map<std::string, double> values;  // its measurements
};

// What one process keeps from trial to trial. Trials which follow each other often share their
// demonstration, and differ in physics or beliefs only.
struct TrialMemory {
  LastValue<SeenDemonstration> seen;
  LastValue<Grasp> grasp;
  PlanMemory plans;
};

// Deterministic in `spec`; neither what is recorded nor what `memory` holds changes a result. Files
// go below output.folder: demonstration.csv, truth.csv, grasp.yaml, motion.csv, trajectory.csv,
// grasp.mp4, tracking.mp4. Throws Error for a demonstration or scene that cannot be used.
TrialResult RunTrialWith(TrialMemory& memory, const TrialSpec& spec, const TrialOutput& output);
TrialResult RunTrial(const TrialSpec& spec, const TrialOutput& output);

}  // namespace springgrasp
