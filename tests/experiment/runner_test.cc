#include "experiment/runner.h"

#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <thread>

#include "base/error.h"
#include "base/files.h"
#include "experiment/export.h"
#include "experiment/result_codec.h"
#include "experiment/small_experiment.h"

namespace springgrasp {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

// Depends on the trial alone, not on time or process.
TrialResult FakeTrial(const TrialSpec& spec, const TrialOutput& output) {
  TrialResult result;
  result.outcome = spec.repetition % 2 == 0 ? Outcome::kSuccess : Outcome::kMissed;
  result.phase = "done";
  result.message = spec.repetition % 2 == 0 ? "" : "index, \"the finger\",\nhas no contact";
  result.values["slip_mm"] = std::sqrt(spec.scene.objects[0].mass + spec.repetition);
  if (spec.repetition == 2) result.values["rare"] = -std::numeric_limits<double>::infinity();
  result.values["never"] = std::nan("");
  result.wall_s["perform"] = 1.25;
  if (!output.folder.empty()) WriteFileAtomically(output.folder + "/trajectory.csv", "t\n");
  return result;
}

TrialResult SlowTrial(const TrialSpec& spec, const TrialOutput& output) {
  std::this_thread::sleep_for(std::chrono::milliseconds(15));
  return FakeTrial(spec, output);
}

ResultStore OpenStore(const Experiment& experiment, const std::string& directory) {
  return ResultStore::OpenForRun(directory, DescribeRun(experiment, ExpandExperiment(experiment)));
}

RunEnd RunInto(const Experiment& experiment, const std::string& directory, RunOptions options = {},
               const TrialFunction& trial = FakeTrial) {
  ResultStore store = OpenStore(experiment, directory);
  return RunTrials(ExpandExperiment(experiment), store, trial, options);
}

std::string Exported(const std::string& directory) {
  return ExportCsv(ResultStore::OpenForReading(directory).Trials(), false);
}

TEST(RunnerTest, ExportIsTheSameWhateverTheJobs) {
  const TemporaryFolder folder;
  const Experiment experiment = SmallExperiment(folder);
  RunOptions two;
  two.jobs = 2;
  EXPECT_EQ(RunInto(experiment, folder / "one"), RunEnd::kComplete);
  EXPECT_EQ(RunInto(experiment, folder / "two", two, SlowTrial), RunEnd::kComplete);
  const std::string csv = Exported(folder / "one");
  EXPECT_EQ(csv, Exported(folder / "two"));
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 11);
  EXPECT_THAT(csv, HasSubstr(",missed,done,\"index, \"\"the finger\"\", has no contact\",,"));
  EXPECT_THAT(csv, HasSubstr("-inf"));
  EXPECT_EQ(csv.find("never"), std::string::npos);
  EXPECT_EQ(csv.find("wall"), std::string::npos);
  const auto trials = ResultStore::OpenForReading(folder / "one").Trials();
  EXPECT_THAT(ExportCsv(trials, true), HasSubstr("wall_perform_s"));
}

TEST(RunnerTest, LimitStopsEarlyAndTheNextRunGoesOn) {
  const TemporaryFolder folder;
  const Experiment experiment = SmallExperiment(folder);
  RunOptions three;
  three.limit = 3;
  EXPECT_EQ(RunInto(experiment, folder / "out", three), RunEnd::kStoppedEarly);
  EXPECT_EQ(ResultStore::OpenForReading(folder / "out").FinishedIds().size(), 3u);
  int run_now = 0;
  RunOptions rest;
  rest.on_progress = [&](const RunProgress& progress) { run_now = progress.now; };
  EXPECT_EQ(RunInto(experiment, folder / "out", rest), RunEnd::kComplete);
  EXPECT_EQ(run_now, 7);
  RunInto(experiment, folder / "whole");
  EXPECT_EQ(Exported(folder / "out"), Exported(folder / "whole"));
}

TEST(RunnerTest, StopRequestFinishesTheRunningTrials) {
  const TemporaryFolder folder;
  int done = 0;
  RunOptions options;
  options.on_progress = [&](const RunProgress& progress) { done = progress.done; };
  options.stop_requested = [&] { return done >= 2; };
  EXPECT_EQ(RunInto(SmallExperiment(folder), folder / "out", options), RunEnd::kStoppedEarly);
  EXPECT_EQ(ResultStore::OpenForReading(folder / "out").FinishedIds().size(), 2u);
}

