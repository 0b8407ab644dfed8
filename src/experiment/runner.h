// Runs planned trials in worker processes and stores each result as it comes. Knows nothing of what
// a trial is.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiment/experiment.h"
#include "experiment/store.h"
#include "experiment/trial_result.h"

namespace springgrasp {

using TrialFunction = std::function<TrialResult(const TrialSpec&, const TrialOutput&)>;

struct RunProgress {
  int done = 0, total = 0;  // trials, earlier runs included
  int succeeded = 0;        // of those done
  int now = 0;              // done by this run
  double seconds = 0;       // since this run began
  std::string last;         // the trial that just ended: "power 3: success"
};

struct RunOptions {
  int jobs = 1;    // worker processes
  int limit = -1;  // trials of this run at most; -1: all
  // Asked a few times a second: true ends the run after the running trials.
  std::function<bool()> stop_requested = [] { return false; };
  std::function<void(const RunProgress&)> on_progress = [](const RunProgress&) {};
};

enum class RunEnd { kComplete, kStoppedEarly };

// Runs the trials that `store` has no result of. A trial that throws, or whose worker dies, gets
// the outcome `error` with the reason. Recorded files go to <directory>/trials/<id>/, what workers
// print to <directory>/workers.log. Throws NotWritten if files cannot be written; what is done
// stays, and the next call goes on. The caller must not have made a render context.
RunEnd RunTrials(const std::vector<PlannedTrial>& trials, ResultStore& store,
                 const TrialFunction& run_trial, const RunOptions& options);

// The store's description of an expanded experiment.
RunDescription DescribeRun(const Experiment& experiment, const std::vector<PlannedTrial>& trials);

}  // namespace springgrasp
