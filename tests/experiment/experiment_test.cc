#include "experiment/experiment.h"

#include <gmock/gmock.h>

#include <map>
#include <set>

#include "base/error.h"
#include "experiment/small_experiment.h"
#include "experiment/trial_identity.h"
#include "grasp/library.h"

namespace springgrasp {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string MessageOf(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& e) {
    return e.what();
  }
  return "(no error)";
}

std::set<std::string> Ids(const Experiment& experiment) {
  std::set<std::string> ids;
  for (const PlannedTrial& trial : ExpandExperiment(experiment)) ids.insert(trial.id);
  return ids;
}

TEST(ExperimentTest, ExpandsToEveryCaseAndRepetition) {
  const TemporaryFolder folder;
  const auto trials = ExpandExperiment(SmallExperiment(folder));
  ASSERT_EQ(trials.size(), 10u);
  EXPECT_EQ(trials[0].spec.case_name, "light");
  EXPECT_EQ(trials[9].spec.case_name, "heavy");
  EXPECT_EQ(trials[9].spec.repetition, 4);
  EXPECT_DOUBLE_EQ(trials[0].spec.scene.objects[0].mass, 0.1);
  EXPECT_DOUBLE_EQ(trials[9].spec.scene.objects[0].mass, 0.5);
  EXPECT_EQ(Ids(SmallExperiment(folder)).size(), 10u);
}

TEST(ExperimentTest, IdentityFollowsWhatMattersAndNothingElse) {
  const TemporaryFolder folder;
  const auto ids = Ids(SmallExperiment(folder));
  const std::string text = kSmallExperiment;
  EXPECT_EQ(Ids(SmallExperiment(folder, text + "record: {videos: all}\n")), ids);
  EXPECT_EQ(Ids(SmallExperiment(folder, "# a comment\n" + text, {"name=renamed"})), ids);
  for (const std::string change :
       {"seed=8", "criteria.hold=1.5", "substitute=[tracks]", "cases.0.dim=2",
        "cases.0.profile=paper", "cases.0.grasp=power"}) {
    EXPECT_NE(Ids(SmallExperiment(folder, text, {change})), ids) << change;
  }
  folder.Write("scene.yaml", std::string("# a comment\n") + kSmallScene);
  EXPECT_EQ(Ids(ReadExperiment(folder / "experiment.yaml")), ids);
}

TEST(ExperimentTest, MoreRepetitionsOrCasesChangeNoOtherTrial) {
  const TemporaryFolder folder;
  const auto ids = Ids(SmallExperiment(folder));
  const auto more = Ids(SmallExperiment(folder, kSmallExperiment, {"repetitions=6"}));
  EXPECT_EQ(more.size(), 12u);
  EXPECT_TRUE(std::includes(more.begin(), more.end(), ids.begin(), ids.end()));
}

TEST(ExperimentTest, VariationsMakeAGrid) {
  const TemporaryFolder folder;
  const auto trials = ExpandExperiment(SmallExperiment(
      folder,
      "name: grid\nseed: 1\ncases:\n  - name: c\n    scene: scene.yaml\n    grasp: pinch\n"
      "    variations: {objects.0.mass: [0.1, 0.2, 0.3], physics.impratio: [5, 10]}\n"));
  ASSERT_EQ(trials.size(), 6u);
  EXPECT_EQ(trials[0].spec.case_name, "c objects.0.mass=0.1 physics.impratio=5");
  EXPECT_DOUBLE_EQ(trials[5].spec.scene.objects[0].mass, 0.3);
  EXPECT_DOUBLE_EQ(trials[5].spec.scene.physics.impratio, 10);
}

TEST(ExperimentTest, EveryCaseIsTriedUnderEveryCondition) {
  const TemporaryFolder folder;
  const std::string text =
      "name: crossed\nseed: 1\nconditions:\n"
      "  - {name: as it is}\n"
      "  - {name: heavy, set: {objects.0.mass: 0.4}, substitute: [arm]}\n"
      "cases:\n"
      "  - {name: a, scene: scene.yaml, grasp: pinch, set: {objects.0.mass: 0.2}}\n"
      "  - {name: b, scene: scene.yaml, grasp: pinch, substitute: [contacts]}\n";
  const auto trials = ExpandExperiment(SmallExperiment(folder, text));
  ASSERT_EQ(trials.size(), 4u);
  EXPECT_EQ(trials[0].spec.case_name, "a, as it is");
  EXPECT_DOUBLE_EQ(trials[0].spec.scene.objects[0].mass, 0.2);
  EXPECT_EQ(trials[1].spec.case_name, "a, heavy");
  EXPECT_DOUBLE_EQ(trials[1].spec.scene.objects[0].mass, 0.4);
  EXPECT_THAT(trials[3].spec.substitute, testing::ElementsAre("arm", "contacts"));

  const auto message = [&](const std::string& replaced, const std::string& by) {
    std::string bad = text;
    bad.replace(bad.find(replaced), replaced.size(), by);
    return MessageOf([&] { SmallExperiment(folder, bad); });
  };
  EXPECT_THAT(message("heavy", "as it is"), HasSubstr("a second condition"));
  EXPECT_THAT(message("name: heavy, ", ""), HasSubstr("name"));
  EXPECT_THAT(message("[arm]", "[legs]"), HasSubstr("finger_joints"));
}

