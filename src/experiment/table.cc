#include "experiment/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "experiment/wilson.h"

namespace springgrasp {
namespace {

struct Group {
  std::string name;
  int planned = 0, done = 0, succeeded = 0;
  std::map<Outcome, int> others;
};

// Groups in the order of their first trial.
std::vector<Group> GroupByCase(const std::vector<StoredTrial>& trials) {
  std::vector<Group> groups;
  for (const StoredTrial& trial : trials) {
    const std::string name = CaseLabel(trial.plan);
    auto group =
        std::find_if(groups.begin(), groups.end(), [&](const Group& g) { return g.name == name; });
    if (group == groups.end()) group = groups.insert(groups.end(), Group{name, 0, 0, 0, {}});
    ++group->planned;
    if (!trial.result) continue;
    ++group->done;
    if (trial.result->outcome == Outcome::kSuccess) {
      ++group->succeeded;
    } else {
      ++group->others[trial.result->outcome];
    }
  }
  return groups;
}

std::string Shown(const std::optional<double>& value) {
  return value ? fmt::format("{:.1f}", *value) : "-";
}

// The trials of one recording in one case.
struct Recording {
  std::string case_name, demonstration;
  std::vector<double> tracking, reproduction;  // mm
  std::map<std::string, int> outcomes, baseline;
};

std::string Counts(const std::map<std::string, int>& counts) {
  std::string text;
  for (const auto& [outcome, n] : counts) {
    if (!text.empty()) text += ", ";
    text += n == 1 && counts.size() == 1 ? outcome : fmt::format("{} {}", n, outcome);
  }
  return text.empty() ? "-" : text;
}

void AddTrial(Recording& recording, const StoredTrial& trial) {
  if (!trial.result) return;
  const bool baseline = trial.plan.baseline != "none";
  auto& counts = baseline ? recording.baseline : recording.outcomes;
  ++counts[std::string(OutcomeName(trial.result->outcome))];
  if (baseline) return;
  const auto& values = trial.result->values;
  if (const auto value = values.find("tracking_median_mm"); value != values.end()) {
    recording.tracking.push_back(value->second);
  }
  if (const auto value = values.find("reproduction_mm"); value != values.end()) {
    recording.reproduction.push_back(value->second);
  }
}

}  // namespace

std::string CaseLabel(const PlanRow& plan) {
  std::string baseline = plan.baseline;
  std::replace(baseline.begin(), baseline.end(), '_', ' ');
  return baseline == "none" ? plan.case_name : fmt::format("{} ({})", plan.case_name, baseline);
}

bool IsRecording(const PlanRow& plan) {
  return plan.demonstration != "synthesised" && plan.demonstration != "library";
}

std::optional<double> Median(std::vector<double> values) {
  if (values.empty()) return std::nullopt;
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n % 2 == 1 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

std::string AlignColumns(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  std::string text;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) line += fmt::format("{:<{}}  ", row[i], widths[i]);
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

std::string OutcomeTable(const std::vector<StoredTrial>& trials) {
  std::vector<std::vector<std::string>> rows = {
      {"case", "trials", "success", "95 % interval", "other outcomes"}};
  for (const Group& group : GroupByCase(trials)) {
    const RateInterval rate = WilsonInterval(group.succeeded, group.done);
    std::string others;
    for (const auto& [outcome, n] : group.others) {
      others += fmt::format("{}{} {}", others.empty() ? "" : ", ", n, OutcomeName(outcome));
    }
    rows.push_back({group.name, fmt::format("{}/{}", group.done, group.planned),
                    std::to_string(group.succeeded),
                    group.done == 0 ? "-" : fmt::format("{:.2f} to {:.2f}", rate.lower, rate.upper),
                    others.empty() ? "-" : others});
  }
  return AlignColumns(rows);
}

std::string RecordingTable(const std::vector<StoredTrial>& trials) {
  std::vector<Recording> recordings;
  for (const StoredTrial& trial : trials) {
    if (!IsRecording(trial.plan)) continue;
    auto recording = std::find_if(recordings.begin(), recordings.end(), [&](const Recording& r) {
      return r.case_name == trial.plan.case_name && r.demonstration == trial.plan.demonstration;
    });
    if (recording == recordings.end()) {
      recording = recordings.insert(recordings.end(), Recording{});
      recording->case_name = trial.plan.case_name;
      recording->demonstration = trial.plan.demonstration;
    }
    AddTrial(*recording, trial);
  }
  if (recordings.empty()) return "";
  std::vector<std::vector<std::string>> rows = {
      {"case", "recording", "tracking mm", "reproduction mm", "outcome", "of baselines"}};
  for (const Recording& r : recordings) {
    rows.push_back({r.case_name, r.demonstration, Shown(Median(r.tracking)),
                    Shown(Median(r.reproduction)), Counts(r.outcomes), Counts(r.baseline)});
  }
  return AlignColumns(rows);
}

}  // namespace springgrasp
