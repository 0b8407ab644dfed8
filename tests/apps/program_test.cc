// The program from outside: help, version, exit codes.
#include "apps/program.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <thread>

#include "apps/progress.h"
#include "base/files.h"
#include "experiment/runner.h"
#include "experiment/small_experiment.h"

namespace springgrasp {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

const std::vector<std::string> kCommands = {"run",     "replay",    "observe", "learn",  "generate",
                                            "library", "recognise", "perform", "grasp",  "status",
                                            "export",  "check",     "model",   "inspect"};

TEST(ProgramTest, EveryCommandIsListedAndShowsAnExampleOfItself) {
  const TemporaryFolder folder;
  const ProgramResult help = RunProgram("springgrasp --help", folder / ".");
  EXPECT_EQ(help.exit_code, 0);
  for (const std::string& command : kCommands) {
    EXPECT_THAT(help.out, HasSubstr("\n  " + command + " "));
    const ProgramResult own = RunProgram("springgrasp " + command + " --help", folder / ".");
    EXPECT_EQ(own.exit_code, 0);
    EXPECT_THAT(own.out, HasSubstr("build/release/bin/springgrasp " + command + " "));
  }
}

TEST(ProgramTest, OnAMeshTheBlendOfTwoGraspsBeginsAndEndsWithThem) {
  const TemporaryFolder folder;
  const std::string grasps = SourceFolder() + "/models/grasps/";
  const std::string object =
      " --object '0.4 0.5 1' --shape mesh:" + SourceFolder() + "/models/objects/meshes/apple.obj";
  const auto generated = [&](const std::string& arguments) {
    const ProgramResult result = RunProgram(
        "springgrasp generate " + grasps + arguments + object + " -o motion.csv", folder / ".");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    const std::string csv = ReadFile(folder / "motion.csv");
    return std::count(csv.begin(), csv.end(), '\n');
  };
  const auto pinch = generated("pinch.yaml"), power = generated("power.yaml");
  const std::string blend = "pinch.yaml --blend " + grasps + "power.yaml --part ";
  EXPECT_EQ(generated(blend + "0"), pinch);
  EXPECT_EQ(generated(blend + "1"), power);
  const auto between = generated(blend + "0.5");
  EXPECT_GT(between, std::min(pinch, power));
  EXPECT_LT(between, std::max(pinch, power));
}

TEST(ProgramTest, AMeshAndADemonstrationAreATrialThatPerformRepeats) {
  const TemporaryFolder folder;
  const ProgramResult own = RunProgram(
      "springgrasp grasp '" + SourceFolder() + "/tests/testdata/sim_wedge.obj' --demonstration '" +
          SourceFolder() + "/models/grasps/pinch.csv' --type pinch --mass 0.1 -o own",
      folder / ".");
  EXPECT_EQ(own.exit_code, 0) << own.err;
  EXPECT_THAT(own.out, HasSubstr("object taken for box:0.06x0.04x0.04"));
  EXPECT_THAT(own.out, HasSubstr("outcome: success"));
  RunProgram("springgrasp perform own/grasp.yaml --scene own/scene.yaml -o again", folder / ".");
  for (const char* file : {"outcome.yaml", "trajectory.csv", "motion.csv"}) {
    EXPECT_EQ(ReadFile(folder / "own/" + file), ReadFile(folder / "again/" + file)) << file;
  }
}

TEST(ProgramTest, AnMjcfOfOnesOwnKeepsItsMassAndFriction) {
  const TemporaryFolder folder;
  const std::string egg = SourceFolder() + "/models/objects/egg.xml";
  const auto performed = [&](const std::string& more) {
    const ProgramResult result =
        RunProgram("springgrasp grasp '" + egg + "' --demonstration '" + SourceFolder() +
                       "/models/grasps/pinch.csv' --type pinch -o own" + more,
                   folder / ".");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return ReadScene(folder / "own/scene.yaml").objects.at(0);
  };
  const ObjectFile file = ReadObjectFile(egg);
  EXPECT_EQ(performed("").mass, file.mass);
  EXPECT_EQ(performed("").friction, file.friction);
  EXPECT_EQ(performed(" --mass 0.2").mass, 0.2);
}

TEST(ProgramTest, VersionNamesProgramMujocoAndRenderer) {
  const TemporaryFolder folder;
  const ProgramResult result = RunProgram("springgrasp --version", folder / ".");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out, HasSubstr("springgrasp " SPRINGGRASP_VERSION));
  EXPECT_THAT(result.out, HasSubstr("MuJoCo 2."));
  EXPECT_THAT(result.out, HasSubstr("OSMesa"));
}

// A finished results directory made without physics.
void MakeResults(const TemporaryFolder& folder, const std::string& name) {
  const Experiment experiment = SmallExperiment(folder);
  const auto trials = ExpandExperiment(experiment);
  ResultStore store = ResultStore::OpenForRun(folder / name, DescribeRun(experiment, trials));
  RunTrials(trials, store,
            [](const TrialSpec& spec, const TrialOutput&) {
              TrialResult result;
              result.outcome = spec.repetition == 0 ? Outcome::kDiverged : Outcome::kSuccess;
              return result;
            },
            {});
}

