// The name of a trial: a hash of everything that its outcome depends on.
#pragma once

#include <string>

#include "experiment/trial_spec.h"

namespace springgrasp {

// All effective parameters, one `key: value` line each, the scene's text last. Case name and what
// is recorded are left out: they change no outcome.
std::string CanonicalText(const TrialSpec& spec);

// 64-bit FNV-1a hash of CanonicalText, 16 hexadecimal digits.
std::string TrialIdentity(const TrialSpec& spec);

}  // namespace springgrasp
