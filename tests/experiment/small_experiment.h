// A scene and experiment that parse in no time, in a folder of their own; for tests of the runner.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "experiment/experiment.h"

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

// A fresh folder, removed at the end of the test.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "springgrasp_XXXXXX").string();
    path_ = mkdtemp(pattern.data());
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  std::string Write(const std::string& name, const std::string& content) const {
    std::ofstream(path_ / name) << content;
    return *this / name;
  }

 private:
  std::filesystem::path path_;
};

// Parses `text` as if it lay in `folder`, beside the small scene.
inline Experiment SmallExperiment(const TemporaryFolder& folder,
                                  const std::string& text = kSmallExperiment,
                                  const std::vector<std::string>& overrides = {}) {
  folder.Write("scene.yaml", kSmallScene);
  return ReadExperiment(folder.Write("experiment.yaml", text), overrides);
}

}  // namespace springgrasp
