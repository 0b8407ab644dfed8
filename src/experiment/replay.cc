#include "experiment/replay.h"

#include <bit>
#include <cmath>
#include <cstdint>

#include "base/error.h"
#include "experiment/runner_worker.h"

namespace springgrasp {
namespace {

std::string Describe(const std::map<std::string, double>& values, const std::string& name) {
  const auto found = values.find(name);
  return found == values.end() ? "absent" : fmt::format("{}", found->second);
}

// What is not a number is stored as absent.
bool Same(const std::map<std::string, double>& a, const std::map<std::string, double>& b,
          const std::string& name) {
  const auto bits = [&](const std::map<std::string, double>& values) {
    const auto found = values.find(name);
    return found == values.end() || std::isnan(found->second)
               ? std::bit_cast<std::uint64_t>(std::nan(""))
               : std::bit_cast<std::uint64_t>(found->second);
  };
  return bits(a) == bits(b);
}

std::string NameOf(const PlanRow& plan) {
  return fmt::format("{}:{}", plan.case_name, plan.repetition);
}

void CompareText(const std::string& what, const std::string& stored, const std::string& now,
                 std::vector<std::string>& differences) {
  if (stored == now) return;
  differences.push_back(fmt::format("{}: recorded '{}', now '{}'", what, stored, now));
}

}  // namespace

StoredTrial FindTrial(ResultStore& store, const std::string& trial) {
  std::vector<StoredTrial> found;
  for (StoredTrial& stored : store.Trials()) {
    if (stored.plan.id.rfind(trial, 0) == 0 || NameOf(stored.plan) == trial) {
      found.push_back(std::move(stored));
    }
  }
  ThrowUnless(!trial.empty() && !found.empty(),
              "{}: no trial '{}'; expected an identity as in the column id of `export`, or "
              "<case>:<repetition>",
              store.directory(), trial);
  ThrowUnless(found.size() == 1, "{}: '{}' may be any of {} trials, for example {} or {}",
              store.directory(), trial, found.size(), found[0].plan.id, found.back().plan.id);
  ThrowUnless(found[0].result.has_value(), "{}: trial {} has not been run yet", store.directory(),
              found[0].plan.id);
  return found[0];
}

PlannedTrial PlanAgain(ResultStore& store, const StoredTrial& stored) {
  const std::string source = store.Meta("source");
  const Experiment experiment = ParseExperiment(store.Meta("experiment"), source);
  for (PlannedTrial& planned : ExpandExperiment(experiment)) {
    if (planned.id == stored.plan.id) return planned;
  }
  Fail("{}: trial {} ({} {}) cannot be run again: a scene or demonstration of {} has changed since",
       store.directory(), stored.plan.id, stored.plan.case_name, stored.plan.repetition, source);
}

TrialResult RunAgain(const PlannedTrial& planned, const TrialFunction& run_trial,
                     const TrialOutput& output) {
  TrialResult result = ResultOrError([&] { return run_trial(planned.spec, output); });
  if (result.not_written) throw NotWritten(result.message);
  return result;
}

std::vector<std::string> Differences(const TrialResult& stored, const TrialResult& now) {
  std::vector<std::string> differences;
  CompareText("outcome", std::string(OutcomeName(stored.outcome)),
              std::string(OutcomeName(now.outcome)), differences);
  CompareText("phase", stored.phase, now.phase, differences);
  CompareText("message", stored.message, now.message, differences);
  std::map<std::string, double> all = stored.values;
  all.insert(now.values.begin(), now.values.end());
  for (const auto& [name, value] : all) {
    if (Same(stored.values, now.values, name)) continue;
    CompareText(name, Describe(stored.values, name), Describe(now.values, name), differences);
  }
  return differences;
}

}  // namespace springgrasp
