#include "experiment/replay.h"

#include <gmock/gmock.h>

#include <cmath>

#include "base/error.h"
#include "base/files.h"
#include "experiment/film_outcomes.h"
#include "experiment/small_experiment.h"

namespace springgrasp {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TrialResult FakeTrial(const TrialSpec& spec, const TrialOutput&) {
  if (spec.repetition == 3) throw Error("two\nlines");
  TrialResult result;
  result.outcome = Outcome::kSuccess;
  result.phase = "done";
  result.values["slip_mm"] = std::sqrt(spec.scene.objects[0].mass + spec.repetition);
  result.values["never"] = std::nan("");
  return result;
}

class ReplayTest : public testing::Test {
 protected:
  ResultStore Run(int limit = -1) {
    const Experiment experiment = SmallExperiment(folder_);
    ResultStore store = ResultStore::OpenForRun(
        folder_ / "out", DescribeRun(experiment, ExpandExperiment(experiment)));
    RunOptions options;
    options.limit = limit;
    RunTrials(ExpandExperiment(experiment), store, FakeTrial, options);
    return store;
  }

  template <typename Function>
  static std::string ErrorOf(const Function& function) {
    try {
      function();
    } catch (const Error& e) {
      return e.what();
    }
    return "no error";
  }

  TemporaryFolder folder_;
};

TEST_F(ReplayTest, EveryTrialIsTheSameAgain) {
  ResultStore store = Run();
  for (const StoredTrial& stored : store.Trials()) {
    const PlannedTrial planned = PlanAgain(store, FindTrial(store, stored.plan.id));
    EXPECT_THAT(Differences(*stored.result, RunAgain(planned, FakeTrial)), IsEmpty());
  }
}

TEST_F(ReplayTest, TheBeginningOfAnIdentityIsEnough) {
  ResultStore store = Run();
  const std::string id = store.Trials()[4].plan.id;
  EXPECT_EQ(FindTrial(store, id.substr(0, 12)).plan.id, id);
  EXPECT_EQ(FindTrial(store, "light:4").plan.id, id);
}

TEST_F(ReplayTest, TheLastBitCounts) {
  TrialResult a, b;
  a.outcome = b.outcome = Outcome::kSuccess;
  a.values["slip_mm"] = 1;
  b.values["slip_mm"] = std::nextafter(1, 2);
  EXPECT_THAT(Differences(a, b), ElementsAre(HasSubstr("slip_mm: recorded '1'")));
  b.values["slip_mm"] = 1;
  b.values["more"] = 0;
  a.message = "lost";
  a.phase = "hold";
  a.outcome = Outcome::kDroppedHold;
  EXPECT_THAT(Differences(a, b),
              ElementsAre("outcome: recorded 'dropped_hold', now 'success'",
                          "phase: recorded 'hold', now ''", "message: recorded 'lost', now ''",
                          "more: recorded 'absent', now '0'"));
}

TEST_F(ReplayTest, SaysWhyATrialCannotBeFound) {
  ResultStore store = Run(2);
  EXPECT_THAT(ErrorOf([&] { FindTrial(store, "xyz"); }), HasSubstr("no trial 'xyz'"));
  EXPECT_THAT(ErrorOf([&] { FindTrial(store, ""); }), HasSubstr("no trial ''"));
  EXPECT_THAT(ErrorOf([&] { FindTrial(store, store.Trials()[7].plan.id); }),
              HasSubstr("has not been run yet"));
}

TEST_F(ReplayTest, AChangedSceneIsToldOf) {
  ResultStore store = Run();
  const StoredTrial stored = store.Trials()[0];
  WriteFileAtomically(folder_ / "scene.yaml", std::string(kSmallScene) + "max_finger_force: 3\n");
  EXPECT_THAT(ErrorOf([&] { PlanAgain(store, stored); }), HasSubstr("has changed since"));
}

// Of each condition the first success and the first failure are filmed, once.
TEST_F(ReplayTest, FilmsTheFirstOfEachOutcome) {
  ResultStore store = Run();
  const std::vector<PlannedTrial> planned = ExpandExperiment(SmallExperiment(folder_));
  const auto ids = [&] {
    std::vector<std::string> found;
    for (const PlannedTrial& trial : TrialsToFilm(planned, store.Trials(), folder_ / "out")) {
      found.push_back(trial.id);
    }
    return found;
  };
  EXPECT_THAT(ids(), ElementsAre(planned[0].id, planned[3].id, planned[5].id, planned[8].id));
  const TrialFunction filmed = [](const TrialSpec& spec, const TrialOutput& output) {
    EXPECT_TRUE(output.video);
    WriteFileAtomically(output.folder + "/grasp.mp4", "film");
    return FakeTrial(spec, output);
  };
  EXPECT_TRUE(FilmTrials(TrialsToFilm(planned, store.Trials(), folder_ / "out"), store.Trials(),
                         folder_ / "out", filmed, [] { return false; }));
  EXPECT_THAT(ids(), IsEmpty());
}

}  // namespace
}  // namespace springgrasp
