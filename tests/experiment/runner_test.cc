#include "experiment/runner.h"

#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "base/error.h"
#include "experiment/fake_run.h"
#include "experiment/result_codec.h"

namespace springgrasp {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

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
  EXPECT_EQ(ResultStore::OpenForReading(folder / "out").FinishedIds().size(), 3u)
      << "the third had begun when the second was stored";
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

TEST(RunnerTest, ATrialWhoseFilesCannotBeWrittenIsNoRowAndRunsAgain) {
  const TemporaryFolder folder;
  const Experiment experiment =
      SmallExperiment(folder, kSmallExperiment, {"record={trajectories: all}"});
  const auto full = [](const TrialSpec& spec, const TrialOutput& output) {
    if (spec.repetition == 3) throw NotWritten("trajectory.csv: no room");
    return FakeTrial(spec, output);
  };
  try {
    RunInto(experiment, folder / "out", {}, full);
    FAIL() << "went on without the file";
  } catch (const NotWritten& e) {
    EXPECT_STREQ(e.what(), "trajectory.csv: no room");
  }
  EXPECT_EQ(ResultStore::OpenForReading(folder / "out").FinishedIds().size(), 6u);
  EXPECT_EQ(RunInto(experiment, folder / "out"), RunEnd::kComplete);
  RunInto(experiment, folder / "whole");
  EXPECT_EQ(Exported(folder / "out"), Exported(folder / "whole"));
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
