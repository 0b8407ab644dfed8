// A trial's result as bytes, for the way from a worker process to the runner.
#pragma once

#include <string>
#include <string_view>

#include "experiment/trial_result.h"

namespace springgrasp {

std::string EncodeResult(const TrialResult& result);
// Exact reverse. Throws Error for bytes that EncodeResult did not write.
TrialResult DecodeResult(std::string_view bytes);

}  // namespace springgrasp
