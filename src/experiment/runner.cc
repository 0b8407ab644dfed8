#include "experiment/runner.h"

#include <poll.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <filesystem>
#include <list>

#include "base/error.h"
#include "experiment/provenance.h"
#include "experiment/runner_worker.h"
#include "experiment/trial_identity.h"

namespace springgrasp {
namespace {

namespace fs = std::filesystem;

bool Records(const TrialOutput& output) {
  return output.trajectories || output.video || output.overlay;
}

fs::path FinalFolder(const std::string& directory, const std::string& id) {
  return fs::path(directory) / "trials" / id;
}
fs::path TemporaryFolder(const std::string& directory, const std::string& id) {
  return fs::path(directory) / "trials" / fmt::format(".{}.tmp", id);
}

// In the worker: the trial, its files under a temporary name until all are there.
TrialResult RunAndRecord(const PlannedTrial& trial, const std::string& directory,
                         const TrialFunction& run_trial) {
  if (!Records(trial.output)) return run_trial(trial.spec, {});
  const fs::path temporary = TemporaryFolder(directory, trial.id);
  try {
    fs::remove_all(temporary);
    fs::create_directories(temporary);
    TrialOutput output = trial.output;
    output.folder = temporary;
    TrialResult result = run_trial(trial.spec, output);
    fs::remove_all(FinalFolder(directory, trial.id));
    fs::rename(temporary, FinalFolder(directory, trial.id));
    return result;
  } catch (const fs::filesystem_error& e) {
    throw NotWritten(
        fmt::format("{}: cannot be written ({})", e.path1().string(), e.code().message()));
  }
}

std::string Label(const TrialSpec& spec) {
  std::string label = spec.case_name;
  if (spec.demonstration != "synthesised") label += " " + spec.demonstration;
  if (spec.baseline != "none") label += " (" + spec.baseline + ")";
  return fmt::format("{} {}", label, spec.repetition);
}

// Ignores SIGPIPE while in scope: a worker may die while it is being written to.
class WithoutSigpipe {
 public:
  WithoutSigpipe() : before_(signal(SIGPIPE, SIG_IGN)) {}
  ~WithoutSigpipe() { signal(SIGPIPE, before_); }

 private:
  sighandler_t before_;
};

class Run {
 public:
  Run(const std::vector<PlannedTrial>& trials, ResultStore& store, const TrialFunction& run_trial,
      const RunOptions& options)
      : trials_(trials), store_(store), options_(options) {
    task_ = [&trials, directory = store.directory(), run_trial](int i) {
      return RunAndRecord(trials[static_cast<std::size_t>(i)], directory, run_trial);
    };
    log_ = (fs::path(store.directory()) / "workers.log").string();
    FindOpenTrials();
  }

  RunEnd Execute() {
    bool stop = false;
    if (!queue_.empty()) fs::create_directories(fs::path(store_.directory()) / "trials");
    while (true) {
      stop = stop || options_.stop_requested();
      if (!stop) FeedWorkers();
      StoreReceived();
      if (CountBusy() == 0) break;
      Wait();
    }
    std::error_code ignored;
    if (fs::exists(log_, ignored) && fs::file_size(log_, ignored) == 0) fs::remove(log_, ignored);
    return progress_.done == progress_.total ? RunEnd::kComplete : RunEnd::kStoppedEarly;
  }

 private:
  void FindOpenTrials() {
    std::set<std::string> finished;
    for (const StoredTrial& stored : store_.Trials()) {
      if (!stored.result) continue;
      finished.insert(stored.plan.id);
      progress_.succeeded += stored.result->outcome == Outcome::kSuccess;
    }
    for (std::size_t i = 0; i < trials_.size(); ++i) {
      if (finished.count(trials_[i].id) == 0) queue_.push_back(static_cast<int>(i));
    }
    progress_.total = static_cast<int>(trials_.size());
    progress_.done = progress_.total - static_cast<int>(queue_.size());
    if (options_.limit >= 0 && queue_.size() > static_cast<std::size_t>(options_.limit)) {
      queue_.resize(static_cast<std::size_t>(options_.limit));
    }
  }

