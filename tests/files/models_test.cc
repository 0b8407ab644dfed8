// What holds for every model file that is shipped.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

#include "files/model_file.h"

namespace springgrasp {
namespace {

std::vector<std::string> ModelFiles() {
  std::vector<std::string> paths;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(ModelPath(""))) {
    if (entry.path().extension() == ".xml") paths.push_back(entry.path().string());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

TEST(Models, EveryFileLoadsAndRunsTwoSecondsWithoutEngineWarning) {
  const std::vector<std::string> paths = ModelFiles();
  ASSERT_GE(paths.size(), 3u);
  for (const std::string& path : paths) {
    SCOPED_TRACE(path);
    ModelFile file(path);
    while (file.d()->time < 2.0) mj_step(file.m(), file.d());
    EXPECT_EQ(file.NumWarnings(), 0);
    for (int i = 0; i < file.m()->nv; ++i) {
      ASSERT_TRUE(std::isfinite(file.d()->qvel[i]))
          << file.Name(mjOBJ_JOINT, file.m()->dof_jntid[i]);
    }
  }
}

TEST(Models, LimitedJointsStayWithinAFewDegreesOfTheirRangesWhileFalling) {
  for (const std::string& path : ModelFiles()) {
    SCOPED_TRACE(path);
    ModelFile file(path);
    while (file.d()->time < 1.0) {
      mj_step(file.m(), file.d());
      for (int j = 0; j < file.m()->njnt; ++j) {
        if (!file.m()->jnt_limited[j]) continue;
        const double q = file.d()->qpos[file.m()->jnt_qposadr[j]];
        ASSERT_GT(q, file.m()->jnt_range[2 * j] - 0.15) << file.Name(mjOBJ_JOINT, j);
        ASSERT_LT(q, file.m()->jnt_range[2 * j + 1] + 0.15) << file.Name(mjOBJ_JOINT, j);
      }
    }
  }
}

}  // namespace
}  // namespace springgrasp
