// The bare mathematics of the model, evaluated on a case in JSON (format
// fingertip-springs-golden-1): reference files, and anything a user wants to compare with.
//
// kinds: rhs, trajectory, fcen, dmp_learn, dmp_rollout, k_estimation. Of `expected` only t
// (trajectory, dmp_rollout) and p, v, f (rhs) are read; `params.weights` is ignored in dmp_learn.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace springgrasp {

using Json = nlohmann::json;

// What was computed, under the same keys as `expected`. `name` stands for the file in messages.
// Throws Error naming file and key for anything missing, of the wrong type or size.
Json EvaluateModelCase(const Json& model_case, const std::string& name);

// Comparison with the case's own `expected` by its own `tolerance`.
struct ModelCaseCheck {
  struct Entry {
    std::string key;   // of `expected`
    double error = 0;  // largest, absolute or relative as the tolerance is meant
    double tolerance = 0;
  };
  std::vector<Entry> entries;
  bool passed = false;
  // Largest error in units of its tolerance, and the key it occurred at.
  double worst_ratio = 0;
  std::string worst_key;
};

// Throws Error if `expected` lacks a key that was computed, or the tolerance is missing.
ModelCaseCheck CheckModelCase(const Json& model_case, const Json& computed,
                              const std::string& name);

// Reads and parses a case file. Throws Error with file and position.
Json ReadModelCase(const std::string& path);

}  // namespace springgrasp