  void FeedWorkers() {
    while (!queue_.empty() && CountBusy() < options_.jobs) {
      auto idle = std::find_if(workers_.begin(), workers_.end(),
                               [](const Worker& worker) { return !worker.busy(); });
      if (idle == workers_.end()) idle = workers_.emplace(workers_.end(), task_, log_);
      const auto next = NextFor(*idle);
      idle->Start(*next);
      queue_.erase(next);
    }
  }

  // A trial of the group that this worker comes from; else of one that no other is at.
  std::deque<int>::iterator NextFor(const Worker& worker) {
    const auto group = [this](int i) { return trials_[static_cast<std::size_t>(i)].group; };
    if (worker.last() >= 0) {
      const auto same = std::find_if(queue_.begin(), queue_.end(),
                                     [&](int i) { return group(i) == group(worker.last()); });
      if (same != queue_.end()) return same;
    }
    const auto free = std::find_if(queue_.begin(), queue_.end(), [&](int i) {
      return std::none_of(workers_.begin(), workers_.end(), [&](const Worker& other) {
        return &other != &worker && other.last() >= 0 && group(other.last()) == group(i);
      });
    });
    return free != queue_.end() ? free : queue_.begin();
  }

  void Wait() {
    std::vector<pollfd> fds;
    for (const Worker& worker : workers_) fds.push_back({worker.read_fd(), POLLIN, 0});
    constexpr int kAskAgainMs = 200;  // for stop_requested
    if (poll(fds.data(), fds.size(), kAskAgainMs) <= 0) return;
    auto fd = fds.begin();
    for (auto worker = workers_.begin(); worker != workers_.end(); ++fd) {
      const int trial = worker->running();
      std::optional<TrialResult> result;
      if (fd->revents != 0) result = worker->Receive();
      if (result && trial >= 0) received_.emplace_back(trial, std::move(*result));
      worker = worker->alive() ? std::next(worker) : workers_.erase(worker);
    }
  }

  // While the workers are at their next trials: the disk takes its time.
  void StoreReceived() {
    for (const auto& [trial, result] : received_) {
      Store(trials_[static_cast<std::size_t>(trial)], result);
    }
    received_.clear();
  }

  void Store(const PlannedTrial& trial, const TrialResult& result) {
    std::error_code ignored;
    fs::remove_all(TemporaryFolder(store_.directory(), trial.id), ignored);
    if (result.not_written) throw NotWritten(result.message);
    store_.Add(trial.id, result);
    ++progress_.done;
    ++progress_.now;
    progress_.succeeded += result.outcome == Outcome::kSuccess;
    progress_.last = fmt::format("{}: {}", Label(trial.spec), OutcomeName(result.outcome));
    if (!result.message.empty()) progress_.last += " (" + result.message + ")";
    progress_.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
    options_.on_progress(progress_);
  }

  int CountBusy() const {
    return static_cast<int>(std::count_if(workers_.begin(), workers_.end(),
                                          [](const Worker& worker) { return worker.busy(); }));
  }

  const std::vector<PlannedTrial>& trials_;
  ResultStore& store_;
  RunOptions options_;
  Worker::Task task_;
  std::string log_;
  std::deque<int> queue_;  // trials still to start
  std::list<Worker> workers_;
  std::vector<std::pair<int, TrialResult>> received_;  // trials and what came of them
  RunProgress progress_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  WithoutSigpipe without_sigpipe_;
};

}  // namespace

RunEnd RunTrials(const std::vector<PlannedTrial>& trials, ResultStore& store,
                 const TrialFunction& run_trial, const RunOptions& options) {
  return Run(trials, store, run_trial, options).Execute();
}

RunDescription DescribeRun(const Experiment& experiment, const std::vector<PlannedTrial>& trials) {
  RunDescription run;
  run.experiment_yaml = experiment.text;
  run.source = fs::absolute(experiment.source).lexically_normal();
  run.provenance = DescribeProvenance();
  for (const PlannedTrial& trial : trials) {
    run.plan.push_back({trial.id, trial.spec.case_name, trial.spec.demonstration,
                        trial.spec.baseline, trial.spec.repetition, trial.spec.seed,
                        CanonicalText(trial.spec)});
  }
  return run;
}

}  // namespace springgrasp
