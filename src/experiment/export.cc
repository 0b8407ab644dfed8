#include "experiment/export.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace springgrasp {
namespace {

std::string Quoted(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + "\"";
}

void AppendValues(std::string& row, const std::map<std::string, double>& values,
                  const std::set<std::string>& names) {
  for (const std::string& name : names) {
    const auto value = values.find(name);
    row += value == values.end() ? "," : fmt::format(",{:.17g}", value->second);
  }
}

}  // namespace

std::string ExportCsv(std::vector<StoredTrial> trials, bool timings) {
  std::sort(trials.begin(), trials.end(),
            [](const StoredTrial& a, const StoredTrial& b) { return a.plan.id < b.plan.id; });
  std::set<std::string> names, stages;
  for (const StoredTrial& trial : trials) {
    if (!trial.result) continue;
    for (const auto& [name, value] : trial.result->values) names.insert(name);
    if (!timings) continue;
    for (const auto& [stage, seconds] : trial.result->wall_s) stages.insert(stage);
  }
  std::string csv = "id,case,demonstration,baseline,repetition,seed,outcome,phase,message";
  for (const std::string& name : names) csv += fmt::format(",{}", Quoted(name));
  for (const std::string& stage : stages)
    csv += fmt::format(",{}", Quoted(fmt::format("wall_{}_s", stage)));
  csv += "\n";
  for (const StoredTrial& trial : trials) {
    if (!trial.result) continue;
    csv += fmt::format("{},{},{},{},{},{},{},{},{}", trial.plan.id, Quoted(trial.plan.case_name),
                       Quoted(trial.plan.demonstration), trial.plan.baseline, trial.plan.repetition,
                       trial.plan.seed, OutcomeName(trial.result->outcome),
                       Quoted(trial.result->phase), Quoted(trial.result->message));
    AppendValues(csv, trial.result->values, names);
    AppendValues(csv, trial.result->wall_s, stages);
    csv += "\n";
  }
  return csv;
}

}  // namespace springgrasp
