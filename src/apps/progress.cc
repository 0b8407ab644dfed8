#include "apps/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>

namespace springgrasp {

std::string DescribeProgress(const RunProgress& p) {
  const double per_second = p.seconds > 0 ? p.now / p.seconds : 0;
  std::string left = "?";
  if (per_second > 0) {
    const long seconds = std::lround((p.total - p.done) / per_second);
    left = seconds >= 3600
               ? fmt::format("{}:{:02}:{:02}", seconds / 3600, seconds / 60 % 60, seconds % 60)
               : fmt::format("{}:{:02}", seconds / 60, seconds % 60);
  }
  return fmt::format("{}/{}  {:.1f} per minute  {} left  {} succeeded", p.done, p.total,
                     60 * per_second, left, p.succeeded);
}

ProgressPrinter::ProgressPrinter(bool quiet)
    : quiet_(quiet), terminal_(isatty(STDERR_FILENO) != 0) {}

ProgressPrinter::~ProgressPrinter() {
  if (open_line_) fmt::print(stderr, "\n");
}

void ProgressPrinter::operator()(const RunProgress& progress) {
  if (quiet_) return;
  if (terminal_) {
    constexpr const char* kClearLine = "\r\x1b[K";
    fmt::print(stderr, "{}{}", kClearLine, DescribeProgress(progress));
    open_line_ = true;
  } else {
    fmt::print(stderr, "{}  {}\n", DescribeProgress(progress), progress.last);
  }
  std::fflush(stderr);
}

}  // namespace springgrasp
