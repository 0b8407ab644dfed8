// Results as tables for people.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiment/store.h"

namespace springgrasp {

// One line per case (and baseline): trials done of planned, successes with their 95 % Wilson
// interval, and how often each other outcome occurred.
std::string OutcomeTable(const std::vector<StoredTrial>& trials);

// One line per recorded demonstration: median tracking error against what was shown, error of the
// reproduced fingertips, outcome, and beside it the outcome with a constant open hand. Empty if no
// trial used a recording.
std::string RecordingTable(const std::vector<StoredTrial>& trials);

// "power", or "power (open hand)" for a baseline.
std::string CaseLabel(const PlanRow& plan);

// Whether the trial's demonstration is a file of its own, whose name the plan carries.
bool IsRecording(const PlanRow& plan);

// Middle value, or mean of the two middle ones; absent for none.
std::optional<double> Median(std::vector<double> values);

// Columns padded to their widest cell, two blanks between; the first row is the header.
std::string AlignColumns(const std::vector<std::vector<std::string>>& rows);

}  // namespace springgrasp
