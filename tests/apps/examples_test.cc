// The example at the end of each command's help works when it is pasted at the repository's root.
#include <gmock/gmock.h>

#include <filesystem>
#include <regex>

#include "apps/program.h"
#include "base/files.h"
#include "experiment/small_experiment.h"

namespace springgrasp {
namespace {

namespace fs = std::filesystem;

class ExamplesTest : public testing::Test {
 protected:
  // The example, writing below a folder of the test instead of out/.
  std::string ExampleOf(const std::string& command) const {
    const std::string help = RunProgram("springgrasp " + command + " --help", folder_ / ".").out;
    const std::string start = "build/release/bin/";
    const auto begin = help.find(start);
    if (begin == std::string::npos) return "false";
    const auto end = help.find('\n', begin);
    const std::string example = help.substr(begin + start.size(), end - begin - start.size());
    return std::regex_replace(example, std::regex("\\bout/"), folder_ / "out/");
  }

  ProgramResult Paste(const std::string& command, const std::string& more = "") const {
    const ProgramResult result = RunProgram(
        "cd '" + SourceFolder() + "' && " + ExampleOf(command) + " " + more, folder_ / ".");
    EXPECT_THAT(result.err, testing::Not(testing::HasSubstr("springgrasp:"))) << command;
    return result;
  }

  bool Wrote(const std::string& name) const { return fs::file_size(folder_ / "out/" + name) > 0; }

  TemporaryFolder folder_;
};

TEST_F(ExamplesTest, OnModelsAndGrasps) {
  EXPECT_EQ(Paste("inspect").exit_code, 0);
  EXPECT_TRUE(Wrote("power_cylinder.png"));
  EXPECT_EQ(Paste("model").exit_code, 0);
  EXPECT_EQ(Paste("observe").exit_code, 0);
  EXPECT_TRUE(Wrote("pinch.csv"));
  EXPECT_TRUE(Wrote("pinch.mp4"));
  EXPECT_EQ(Paste("learn").exit_code, 0);
  EXPECT_TRUE(Wrote("pinch.yaml"));
  EXPECT_EQ(Paste("generate").exit_code, 0);
  EXPECT_TRUE(Wrote("motion.csv"));
  EXPECT_EQ(Paste("perform").exit_code, 0);
  EXPECT_TRUE(Wrote("perform/outcome.yaml"));
  EXPECT_EQ(Paste("grasp").exit_code, 0);
  EXPECT_TRUE(Wrote("grasp/outcome.yaml"));
}

// One trial only: the rest of the run would tell nothing more about the example.
TEST_F(ExamplesTest, OnExperiments) {
  EXPECT_EQ(Paste("run", "--limit 1").exit_code, 3);
  EXPECT_EQ(Paste("status").exit_code, 0);
  EXPECT_EQ(Paste("replay").exit_code, 0);
  EXPECT_TRUE(Wrote("replay.mp4"));
  EXPECT_EQ(Paste("export").exit_code, 0);
  EXPECT_TRUE(Wrote("first_grasps.csv"));
  EXPECT_EQ(Paste("check").exit_code, 1);  // an unfinished run falls short
}

}  // namespace
}  // namespace springgrasp
