// Bad input: one clear line on stderr, exit code 2, nothing written.
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "apps/program.h"
#include "base/files.h"
#include "experiment/small_experiment.h"

namespace springgrasp {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

constexpr const char* kHeader =
    "t,wrist_x,wrist_y,wrist_z,wrist_qw,wrist_qx,wrist_qy,wrist_qz,thumb_x,thumb_y,thumb_z,"
    "index_x,index_y,index_z,middle_x,middle_y,middle_z,ring_x,ring_y,ring_z,pinkie_x,pinkie_y,"
    "pinkie_z\n";

struct Row {
  std::string t, thumb_x = "0.1";
  bool with_index = true;
};

std::string DemonstrationText(const std::vector<Row>& rows) {
  std::string text = kHeader;
  for (const Row& row : rows) {
    text += row.t + ",,,,,,,," + row.thumb_x + ",0.2,0.3,";
    text += row.with_index ? "0.2,0.2,0.3,,,,,,,,,\n" : ",,,,,,,,,,,\n";
  }
  return text;
}

std::vector<Row> SoundRows(int n = 60) {
  std::vector<Row> rows;
  for (int i = 0; i < n; ++i) {
    const double s = i / 59.0;
    const double x = 0.1 + 0.3 * s * s * s * (10 - 15 * s + 6 * s * s);
    rows.push_back({std::to_string(i * 0.02), std::to_string(x), true});
  }
  return rows;
}

class BadInputTest : public testing::Test {
 protected:
  // The command must fail with one line that holds `part`, and leave the folder as it was.
  void ExpectRefused(const std::string& command, const std::string& part) {
    SCOPED_TRACE(command);
    const auto before = Files();
    const ProgramResult result = RunProgram(command, Path());
    EXPECT_EQ(result.exit_code, 2) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_THAT(result.err, HasSubstr(part));
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(Files(), before);
  }

  std::vector<std::string> Files() const {
    std::vector<std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(Path())) {
      files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    return files;
  }

  std::string Path() const { return folder_ / "."; }
  void Write(const std::string& name, const std::string& text) { folder_.Write(name, text); }

