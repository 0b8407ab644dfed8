// What a run is held against: the regression gate of `springgrasp check`.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "experiment/store.h"

namespace springgrasp {

struct CaseExpectation {
  double success_lower_bound = 0;         // least accepted lower 95 % Wilson bound of success
  std::map<std::string, double> at_most;  // measurement -> largest accepted median
};

// Case name (as the outcome table writes it) -> what it must reach. YAML:
//   cases:
//     power: {success_lower_bound: 0.49, at_most: {tracking_median_mm: 3}}
using Expectation = std::map<std::string, CaseExpectation>;

// Throws Error with file and line.
Expectation ReadExpectation(const std::string& path);

// Expectation that these trials just meet: the bounds reached, and medians of the errors of the
// chain with 20 % added. Throws Error if a trial is missing.
std::string RecordExpectation(const std::vector<StoredTrial>& trials);

struct CheckReport {
  bool ok = true;
  std::string table;  // one line per comparison: case, what, expected, found, verdict
};
// A case without trials, or with trials that have not been run, falls short.
CheckReport CheckExpectation(const Expectation& expectation,
                             const std::vector<StoredTrial>& trials);

}  // namespace springgrasp
