// A scene and experiment that parse in no time, in a folder of their own; for tests of the runner.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "experiment/experiment.h"
#include "temporary_folder.h"

namespace springgrasp {

inline constexpr const char* kSmallScene =
    "objects:\n"
    "  - {name: ball, shape: 'sphere:0.04', mass: 0.1, pose: [0.35, 0.5]}\n";

inline constexpr const char* kSmallExperiment =
    "name: small\n"
    "seed: 7\n"
    "repetitions: 5\n"
    "cases:\n"
    "  - {name: light, scene: scene.yaml, grasp: pinch}\n"
    "  - {name: heavy, scene: scene.yaml, grasp: pinch, set: {objects.0.mass: 0.5}}\n";

// Parses `text` as if it lay in `folder`, beside the small scene.
inline Experiment SmallExperiment(const TemporaryFolder& folder,
                                  const std::string& text = kSmallExperiment,
                                  const std::vector<std::string>& overrides = {}) {
  folder.Write("scene.yaml", kSmallScene);
  return ReadExperiment(folder.Write("experiment.yaml", text), overrides);
}

}  // namespace springgrasp
