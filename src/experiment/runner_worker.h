// One forked process that runs trials, and the two pipes to it.
#pragma once

#include <sys/types.h>

#include <functional>
#include <optional>
#include <string>

#include "experiment/trial_result.h"

namespace springgrasp {

// What `run` returns; what it throws becomes the outcome `error`, NotWritten a result that is none.
// The message is one line.
TrialResult ResultOrError(const std::function<TrialResult()>& run);

class Worker {
 public:
  // Runs task number i and returns its result; what it throws becomes the outcome `error`.
  using Task = std::function<TrialResult(int i)>;

  // Forks. The child prints to `log` (appended), ignores SIGINT and SIGTERM, and ends when the
  // pipe closes or this process dies. Throws Error if the system refuses.
  Worker(const Task& task, const std::string& log);
  // Closes the pipes and waits for the child.
  ~Worker();
  Worker(Worker&& other) noexcept;
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  void Start(int i);
  bool busy() const { return running_ >= 0; }
  int running() const { return running_; }
  int last() const { return last_; }  // task started last, -1: none yet
  int read_fd() const { return from_child_; }

  // Reads what has come; the result once it is complete. If the child has died: the outcome
  // `error`, and alive() is false from then on.
  std::optional<TrialResult> Receive();
  bool alive() const { return pid_ > 0; }

 private:
  TrialResult ReasonOfDeath();

  pid_t pid_ = -1;
  int to_child_ = -1, from_child_ = -1;
  int running_ = -1, last_ = -1;
  std::string received_;
};

}  // namespace springgrasp