TEST(ProgramTest, AFinishedRunIsNotRunAgainAndAnotherExperimentIsRefused) {
  const TemporaryFolder folder;
  MakeResults(folder, "out");
  const ProgramResult again = RunProgram("springgrasp run experiment.yaml -o out", folder / ".");
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_THAT(again.out, HasSubstr("light  5/5     4        0.38 to 0.96   1 diverged"));
  const ProgramResult quiet =
      RunProgram("springgrasp run experiment.yaml -o out --quiet", folder / ".");
  EXPECT_EQ(quiet.out + quiet.err, "");
  const ProgramResult other =
      RunProgram("springgrasp run experiment.yaml -o out --set seed=8", folder / ".");
  EXPECT_EQ(other.exit_code, 4);
  EXPECT_THAT(other.err, HasSubstr("another experiment"));
}

TEST(ProgramTest, StoppingEarlyIsExitCodeThree) {
  const TemporaryFolder folder;
  SmallExperiment(folder);
  const ProgramResult result =
      RunProgram("springgrasp run experiment.yaml -o out --limit 0", folder / ".");
  EXPECT_EQ(result.exit_code, 3) << result.err;
  EXPECT_THAT(RunProgram("springgrasp status out", folder / ".").out, HasSubstr("missing 10"));
}

TEST(ProgramTest, StatusExportAndCheckReadResults) {
  const TemporaryFolder folder;
  MakeResults(folder, "out");
  const ProgramResult status = RunProgram("springgrasp status out", folder / ".");
  EXPECT_EQ(status.exit_code, 0);
  EXPECT_THAT(status.out, HasSubstr("done 10  succeeded 8  failed 0  diverged 2"));
  EXPECT_EQ(RunProgram("springgrasp export out -o new/r.csv", folder / ".").exit_code, 0);
  EXPECT_THAT(ReadFile(folder / "new/r.csv"), HasSubstr("id,case,demonstration"));
  EXPECT_EQ(RunProgram("springgrasp check out e.yaml --record", folder / ".").exit_code, 0);
  EXPECT_EQ(RunProgram("springgrasp check out e.yaml", folder / ".").exit_code, 0);
  folder.Write("e.yaml", "cases: {light: {success_lower_bound: 0.9}}\n");
  const ProgramResult failed = RunProgram("springgrasp check out e.yaml", folder / ".");
  EXPECT_EQ(failed.exit_code, 1);
  EXPECT_THAT(failed.out, HasSubstr("FAILED"));
}

TEST(ProgramTest, InspectCountsTheRobotAndMeasuresItsDrives) {
  const TemporaryFolder folder;
  const std::string robot = SourceFolder() + "/models/armar3b/armar3b.xml";
  const ProgramResult whole = RunProgram("springgrasp inspect " + robot, folder / ".");
  EXPECT_EQ(whole.exit_code, 0) << whole.err;
  EXPECT_THAT(whole.out, HasSubstr("49 joints (49 degrees of freedom, 43 of them actuated)"));
  EXPECT_THAT(whole.out, HasSubstr("4 cameras, 179.973 kg"));
  EXPECT_THAT(whole.out, HasSubstr("right_arm     7 joints,  7 actuators   12.4294 kg"));
  EXPECT_THAT(whole.out, HasSubstr("right_hand   11 joints,  8 actuators    0.4500 kg"));
  EXPECT_THAT(whole.out, HasSubstr("left_hand    11 joints,  8 actuators    0.4500 kg"));
  folder.Write("hand.yaml", "active: [right_hand]\n");
  const ProgramResult drives =
      RunProgram("springgrasp inspect hand.yaml --drives drives.csv", folder / ".");
  EXPECT_EQ(drives.exit_code, 0) << drives.err;
  EXPECT_THAT(ReadFile(folder / "drives.csv"), HasSubstr("\nhand_r_ring_pinkie,"));
}

TEST(ProgramTest, ModelChecksACase) {
  const TemporaryFolder folder;
  const std::string model_case = SPRINGGRASP_TESTDATA_DIR "/model_case.json";
  EXPECT_EQ(RunProgram("springgrasp model " + model_case + " --check", folder / ".").exit_code, 0);
  std::string wrong = ReadFile(model_case);
  const auto at = wrong.find("\"t_switch\": 0.5");
  ASSERT_NE(at, std::string::npos);
  folder.Write("wrong.json", wrong.replace(at, 15, "\"t_switch\": 0.6"));
  const ProgramResult failed = RunProgram("springgrasp model wrong.json --check", folder / ".");
  EXPECT_EQ(failed.exit_code, 1) << failed.err;
}

TEST(ProgressTest, SaysHowFarHowFastAndHowLong) {
  RunProgress progress;
  progress.done = 30;
  progress.total = 120;
  progress.succeeded = 25;
  progress.now = 20;
  progress.seconds = 60;
  EXPECT_EQ(DescribeProgress(progress), "30/120  20.0 per minute  4:30 left  25 succeeded");
}

TEST(ProgramTest, InspectReachSaysWhetherEachObjectIsWithinReach) {
  const ProgramResult result =
      RunProgram("springgrasp inspect '" + SourceFolder() +
                     "/scenes/power_cylinder.yaml' --reach -o reach.png && "
                     "head -c 4 reach.png | tail -c 3; rm reach.png",
                 ::testing::TempDir());
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, ::testing::HasSubstr("cylinder at (0.39, 0.52, 1.04): within reach"));
  EXPECT_THAT(result.out, ::testing::EndsWith("PNG"));
}

}  // namespace
}  // namespace springgrasp
