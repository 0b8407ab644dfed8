// Plans kept from trial to trial.
#pragma once

#include <map>
#include <string>
#include <utility>

#include "experiment/plan_grasp.h"

namespace springgrasp {

// Plans of the trials that share the last key: what is planned depends on it and on the posture
// from which the robot sets out, one number for each that is tried.
class PlanMemory {
 public:
  // The plan from a posture: the kept one, or what `make()` returns. The reference holds until a
  // call with another key. An empty key keeps nothing for the next call.
  template <typename Make>
  const PlanResult& Get(const std::string& key, int posture, const Make& make) {
    if (key.empty() || key != key_) plans_.clear();
    key_ = key;
    const auto found = plans_.find(posture);
    if (found != plans_.end()) return found->second;
    return plans_.emplace(posture, make()).first->second;
  }

 private:
  std::string key_;
  std::map<int, PlanResult> plans_;
};

}  // namespace springgrasp
