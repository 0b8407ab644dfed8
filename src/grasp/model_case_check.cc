#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "grasp/model_case.h"
#include "grasp/model_case_input.h"

namespace springgrasp {
namespace {

// Compares two values of the same structure number by number; `entry` receives the largest
// difference (NaN differences become infinite).
void LargestDifference(const JsonKey& expected, const Json& computed, double& largest,
                       double& largest_expected) {
  if (computed.is_array()) {
    ThrowUnless(expected.value().is_array() && expected.value().size() == computed.size(),
                "{}: {} entries, {} were computed", expected.where(), expected.value().size(),
                computed.size());
    if (computed.empty()) return;
    const std::vector<JsonKey> items = expected.Items();
    for (std::size_t i = 0; i < items.size(); ++i) {
      LargestDifference(items[i], computed[i], largest, largest_expected);
    }
    return;
  }
  const double e = expected.Number();
  const double c = computed.is_number() ? computed.get<double>() : std::nan("");
  const double difference = std::isfinite(c) ? std::abs(c - e) : HUGE_VAL;
  largest = std::max(largest, difference);
  largest_expected = std::max(largest_expected, std::abs(e));
}

// Largest difference of one key.
ModelCaseCheck::Entry Absolute(const JsonKey& expected, const Json& computed, const char* key,
                               double tolerance) {
  double largest = 0, size = 0;
  LargestDifference(expected[key], computed.at(key), largest, size);
  return {key, largest, tolerance};
}

// Largest difference relative to the largest expected number.
ModelCaseCheck::Entry Relative(const JsonKey& expected, const Json& computed, const char* key,
                               double tolerance) {
  double largest = 0, size = 0;
  LargestDifference(expected[key], computed.at(key), largest, size);
  return {key, size > 0 ? largest / size : largest, tolerance};
}

// rhs: |computed - expected| <= abs + rel |expected| for every number; the error is given relative
// to that bound, so its tolerance is 1.
double WorstOfBound(const JsonKey& expected, const Json& computed, double rel, double abs) {
  if (computed.is_array()) {
    ThrowUnless(expected.value().is_array() && expected.value().size() == computed.size(),
                "{}: {} entries, {} were computed", expected.where(), expected.value().size(),
                computed.size());
    double worst = 0;
    if (computed.empty()) return worst;
    const std::vector<JsonKey> items = expected.Items();
    for (std::size_t i = 0; i < items.size(); ++i) {
      worst = std::max(worst, WorstOfBound(items[i], computed[i], rel, abs));
    }
    return worst;
  }
  const double e = expected.Number();
  const double c = computed.is_number() ? computed.get<double>() : std::nan("");
  if (!std::isfinite(c)) return HUGE_VAL;
  return std::abs(c - e) / (abs + rel * std::abs(e));
}

std::vector<ModelCaseCheck::Entry> CompareRhs(const JsonKey& root, const Json& computed) {
  const double rel = root["tolerance"]["rel"].Number(0),
               abs = root["tolerance"]["abs"].Number(1e-300);
  const std::vector<JsonKey> states = root["expected"].Items();
  ThrowUnless(states.size() == computed.size(), "{}: {} states, {} were computed",
              root["expected"].where(), states.size(), computed.size());
  std::vector<ModelCaseCheck::Entry> entries;
  for (const char* key : {"x", "xdot", "xc", "s", "u", "R", "acc"}) {
    double worst = 0;
    for (std::size_t i = 0; i < states.size(); ++i) {
      worst = std::max(worst, WorstOfBound(states[i][key], computed[i].at(key), rel, abs));
    }
    entries.push_back({key, worst, 1.0});
  }
  return entries;
}

}  // namespace

ModelCaseCheck CheckModelCase(const Json& model_case, const Json& computed,
                              const std::string& name) {
  const JsonKey root(model_case, name);
  const JsonKey expected = root["expected"];
  const JsonKey tolerance = root["tolerance"];
  const std::string kind = root["kind"].Text();
  ModelCaseCheck check;
  auto& entries = check.entries;
  if (kind == "rhs") {
    entries = CompareRhs(root, computed);
  } else if (kind == "trajectory") {
    for (const char* key : {"p", "v"}) {
      entries.push_back(Absolute(expected, computed, key, tolerance[key].Number(0)));
    }
  } else if (kind == "dmp_rollout") {
    for (const char* key : {"x", "v", "a"}) {
      entries.push_back(Absolute(expected, computed, key, tolerance[key].Number(0)));
    }
  } else if (kind == "fcen") {
    for (const char* key : {"t_switch", "f"}) {
      entries.push_back(Absolute(expected, computed, key, tolerance["abs"].Number(0)));
    }
  } else if (kind == "dmp_learn") {
    entries.push_back(Relative(expected, computed, "weights", tolerance["weights_rel"].Number(0)));
  } else if (kind == "k_estimation") {
    const double rel = tolerance["k_rel"].Number(0);
    for (const char* key : {"k", "first_frame_rows_X", "first_frame_rhs", "singular_values"}) {
      entries.push_back(Relative(expected, computed, key, rel));
    }
  } else {
    Fail("{}: unknown kind '{}'", root["kind"].where(), kind);
  }
  check.passed = true;
  for (const ModelCaseCheck::Entry& entry : entries) {
    check.passed = check.passed && entry.error <= entry.tolerance;
    const double ratio = entry.error == 0 ? 0 : entry.error / entry.tolerance;
    if (check.worst_key.empty() || ratio > check.worst_ratio) {
      check.worst_ratio = ratio;
      check.worst_key = entry.key;
    }
  }
  return check;
}

}  // namespace springgrasp