TEST(RunnerTest, SurvivesBeingKilledAtAnyMoment) {
  const TemporaryFolder folder;
  const Experiment experiment = SmallExperiment(folder);
  RunInto(experiment, folder / "whole");
  for (const int milliseconds : {5, 30, 60, 90}) {
    const pid_t child = fork();
    if (child == 0) {
      RunInto(experiment, folder / "out", {}, SlowTrial);
      _exit(0);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
  }
  EXPECT_EQ(RunInto(experiment, folder / "out"), RunEnd::kComplete);
  EXPECT_EQ(Exported(folder / "out"), Exported(folder / "whole"));
}

TEST(RunnerTest, FailingAndDyingTrialsAreRows) {
  const TemporaryFolder folder;
  const auto trial = [](const TrialSpec& spec, const TrialOutput& output) {
    if (spec.repetition == 1) Fail("no grasp for you");
    if (spec.repetition == 2) kill(getpid(), SIGKILL);
    if (spec.repetition == 3) _exit(5);
    return FakeTrial(spec, output);
  };
  RunOptions two;
  two.jobs = 2;
  EXPECT_EQ(RunInto(SmallExperiment(folder), folder / "out", two, trial), RunEnd::kComplete);
  for (const StoredTrial& stored : ResultStore::OpenForReading(folder / "out").Trials()) {
    ASSERT_TRUE(stored.result);
    const std::vector<std::string> expected = {"", "no grasp for you", "signal 9", "code 5", ""};
    const std::string& part = expected.at(stored.plan.repetition);
    EXPECT_EQ(stored.result->outcome == Outcome::kError, !part.empty());
    if (!part.empty()) {
      EXPECT_THAT(stored.result->message, HasSubstr(part));
    }
  }
}

TEST(RunnerTest, RecordedFilesAppearUnderTheTrialsIdentity) {
  const TemporaryFolder folder;
  const Experiment experiment =
      SmallExperiment(folder, kSmallExperiment, {"record={trajectories: one}"});
  RunInto(experiment, folder / "out");
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder / "out/trials")) {
    names.insert(entry.path().filename());
    EXPECT_TRUE(fs::exists(entry.path() / "trajectory.csv"));
  }
  const auto trials = ExpandExperiment(experiment);
  EXPECT_EQ(names, (std::set<std::string>{trials[0].id, trials[5].id}));
}

TEST(StoreTest, RefusesAnotherExperimentAndLeavesItAlone) {
  const TemporaryFolder folder;
  RunInto(SmallExperiment(folder), folder / "out");
  const std::string before = ReadFile(folder / "out/results.sqlite");
  EXPECT_THROW(OpenStore(SmallExperiment(folder, kSmallExperiment, {"seed=8"}), folder / "out"),
               ForeignDirectory);
  Experiment changed = SmallExperiment(folder);
  folder.Write("scene.yaml", std::string(kSmallScene) + "max_finger_force: 3\n");
  EXPECT_THROW(OpenStore(changed, folder / "out"), ForeignDirectory);
  EXPECT_EQ(ReadFile(folder / "out/results.sqlite"), before);
}

TEST(StoreTest, RefusesAnotherBehaviourVersion) {
  const TemporaryFolder folder;
  const Experiment experiment = SmallExperiment(folder);
  RunInto(experiment, folder / "out");
  Database(folder / "out/results.sqlite", Database::Mode::kCreate)
      .Execute("UPDATE meta SET value = '0' WHERE key = 'behaviour_version'");
  EXPECT_THROW(OpenStore(experiment, folder / "out"), ForeignDirectory);
}

TEST(StoreTest, RefusesFoldersThatAreNotItsOwn) {
  const TemporaryFolder folder;
  const Experiment experiment = SmallExperiment(folder);
  fs::create_directory(folder / "full");
  folder.Write("full/letter.txt", "dear reader");
  EXPECT_THROW(OpenStore(experiment, folder / "full"), Error);
  EXPECT_THROW(OpenStore(experiment, folder.Write("file", "")), Error);
  EXPECT_THROW(ResultStore::OpenForReading(folder / "full"), Error);
  RunInto(experiment, folder / "cut");
  fs::resize_file(folder / "cut/results.sqlite", 3000);
  EXPECT_THROW(RunInto(experiment, folder / "cut"), Error);
  EXPECT_EQ(fs::file_size(folder / "cut/results.sqlite"), 3000u);
}

TEST(StoreTest, KeepsOneRunAtATime) {
  const TemporaryFolder folder;
  const Experiment experiment = SmallExperiment(folder);
  const ResultStore first = OpenStore(experiment, folder / "out");
  const pid_t other = fork();
  if (other == 0) {
    try {
      OpenStore(experiment, folder / "out");
    } catch (const Error& e) {
      _exit(std::string(e.what()).find("another run") == std::string::npos ? 2 : 1);
    }
    _exit(0);
  }
  int status = 0;
  waitpid(other, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 1);
}

TEST(ResultCodecTest, IsExactAndRefusesWhatIsCutShort) {
  TrialResult result;
  result.outcome = Outcome::kSlipped;
  result.message = "far";
  result.values = {{"a", 0.1}, {"b", -0.0}};
  result.wall_s = {{"x", 1e-300}};
  const std::string bytes = EncodeResult(result);
  const TrialResult back = DecodeResult(bytes);
  EXPECT_EQ(back.outcome, result.outcome);
  EXPECT_EQ(back.message, result.message);
  EXPECT_EQ(back.values, result.values);
  EXPECT_EQ(back.wall_s, result.wall_s);
  for (std::size_t n = 0; n < bytes.size(); ++n) {
    EXPECT_THROW(DecodeResult(std::string_view(bytes).substr(0, n)), Error);
  }
}

}  // namespace
}  // namespace springgrasp
