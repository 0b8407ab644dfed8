// What an observation and a plan depend on, so that trials which share one need it but once.
#pragma once

#include <string>

#include "experiment/trial_spec.h"

namespace springgrasp {

// Equal for two trials if and only if their cameras see the same demonstration: seed, repetition
// and the scene's text without physics, drives, masses, frictions and beliefs.
std::string ObservationKey(const TrialSpec& spec);

// Likewise for what is learned from it.
std::string LearningKey(const TrialSpec& spec);

// Equal for two trials if and only if they differ at most in physics and drives, which no plan
// knows.
std::string PlanKey(const TrialSpec& spec);

}  // namespace springgrasp
