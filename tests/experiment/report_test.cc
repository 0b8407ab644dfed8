#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "base/error.h"
#include "experiment/expectation.h"
#include "experiment/table.h"
#include "experiment/wilson.h"

namespace springgrasp {
namespace {

using testing::HasSubstr;

StoredTrial Trial(const std::string& name, int repetition, Outcome outcome, double tracking_mm) {
  StoredTrial trial;
  trial.plan.id = name + std::to_string(repetition);
  trial.plan.case_name = name;
  trial.plan.demonstration = "synthesised";
  trial.plan.repetition = repetition;
  trial.result = TrialResult{};
  trial.result->outcome = outcome;
  trial.result->values["tracking_median_mm"] = tracking_mm;
  return trial;
}

std::vector<StoredTrial> TenTrials(int successes) {
  std::vector<StoredTrial> trials;
  for (int i = 0; i < 10; ++i) {
    trials.push_back(
        Trial("power", i, i < successes ? Outcome::kSuccess : Outcome::kDroppedHold, 1 + 0.1 * i));
  }
  return trials;
}

CheckReport CheckAgainst(const std::string& text, const std::vector<StoredTrial>& trials) {
  const auto path = std::filesystem::temp_directory_path() /
                    ("springgrasp_expect_" + std::to_string(getpid()) + ".yaml");
  std::ofstream(path) << text;
  Expectation expectation;
  try {
    expectation = ReadExpectation(path.string());
  } catch (...) {
    std::filesystem::remove(path);
    throw;
  }
  std::filesystem::remove(path);
  return CheckExpectation(expectation, trials);
}

// Values of Newcombe (1998), table I: 81 of 263 and 0 of 20.
TEST(WilsonTest, AgreesWithPublishedIntervals) {
  EXPECT_NEAR(WilsonInterval(81, 263).lower, 0.2553, 5e-5);
  EXPECT_NEAR(WilsonInterval(81, 263).upper, 0.3662, 5e-5);
  EXPECT_NEAR(WilsonInterval(0, 20).lower, 0.0, 1e-12);
  EXPECT_NEAR(WilsonInterval(0, 20).upper, 0.1611, 5e-5);
  EXPECT_EQ(WilsonInterval(0, 0).upper, 1);
}

TEST(TableTest, CountsOutcomesPerCase) {
  std::vector<StoredTrial> trials = TenTrials(8);
  trials.push_back(trials.back());
  trials.back().result.reset();
  const std::string table = OutcomeTable(trials);
  EXPECT_THAT(table, HasSubstr("power  10/11   8        0.49 to 0.94   2 dropped_hold"));
  EXPECT_EQ(RecordingTable(trials), "");
}

TEST(TableTest, SetsTheOpenHandBesideEachRecording) {
  StoredTrial shown = Trial("pinch", 0, Outcome::kSuccess, 2.5);
  shown.plan.demonstration = "pinch_20mm_1";
  StoredTrial open = Trial("pinch", 0, Outcome::kMissed, 0);
  open.plan.demonstration = "pinch_20mm_1";
  open.plan.baseline = "open_hand";
  EXPECT_THAT(RecordingTable({shown, open}),
              HasSubstr("pinch  pinch_20mm_1  2.5          -                success  missed"));
  EXPECT_THAT(OutcomeTable({shown, open}), HasSubstr("pinch (open hand)"));
}

TEST(ExpectationTest, ARecordedRunPassesAndAWorseOneFails) {
  const std::string recorded = RecordExpectation(TenTrials(9));
  EXPECT_TRUE(CheckAgainst(recorded, TenTrials(9)).ok);
  EXPECT_TRUE(CheckAgainst(recorded, TenTrials(10)).ok);
  const CheckReport worse = CheckAgainst(recorded, TenTrials(8));
  EXPECT_FALSE(worse.ok);
  EXPECT_THAT(worse.table, HasSubstr("FAILED"));
  std::vector<StoredTrial> blurred = TenTrials(9);
  for (StoredTrial& trial : blurred) trial.result->values["tracking_median_mm"] += 5;
  EXPECT_FALSE(CheckAgainst(recorded, blurred).ok);
}

TEST(ExpectationTest, MissingTrialsOrCasesFallShort) {
  const std::string recorded = RecordExpectation(TenTrials(9));
  std::vector<StoredTrial> unfinished = TenTrials(10);
  unfinished[3].result.reset();
  EXPECT_FALSE(CheckAgainst(recorded, unfinished).ok);
  EXPECT_FALSE(CheckAgainst(recorded, {}).ok);
  EXPECT_THROW(RecordExpectation(unfinished), Error);
  EXPECT_THROW(CheckAgainst("cases: {power: {success: 1}}\n", TenTrials(9)), Error);
}

}  // namespace
}  // namespace springgrasp
