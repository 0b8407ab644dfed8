// A small robot under the real names, so that these tests need no model of the robot.
#pragma once

#include <string>

#include "base/files.h"
#include "sim/scene_builder.h"

namespace springgrasp {

inline std::string TestFile(const std::string& name) {
  return std::string(SPRINGGRASP_TESTDATA_DIR) + "/" + name;
}

// One of everything, on the small robot.
inline Scene TestScene() {
  Scene scene = ReadScene(TestFile("sim_scene.yaml"));
  scene.robot = TestFile("sim_robot.xml");
  return scene;
}

inline BuildOptions TestDemonstrator() {
  BuildOptions options;
  options.with_demonstrator = true;
  options.demonstrator_model = TestFile("sim_demonstrator.xml");
  return options;
}

}  // namespace springgrasp