TEST(ExperimentTest, AGraspBetweenTwoOfTheLibraryIsOfTheNearersType) {
  const TemporaryFolder folder;
  const auto text = [](const std::string& type, const std::string& part) {
    return "name: between\nseed: 1\ncases:\n"
           "  - {name: a, scene: scene.yaml, grasp: " +
           type +
           ", demonstration: {kind: library, file: power.yaml, blend: tripod.yaml, part: " + part +
           "}}\n";
  };
  const auto some = ExpandExperiment(SmallExperiment(folder, text("power", "0.25")));
  EXPECT_EQ(some[0].spec.blend_part, 0.25);
  EXPECT_NE(some[0].id, ExpandExperiment(SmallExperiment(folder, text("power", "0.3")))[0].id);
  EXPECT_EQ(ExpandExperiment(SmallExperiment(folder, text("tripod", "0.75"))).size(), 1u);
  const auto message = [&](const std::string& type, const std::string& part) {
    return MessageOf([&] { ExpandExperiment(SmallExperiment(folder, text(type, part))); });
  };
  EXPECT_THAT(message("power", "0.75"), HasSubstr("a tripod grasp"));
  EXPECT_THAT(message("power", "1.5"), HasSubstr("part is 1.5"));
}

constexpr const char* kSampled =
    "name: sampled\nseed: 1\nrepetitions: 200\ncases:\n"
    "  - name: c\n    scene: scene.yaml\n    grasp: pinch\n    sampling: random\n"
    "    sample: {objects.0.mass: [0.1, 0.5], objects.0.friction: [0.6, 1.2]}\n";

TEST(ExperimentTest, EveryRepetitionDrawsItsSample) {
  const TemporaryFolder folder;
  for (const char* sampling : {"random", "sobol"}) {
    const auto trials = ExpandExperiment(
        SmallExperiment(folder, kSampled, {std::string("cases.0.sampling=") + sampling}));
    std::set<double> masses;
    double sum = 0;
    for (const PlannedTrial& trial : trials) {
      const SceneObject& object = trial.spec.scene.objects[0];
      EXPECT_GE(object.mass, 0.1);
      EXPECT_LT(object.mass, 0.5);
      EXPECT_EQ(trial.spec.drawn[0], std::make_pair(std::string("objects.0.mass"), object.mass));
      masses.insert(object.mass);
      sum += object.friction;
    }
    EXPECT_EQ(masses.size(), 200u);
    EXPECT_NEAR(sum / 200, 0.9, sampling[0] == 's' ? 0.01 : 0.04) << sampling;
  }
}

TEST(ExperimentTest, ASobolSampleFillsEveryPartEvenly) {
  const TemporaryFolder folder;
  ExperimentCase c = SmallExperiment(folder, kSampled).cases[0];
  c.sampling = "sobol";
  std::map<std::pair<int, int>, int> cells;  // 8 x 8 of them
  for (int r = 0; r < 256; ++r) {
    const std::vector<double> x = DrawSample(c, 5, r);
    ++cells[{int((x[0] - 0.1) / 0.05), int((x[1] - 0.6) / 0.075)}];
  }
  EXPECT_EQ(cells.size(), 64u);
  for (const auto& [cell, n] : cells) EXPECT_LE(n, 9);
}

TEST(ExperimentTest, OneMoreSampledKeyLeavesTheOtherDrawsAlone) {
  const TemporaryFolder folder;
  const ExperimentCase both = SmallExperiment(folder, kSampled).cases[0];
  ExperimentCase one = both;
  one.sample.erase(one.sample.begin());
  EXPECT_EQ(DrawSample(both, 3, 17)[1], DrawSample(one, 3, 17)[0]);
}

