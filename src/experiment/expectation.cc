#include "experiment/expectation.h"

#include <cmath>

#include "base/yaml_reader.h"
#include "experiment/table.h"
#include "experiment/wilson.h"

namespace springgrasp {
namespace {

// Errors of the chain that a recorded expectation holds.
constexpr const char* kRecordedErrors[] = {"tracking_median_mm", "reproduction_mm",
                                           "mapping_error_mm", "finger_error_mm"};

struct CaseResult {
  int planned = 0, done = 0, succeeded = 0;
  std::map<std::string, std::vector<double>> values;
};

std::map<std::string, CaseResult> ResultsByCase(const std::vector<StoredTrial>& trials) {
  std::map<std::string, CaseResult> cases;
  for (const StoredTrial& trial : trials) {
    CaseResult& c = cases[CaseLabel(trial.plan)];
    ++c.planned;
    if (!trial.result) continue;
    ++c.done;
    c.succeeded += trial.result->outcome == Outcome::kSuccess;
    for (const auto& [name, value] : trial.result->values) c.values[name].push_back(value);
  }
  return cases;
}

// As a YAML key, whatever the name holds.
std::string Quoted(const std::string& name) {
  std::string quoted = "'";
  for (const char c : name) quoted += c == '\'' ? std::string("''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace

Expectation ReadExpectation(const std::string& path) {
  Expectation expectation;
  YamlReader yaml = YamlReader::FromFile(path);
  yaml.Require("cases");
  YamlReader cases = yaml.Child("cases");
  for (const std::string& name : cases.Keys()) {
    CaseExpectation& expected = expectation[name];
    YamlReader c = cases.Child(name);
    c.Read("success_lower_bound", expected.success_lower_bound, {0, 1});
    YamlReader at_most = c.Child("at_most");
    for (const std::string& key : at_most.Keys()) at_most.Read(key, expected.at_most[key]);
    at_most.Finish();
    c.Finish();
  }
  cases.Finish();
  yaml.Finish();
  ThrowUnless(!expectation.empty(), "{}: cases is empty, nothing would be checked", path);
  return expectation;
}

std::string RecordExpectation(const std::vector<StoredTrial>& trials) {
  std::string text = "cases:\n";
  for (const auto& [name, c] : ResultsByCase(trials)) {
    ThrowUnless(c.done == c.planned, "case '{}' has only {} of {} trials; finish the run first",
                name, c.done, c.planned);
    const double bound = WilsonInterval(c.succeeded, c.done).lower;
    text += fmt::format("  {}:\n    success_lower_bound: {:.3f}\n", Quoted(name),
                        std::floor(bound * 1000) / 1000);
    std::string errors;
    for (const char* error : kRecordedErrors) {
      const auto values = c.values.find(error);
      if (values == c.values.end()) continue;
      errors += fmt::format("      {}: {:.3g}\n", error, 1.2 * *Median(values->second));
    }
    if (!errors.empty()) text += "    at_most:\n" + errors;
  }
  return text;
}

CheckReport CheckExpectation(const Expectation& expectation,
                             const std::vector<StoredTrial>& trials) {
  CheckReport report;
  std::map<std::string, CaseResult> cases = ResultsByCase(trials);
  std::vector<std::vector<std::string>> rows = {{"case", "what", "expected", "found", ""}};
  const auto add = [&](const std::string& name, const std::string& what,
                       const std::string& expected, const std::string& found, bool ok) {
    rows.push_back({name, what, expected, found, ok ? "ok" : "FAILED"});
    report.ok = report.ok && ok;
  };
  for (const auto& [name, expected] : expectation) {
    const CaseResult& c = cases[name];
    add(name, "trials", c.planned == 0 ? "at least 1" : std::to_string(c.planned),
        std::to_string(c.done), c.planned > 0 && c.done == c.planned);
    const double bound = WilsonInterval(c.succeeded, c.done).lower;
    add(name, "success, lower bound", fmt::format(">= {:.3f}", expected.success_lower_bound),
        fmt::format("{:.3f}", bound), c.done > 0 && bound >= expected.success_lower_bound);
    for (const auto& [measurement, limit] : expected.at_most) {
      const auto values = c.values.find(measurement);
      const bool measured = values != c.values.end();
      const double median = measured ? *Median(values->second) : 0;
      add(name, "median " + measurement, fmt::format("<= {:.4g}", limit),
          measured ? fmt::format("{:.4g}", median) : "not measured", measured && median <= limit);
    }
  }
  report.table = AlignColumns(rows);
  return report;
}

}  // namespace springgrasp