  TemporaryFolder folder_;
};

TEST_F(BadInputTest, Usage) {
  ExpectRefused("springgrasp", "subcommand");
  ExpectRefused("springgrasp rum", "there is no command 'rum'");
  ExpectRefused("springgrasp run", "experiment is required");
  ExpectRefused("springgrasp run first_grasps -o out --jobs 0", "jobs");
  ExpectRefused("springgrasp run first_grasps -o out --set seed", "key=value");
  ExpectRefused("springgrasp run first_grasps -o out --set sed=1", "sed");
  ExpectRefused("springgrasp learn x.csv --type punch -o g.yaml", "punch");
}

TEST_F(BadInputTest, MissingFiles) {
  ExpectRefused("springgrasp run nowhere.yaml -o out", "nowhere.yaml: no such");
  ExpectRefused("springgrasp observe nowhere.yaml -o demo.csv", "nowhere.yaml: no such");
  ExpectRefused("springgrasp learn nowhere.csv --type pinch -o g.yaml", "nowhere.csv: no such");
  ExpectRefused("springgrasp generate nowhere.yaml --object '0 0 0' --shape sphere:0.04 -o m.csv",
                "nowhere.yaml: no such");
  ExpectRefused("springgrasp perform nowhere.yaml --scene nowhere.yaml -o out",
                "nowhere.yaml: no such");
  ExpectRefused("springgrasp perform '" + SourceFolder() +
                    "/experiments/first_grasps/pinch.yaml' --scene nowhere.yaml -o out",
                "nowhere.yaml: no such");
  ExpectRefused("springgrasp inspect nowhere.xml", "nowhere.xml");
  ExpectRefused("springgrasp model nowhere.json", "nowhere.json: no such");
  ExpectRefused("springgrasp status nowhere", "nowhere: no results");
  ExpectRefused("springgrasp export nowhere -o r.csv", "nowhere: no results");
  ExpectRefused("springgrasp check nowhere e.yaml", "nowhere: no results");
  Write("experiment.yaml", kSmallExperiment);
  ExpectRefused("springgrasp run experiment.yaml -o out", "there is no 'scene.yaml'");
  ExpectRefused("springgrasp run recorded_grasps -o out --set demonstrations=nowhere",
                "no such folder");
}

TEST_F(BadInputTest, EmptyFiles) {
  for (const char* name : {"e.yaml", "e.csv", "e.json", "e.xml"}) Write(name, "");
  ExpectRefused("springgrasp run e.yaml -o out", "e.yaml: the file is empty");
  ExpectRefused("springgrasp observe e.yaml -o demo.csv", "e.yaml: the file is empty");
  ExpectRefused("springgrasp generate e.yaml --object '0 0 0' --shape sphere:0.04 -o m.csv",
                "e.yaml: the file is empty");
  ExpectRefused("springgrasp inspect e.yaml", "e.yaml: the file is empty");
  ExpectRefused("springgrasp learn e.csv --type pinch -o g.yaml", "e.csv");
  ExpectRefused("springgrasp model e.json", "e.json");
  ExpectRefused("springgrasp inspect e.xml", "e.xml");
}

TEST_F(BadInputTest, NamesThatAModelLacks) {
  const std::string hand = SourceFolder() + "/models/mmm_hand/mmm_hand_r.xml";
  const std::string robot = SourceFolder() + "/models/armar3b/armar3b.xml";
  ExpectRefused("springgrasp inspect " + hand + " --drives d.csv", "needs a model with valves");
  ExpectRefused("springgrasp inspect " + robot + " --keyframe waving -o p.png", "waving");
  ExpectRefused("springgrasp inspect " + robot + " --camera eye_m -o p.png", "eye_m");
}

TEST_F(BadInputTest, MalformedYaml) {
  Write("m.yaml", "objects:\n  - {name: ball\n");
  ExpectRefused("springgrasp run m.yaml -o out", "malformed YAML");
  ExpectRefused("springgrasp observe m.yaml -o demo.csv", "malformed YAML");
  ExpectRefused("springgrasp inspect m.yaml", "m.yaml:");
}

TEST_F(BadInputTest, UnknownKeysAndNegativeMass) {
  const std::string scene = kSmallScene;
  Write("unknown.yaml", scene + "tabel: {height: 1}\n");
  ExpectRefused("springgrasp generate unknown.yaml --object '0 0 0' --shape sphere:0.04 -o m.csv",
                "unknown.yaml:");
  ExpectRefused("springgrasp observe unknown.yaml -o demo.csv",
                "unknown.yaml:3: unknown key 'tabel'");
  std::string heavy = scene;
  heavy.replace(heavy.find("0.1,"), 4, "-0.1,");
  Write("negative.yaml", heavy);
  ExpectRefused("springgrasp inspect negative.yaml -o picture.png", "mass is -0.1");
  ExpectRefused("springgrasp observe negative.yaml -o demo.csv", "mass is -0.1");
  Write("scene.yaml", heavy);
  Write("experiment.yaml", kSmallExperiment);
  ExpectRefused("springgrasp run experiment.yaml -o out", "mass is -0.1");
}

TEST_F(BadInputTest, Demonstrations) {
  const auto refused = [&](const std::vector<Row>& rows, const std::string& part) {
    Write("demo.csv", DemonstrationText(rows));
    ExpectRefused("springgrasp learn demo.csv --type pinch -o grasp.yaml", part);
  };
  std::vector<Row> rows = SoundRows();
  rows[5].thumb_x = "near";
  refused(rows, "demo.csv:7");
  rows[5].thumb_x = "inf";
  refused(rows, "demo.csv:7");
  rows = SoundRows();
  rows[20].t = "0.01";
  refused(rows, "demo.csv:22");
  rows = SoundRows();
  for (Row& row : rows) row.with_index = false;
  refused(rows, "finger");
  refused(SoundRows(3), "samples");
}

TEST_F(BadInputTest, ObjectsOfOnesOwn) {
  const std::string grasp = "springgrasp grasp ", shown = " --type pinch -o out --demonstration '" +
                                                          SourceFolder() +
                                                          "/models/grasps/pinch.csv'";
  ExpectRefused(grasp + "nowhere.obj" + shown, "nowhere.obj: no such file; an object is a mesh");
  ExpectRefused(grasp + "sphere:0.04 --type pinch -o out", "either --demonstration or --left");
  ExpectRefused(grasp + "sphere:0.04 --left l.mp4 --type pinch -o out", "needs --right too");
  ExpectRefused(grasp + "sphere:0.04 --marker-hue 90" + shown, "are for recorded video");
  ExpectRefused(grasp + "sphere:0.04 --shape sphere:0.05" + shown, "sphere:0.04 is what it is");
  ExpectRefused(grasp + "sphere:0.04 --mass -1" + shown, "mass is -1");
  Write("millimetres.obj",
        "v 0 0 0\nv 40 0 0\nv 0 40 0\nv 0 0 40\n"
        "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
  ExpectRefused(grasp + "millimetres.obj" + shown, "lengths are in metres");
  Write("broken.obj", "v 0 0\n");
  ExpectRefused(grasp + "broken.obj" + shown, "broken.obj");
}

TEST_F(BadInputTest, OutputsThatCannotBe) {
  fs::create_directory(folder_ / "folder");
  Write("file", "");
  ExpectRefused("springgrasp export . -o folder", "is a folder");
  ExpectRefused("springgrasp run first_grasps -o file", "not a directory");
  ExpectRefused("springgrasp run first_grasps -o .", "not empty");
}

}  // namespace
}  // namespace springgrasp
