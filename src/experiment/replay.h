// One recorded trial again, and whether it is the same to the bit.
#pragma once

#include <string>
#include <vector>

#include "experiment/experiment.h"
#include "experiment/runner.h"
#include "experiment/store.h"

namespace springgrasp {

// The stored trial whose identity is, or begins with, `trial`, or that is `<case>:<repetition>`.
// Throws Error if none or several are, or if it has not been run yet.
StoredTrial FindTrial(ResultStore& store, const std::string& trial);

// What is needed to run it again: the directory's effective experiment is expanded anew, its scenes
// and recordings read from where the run found them. Throws Error if one of them has changed since.
PlannedTrial PlanAgain(ResultStore& store, const StoredTrial& stored);

// Runs it; what is thrown becomes the outcome `error`, as in a run.
TrialResult RunAgain(const PlannedTrial& planned, const TrialFunction& run_trial,
                     const TrialOutput& output = {});

// Every way in which two results differ: outcome, phase, message, each measurement by its bits. One
// line each, empty if there is none. Wall times do not count.
std::vector<std::string> Differences(const TrialResult& stored, const TrialResult& now);

}  // namespace springgrasp
