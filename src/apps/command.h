// Commands of the program: each adds itself to the command line and sets the exit code.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "base/pose.h"

namespace springgrasp {

// What the program ends with (README, "Commands").
enum ExitCode : int {
  kDone = 0,
  kCheckFailed = 1,
  kBadInput = 2,
  kStoppedEarly = 3,
  kForeignDirectory = 4,
};

// Each `exit_code` outlives the app.
void AddRunCommand(CLI::App& app, int& exit_code);
void AddObserveCommand(CLI::App& app, int& exit_code);
void AddLearnCommand(CLI::App& app, int& exit_code);
void AddGenerateCommand(CLI::App& app, int& exit_code);
void AddPerformCommand(CLI::App& app, int& exit_code);
void AddGraspCommand(CLI::App& app, int& exit_code);
void AddReplayCommand(CLI::App& app, int& exit_code);
void AddStatusCommand(CLI::App& app, int& exit_code);
void AddExportCommand(CLI::App& app, int& exit_code);
void AddCheckCommand(CLI::App& app, int& exit_code);
void AddModelCommand(CLI::App& app, int& exit_code);
void AddLibraryCommand(CLI::App& app, int& exit_code);
void AddRecogniseCommand(CLI::App& app, int& exit_code);
void AddInspectCommand(CLI::App& app, int& exit_code);

// A subcommand whose help ends with an example that can be pasted at the repository root. The
// program's path in it is `build/release/bin/springgrasp`.
CLI::App* AddCommand(CLI::App& app, const std::string& name, const std::string& description,
                     const std::string& example_arguments);

// Throws Error unless a file can be written there: it is no folder, and its own folder exists or
// can be made. For checks before long work starts; changes nothing. An empty path passes.
void CheckOutputPath(const std::string& path);

// Makes the folder of an output file where it is missing. An empty path is left alone.
void MakeFolderOf(const std::string& path);

// Reads `x y z qw qx qy qz` (or `x y z`); `option` names it in messages. Throws Error.
Pose ParsePose(const std::string& text, const std::string& option);

}  // namespace springgrasp
