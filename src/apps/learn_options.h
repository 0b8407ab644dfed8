// Options of the command line that say how a demonstration is learned from.
#pragma once

#include "apps/command.h"
#include "grasp/learn.h"

namespace springgrasp {

// Adds --type, --dim, --profile and --hand-length.
void AddLearnOptions(CLI::App& command, LearnOptions& options);

}  // namespace springgrasp
