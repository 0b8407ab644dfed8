// Results as a table for other programs.
#pragma once

#include <string>
#include <vector>

#include "experiment/store.h"

namespace springgrasp {

// CSV, one row per finished trial, sorted by identity: id, case, demonstration, baseline,
// repetition, seed, outcome, phase, message, then every measurement that any trial has, by name.
// The same bytes whatever the number of jobs or their order, unless `timings` adds wall_<stage>_s.
std::string ExportCsv(std::vector<StoredTrial> trials, bool timings);

}  // namespace springgrasp
