#include "experiment/runner_worker.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <utility>

#include "base/error.h"
#include "experiment/result_codec.h"

namespace springgrasp {
namespace {

// False at the end of the pipe.
bool ReadAll(int fd, void* data, std::size_t n) {
  char* at = static_cast<char*>(data);
  while (n > 0) {
    const ssize_t got = read(fd, at, n);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    at += got;
    n -= static_cast<std::size_t>(got);
  }
  return true;
}

bool WriteAll(int fd, const void* data, std::size_t n) {
  const char* at = static_cast<const char*>(data);
  while (n > 0) {
    const ssize_t put = write(fd, at, n);
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) return false;
    at += put;
    n -= static_cast<std::size_t>(put);
  }
  return true;
}

[[noreturn]] void ServeTasks(const Worker::Task& task, int in, int out) {
  std::int32_t i = 0;
  while (ReadAll(in, &i, sizeof(i))) {
    const std::string bytes = EncodeResult(ResultOrError([&] { return task(i); }));
    const std::uint64_t size = bytes.size();
    if (!WriteAll(out, &size, sizeof(size)) || !WriteAll(out, bytes.data(), bytes.size())) break;
  }
  // Not exit(): the parent's buffers and handles are not this process's to flush or close.
  _exit(0);
}

void RedirectOutput(const std::string& log) {
  const int fd = open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
  if (fd < 0) return;
  dup2(fd, STDOUT_FILENO);
  dup2(fd, STDERR_FILENO);
  close(fd);
}

}  // namespace

TrialResult ResultOrError(const std::function<TrialResult()>& run) {
  TrialResult result;
  try {
    result = run();
  } catch (const NotWritten& e) {
    result.not_written = true;
    result.message = e.what();
  } catch (const std::exception& e) {
    result.outcome = Outcome::kError;
    result.message = e.what();
  } catch (...) {
    result.outcome = Outcome::kError;
    result.message = "unknown exception";
  }
  std::replace_if(
      result.message.begin(), result.message.end(), [](char c) { return c == '\n' || c == '\r'; },
      ' ');
  return result;
}

Worker::Worker(const Task& task, const std::string& log) {
  int down[2], up[2];
  ThrowUnless(pipe2(down, O_CLOEXEC) == 0, "no pipe for a worker: {}", std::strerror(errno));
  if (pipe2(up, O_CLOEXEC) != 0) {
    const int reason = errno;
    close(down[0]);
    close(down[1]);
    Fail("no pipe for a worker: {}", std::strerror(reason));
  }
  const pid_t parent = getpid();
  pid_ = fork();
  if (pid_ == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(1);
    signal(SIGINT, SIG_IGN);
    signal(SIGTERM, SIG_IGN);
    close(down[1]);
    close(up[0]);
    RedirectOutput(log);
    ServeTasks(task, down[0], up[1]);
  }
  close(down[0]);
  close(up[1]);
  to_child_ = down[1];
  from_child_ = up[0];
  if (pid_ < 0) {
    close(to_child_);
    close(from_child_);
    Fail("no worker process: {}", std::strerror(errno));
  }
}

Worker::Worker(Worker&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)),
      to_child_(std::exchange(other.to_child_, -1)),
      from_child_(std::exchange(other.from_child_, -1)),
      running_(std::exchange(other.running_, -1)),
      last_(std::exchange(other.last_, -1)),
      received_(std::move(other.received_)) {}

Worker::~Worker() {
  if (to_child_ >= 0) close(to_child_);
  // A worker started later holds a copy of our end of the pipe, so closing alone may not end it.
  if (pid_ > 0) {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  if (from_child_ >= 0) close(from_child_);
}

void Worker::Start(int i) {
  running_ = last_ = i;
  received_.clear();
  const std::int32_t number = i;
  // If the child is gone, Receive() reports it.
  (void)!WriteAll(to_child_, &number, sizeof(number));
}

std::optional<TrialResult> Worker::Receive() {
  char buffer[65536];
  ssize_t got = read(from_child_, buffer, sizeof(buffer));
  if (got < 0 && errno == EINTR) return std::nullopt;
  if (got <= 0) return ReasonOfDeath();
  received_.append(buffer, static_cast<std::size_t>(got));
  std::uint64_t size = 0;
  if (received_.size() < sizeof(size)) return std::nullopt;
  std::memcpy(&size, received_.data(), sizeof(size));
  if (received_.size() < sizeof(size) + size) return std::nullopt;
  running_ = -1;
  return DecodeResult(std::string_view(received_).substr(sizeof(size), size));
}

TrialResult Worker::ReasonOfDeath() {
  int status = 0;
  waitpid(pid_, &status, 0);
  pid_ = -1;
  running_ = -1;
  TrialResult result;
  result.outcome = Outcome::kError;
  result.message = WIFSIGNALED(status)
                       ? fmt::format("the worker process was ended by signal {} ({})",
                                     WTERMSIG(status), strsignal(WTERMSIG(status)))
                       : fmt::format("the worker process ended with code {}", WEXITSTATUS(status));
  return result;
}

}  // namespace springgrasp
