// Options of the command line that say where a recorded stereo video is and what is in it.
#pragma once

#include <vector>

#include "apps/command.h"
#include "apps/observe_recorded.h"

namespace springgrasp {

// Adds --left to --hand. Returns those that tell nothing without a video.
std::vector<CLI::Option*> AddRecordedOptions(CLI::App& command, ObserveRecordedOptions& options);

bool AnyGiven(const std::vector<CLI::Option*>& options);

// Whether a video was asked for. Throws Error if only a part of what it needs was named.
bool IsRecorded(const ObserveRecordedOptions& options);

}  // namespace springgrasp
