// Every shipped experiment parses and expands.
#include <gmock/gmock.h>

#include <filesystem>

#include "base/files.h"
#include "experiment/experiment.h"

namespace springgrasp {
namespace {

namespace fs = std::filesystem;

TEST(ExperimentsTest, EveryShippedExperimentIsValid) {
  int found = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(SourceFolder()) / "experiments")) {
    // The figures of the paper: generated, not performed.
    if (!entry.is_directory() || entry.path().filename() == "paper") continue;
    SCOPED_TRACE(entry.path().string());
    ++found;
    EXPECT_TRUE(fs::exists(entry.path() / "README.md"));
    const Experiment experiment = ReadExperiment(entry.path().string());
    EXPECT_EQ(experiment.name, entry.path().filename().string());
    bool needs_folder = false;
    for (const ExperimentCase& c : experiment.cases) {
      needs_folder = needs_folder || !c.demonstration.match.empty();
    }
    if (!needs_folder || !experiment.demonstrations.empty()) {
      EXPECT_FALSE(ExpandExperiment(experiment).empty());
    }
  }
  EXPECT_GE(found, 2);
}

TEST(ExperimentsTest, RecordedGraspsTakeEveryRecordingOfTheFolder) {
  const std::string folder = std::string(SPRINGGRASP_SHARED_DIR) + "/demonstrations";
  if (!fs::is_directory(folder)) {
    GTEST_SKIP() << "the folder of recordings " << folder << " is not there";
  }
  int recordings = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    recordings += entry.path().extension() == ".csv";
  }
  const Experiment experiment =
      ReadExperiment("recorded_grasps", {"demonstrations='" + folder + "'"});
  const auto trials = ExpandExperiment(experiment);
  EXPECT_EQ(trials.size(), 2u * static_cast<unsigned>(recordings * experiment.repetitions));
}

}  // namespace
}  // namespace springgrasp