TEST(ExperimentTest, TrialsThatSeeTheSameStandInOneGroup) {
  const TemporaryFolder folder;
  const auto trials = ExpandExperiment(SmallExperiment(
      folder,
      "name: grid\nseed: 1\nrepetitions: 2\ncases:\n  - name: c\n    scene: scene.yaml\n"
      "    grasp: pinch\n    variations: {physics.impratio: [5, 10], objects.0.mass: [0.1, 0.2]}\n"
      "  - {name: d, scene: scene.yaml, grasp: pinch, set: {demonstrator.speed: 0.4}}\n"));
  ASSERT_EQ(trials.size(), 10u);
  std::map<std::uint64_t, int> groups;
  for (const PlannedTrial& trial : trials) ++groups[trial.group];
  EXPECT_EQ(groups.size(), 4u);  // two repetitions of each case
  EXPECT_EQ(groups[trials[0].group], 4);
}

TEST(ExperimentTest, OpenHandStandsBesideEachTrialWithTheSameDraws) {
  const TemporaryFolder folder;
  const auto trials =
      ExpandExperiment(SmallExperiment(folder, kSmallExperiment, {"baselines=[open_hand]"}));
  ASSERT_EQ(trials.size(), 20u);
  EXPECT_EQ(trials[2].spec.baseline, "none");
  EXPECT_EQ(trials[3].spec.baseline, "open_hand");
  EXPECT_EQ(trials[2].spec.repetition, trials[3].spec.repetition);
  EXPECT_NE(trials[2].id, trials[3].id);
}

constexpr const char* kFromLibrary =
    "name: shipped\nseed: 1\ncases:\n  - name: c\n    scene: scene.yaml\n    grasp: pinch\n"
    "    demonstration: {kind: library}\n";

TEST(ExperimentTest, AGraspOfTheLibraryIsPerformedWithoutSeeingIt) {
  const TemporaryFolder folder;
  const auto trials = ExpandExperiment(SmallExperiment(folder, kFromLibrary));
  ASSERT_EQ(trials.size(), 1u);
  EXPECT_EQ(trials[0].spec.demonstration, "library");
  EXPECT_EQ(trials[0].spec.grasp_file, ShippedLibrary() + "/pinch.yaml");
  const auto seen = ExpandExperiment(
      SmallExperiment(folder, kFromLibrary, {"cases.0.demonstration.kind=synthesised"}));
  EXPECT_NE(trials[0].id, seen[0].id);
  EXPECT_NE(trials[0].group, 0u);
}

TEST(ExperimentTest, ALibraryThatDoesNotFitIsAnError) {
  const TemporaryFolder folder;
  const auto expand = [&](const std::vector<std::string>& overrides) {
    return ExpandExperiment(SmallExperiment(folder, kFromLibrary, overrides));
  };
  EXPECT_THROW(expand({"cases.0.demonstration.file=power.yaml"}), Error);
  EXPECT_THROW(expand({"cases.0.demonstration.file=none.yaml"}), Error);
  EXPECT_THROW(expand({"cases.0.until=observe"}), Error);
  EXPECT_THROW(expand({"baselines=[open_hand]"}), Error);
  EXPECT_THROW(expand({"baselines=[springs]"}), Error);
  EXPECT_EQ(expand({"baselines=[playback, interpolation]"}).size(), 3u);
}

TEST(ExperimentTest, ACaseReplacesStagesBesideTheExperiments) {
  const TemporaryFolder folder;
  const auto trials = ExpandExperiment(SmallExperiment(
      folder, kFromLibrary, {"substitute=[tracks]", "cases.0.substitute=[arm, tracks]"}));
  EXPECT_EQ(trials[0].spec.substitute, (std::vector<std::string>{"arm", "tracks"}));
  EXPECT_THROW(SmallExperiment(folder, kFromLibrary, {"cases.0.substitute=[eyes]"}), Error);
}

TEST(ExperimentTest, RecordsOnePerCaseWhereAsked) {
  const TemporaryFolder folder;
  int videos = 0;
  for (const auto& trial :
       ExpandExperiment(SmallExperiment(folder, kSmallExperiment, {"record={videos: one}"}))) {
    videos += trial.output.video;
  }
  EXPECT_EQ(videos, 2);
}

constexpr const char* kRecording = R"(# frame: recording
t,wrist_x,wrist_y,wrist_z,wrist_qw,wrist_qx,wrist_qy,wrist_qz,thumb_x,thumb_y,thumb_z,index_x,index_y,index_z,middle_x,middle_y,middle_z,ring_x,ring_y,ring_z,pinkie_x,pinkie_y,pinkie_z
)";

