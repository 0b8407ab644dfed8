#include "experiment/trial_observe.h"

#include <gmock/gmock.h>

#include "base/files.h"
#include "experiment/export.h"
#include "experiment/runner.h"
#include "experiment/small_experiment.h"
#include "experiment/trial.h"
#include "experiment/trial_identity.h"

namespace springgrasp {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

constexpr const char* kTracking =
    "name: tracking\n"
    "seed: 7\n"
    "repetitions: 1\n"
    "cases:\n"
    "  - name: plain\n"
    "    scene: scene.yaml\n"
    "    grasp: pinch\n"
    "    until: observe\n"
    "    set: {demonstrator.fps: 10}\n"
    "    variations: {demonstrator.distance: [0.55, 0.65]}\n"
    "record: {trajectories: all}\n";

std::string RunInto(const Experiment& experiment, const std::string& directory, int limit) {
  const std::vector<PlannedTrial> trials = ExpandExperiment(experiment);
  ResultStore store = ResultStore::OpenForRun(directory, DescribeRun(experiment, trials));
  RunOptions options;
  options.limit = limit;
  RunTrials(trials, store, RunTrial, options);
  return ExportCsv(store.Trials(), false);
}

TEST(ObserveTrialTest, IsMeasuredStoredAndResumedLikeAnyOther) {
  const TemporaryFolder folder;
  const Experiment experiment = SmallExperiment(folder, kTracking);
  const std::string at_once = RunInto(experiment, folder / "one", -1);
  EXPECT_THAT(RunInto(experiment, folder / "two", 1), HasSubstr("demonstrator.distance=0.55"));
  EXPECT_EQ(RunInto(experiment, folder / "two", -1), at_once);
  EXPECT_EQ(std::count(at_once.begin(), at_once.end(), '\n'), 3);
  for (const char* name : {",success,observe,", "tip_median_mm", "index_95_mm", "hand_median_deg",
                           "swap_frames", "coverage", "epipolar_px", "frames"}) {
    EXPECT_THAT(at_once, HasSubstr(name));
  }
  EXPECT_EQ(at_once.find("reproduction"), std::string::npos) << "nothing is learned";
  for (const PlannedTrial& trial : ExpandExperiment(experiment)) {
    const std::string record = folder / ("one/trials/" + trial.id + "/tracking.csv");
    EXPECT_EQ(ReadFile(record).rfind("t,thumb_m,index_m,", 0), 0u);
  }
}

TEST(ObserveTrialTest, HasAnIdentityOfItsOwnAndLeavesThatOfOthersAlone) {
  TrialSpec spec;
  const std::string performed = CanonicalText(spec);
  EXPECT_EQ(performed.find("until"), std::string::npos);
  spec.until = "observe";
  EXPECT_NE(CanonicalText(spec), performed);
}

TEST(ObserveTrialTest, WhatIsNotFoundIsUntracked) {
  const TemporaryFolder folder;
  folder.Write("scene.yaml", kSmallScene);
  TrialSpec spec;
  spec.until = "observe";
  spec.scene = ReadScene(folder / "scene.yaml");
  spec.scene.demonstrator.fps = 5;
  spec.scene.demonstrator.X_WO =
      MakePose({0, -3, 1}, Eigen::Quaterniond::Identity());  // behind the robot
  const TrialResult result = RunTrial(spec, {});
  EXPECT_EQ(result.outcome, Outcome::kUntracked);
  EXPECT_THAT(result.message, HasSubstr("no five fingertip markers"));
  EXPECT_EQ(result.values.at("coverage"), 0);
}

}  // namespace
}  // namespace springgrasp
