// One grasp performed once: the folder that `perform` and `grasp` write.
#pragma once

#include <cstdint>
#include <string>

#include "apps/command.h"
#include "grasp/grasp.h"
#include "sim/scene.h"

namespace springgrasp {

struct PerformOnceOptions {
  std::string directory;  // of outcome.yaml, trajectory.csv and motion.csv
  std::string video;      // .mp4; empty: none
  std::string camera;     // of the video; empty: the scene's overview cameras
  std::uint64_t seed = 0;
};

// Adds --seed, --output, --video and --camera.
void AddPerformOnceOptions(CLI::App& command, PerformOnceOptions& options);

// Throws Error unless all that can be written; changes nothing.
void CheckOutputPaths(const PerformOnceOptions& options);

// Draws the object's pose, performs the grasp, writes and prints what came of it.
void PerformOnce(const Grasp& grasp, Scene scene, const PerformOnceOptions& options);

}  // namespace springgrasp