std::string Recording(double z) {
  std::string text = kRecording;
  for (int i = 0; i < 20; ++i) {
    text +=
        fmt::format("{},,,,,,,,{},0,{},{},0.05,0.1,,,,,,,,,\n", 0.01 * i, 0.01 * i, z, 0.01 * i);
  }
  return text;
}

TEST(ExperimentTest, TakesEveryMatchingRecordingAndItsDepth) {
  const TemporaryFolder folder;
  folder.Write("pinch_30mm_1.csv", Recording(0.1));
  folder.Write("pinch_20mm_1.csv", Recording(0.2));
  folder.Write("other.csv", Recording(0.3));
  const std::string text =
      "name: recorded\nseed: 1\ndemonstrations: .\ncases:\n"
      "  - name: pinch\n    scene: scene.yaml\n    grasp: pinch\n"
      "    demonstration: {kind: recorded, match: 'pinch_*.csv'}\n"
      "    set: {objects.0.shape: 'box:{depth}x0.04x0.1'}\n";
  const auto trials = ExpandExperiment(SmallExperiment(folder, text));
  ASSERT_EQ(trials.size(), 2u);
  EXPECT_EQ(trials[0].spec.demonstration, "pinch_20mm_1");
  EXPECT_DOUBLE_EQ(trials[0].spec.scene.objects[0].shape->size.x(), 0.02);
  EXPECT_EQ(trials[0].spec.scene.demonstrator.kind, "recorded");
  EXPECT_EQ(trials[0].spec.scene.demonstrator.file, folder / "pinch_20mm_1.csv");

  // The content of the recording is part of the identity, the folder it lies in is not.
  const auto before = Ids(SmallExperiment(folder, text));
  folder.Write("pinch_30mm_1.csv", Recording(0.15));
  EXPECT_NE(Ids(SmallExperiment(folder, text)), before);
  const TemporaryFolder moved;
  moved.Write("pinch_30mm_1.csv", Recording(0.1));
  moved.Write("pinch_20mm_1.csv", Recording(0.2));
  EXPECT_EQ(Ids(SmallExperiment(moved, text)), before);
}

TEST(ExperimentTest, BadInputSaysWhereAndWhatWouldBeValid) {
  const TemporaryFolder folder;
  const std::string text = kSmallExperiment;
  const auto message = [&](const std::string& content, std::vector<std::string> overrides = {}) {
    return MessageOf([&] { ExpandExperiment(SmallExperiment(folder, content, overrides)); });
  };
  EXPECT_THAT(message(text + "sead: 3\n"),
              AllOf(HasSubstr("experiment.yaml:7"), HasSubstr("sead"), HasSubstr("seed")));
  EXPECT_THAT(message(text, {"repetitions=0"}), HasSubstr("repetitions is 0"));
  EXPECT_THAT(message(text, {"seed=1.5"}), HasSubstr("seed is 1.5"));
  EXPECT_THAT(message(text, {"cases.0.grasp=punch"}), HasSubstr("pinch, tripod, power, lateral"));
  EXPECT_THAT(message(text, {"criteria.hold=-1"}), HasSubstr("criteria.hold is -1"));
  EXPECT_THAT(message(text, {"substitute=[truth]"}), HasSubstr("object_pose"));
  EXPECT_THAT(message(text, {"cases.1.set={}"}), HasSubstr("hold the same trial"));
  EXPECT_THAT(message(text, {"cases.1.set={objects.0.mass: -1}"}), HasSubstr("mass is -1"));
  EXPECT_THAT(message(text, {"cases.1.set={objects.0.wait: 1}"}),
              HasSubstr("unknown key 'objects[0].wait'"));
  EXPECT_THAT(message(text, {"cases.1.scene=nowhere.yaml"}), HasSubstr("nowhere.yaml"));
  EXPECT_THAT(message(text, {"cases.0.demonstration={kind: recorded}"}), HasSubstr("match"));
  EXPECT_THAT(message(text, {"cases.0.demonstration={kind: recorded, match: '*.csv'}"}),
              HasSubstr("--set demonstrations="));
  EXPECT_THAT(message(text, {"cases.0.name=heavy"}), HasSubstr("a second case"));
  EXPECT_THAT(message(""), HasSubstr("empty"));
  EXPECT_THAT(MessageOf([] { ReadExperiment("no/such/experiment"); }),
              HasSubstr("no such experiment"));
}

}  // namespace
}  // namespace springgrasp
