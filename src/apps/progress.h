// How a run goes on, for people.
#pragma once

#include <string>

#include "experiment/runner.h"

namespace springgrasp {

// "37/240  12.3 per minute  16:30 left  31 succeeded"
std::string DescribeProgress(const RunProgress& progress);

// Prints to stderr: one line that is written over on a terminal, one line per trial otherwise.
class ProgressPrinter {
 public:
  explicit ProgressPrinter(bool quiet);
  ~ProgressPrinter();
  void operator()(const RunProgress& progress);

 private:
  bool quiet_;
  bool terminal_;
  bool open_line_ = false;
};

}  // namespace springgrasp
