// The parts of reading a scene; for scene_yaml*.cc only.
#pragma once

#include <optional>
#include <string>

#include "base/yaml_reader.h"
#include "sim/scene.h"

namespace springgrasp {

// Full path of a file that a scene names: absolute, beside the scene, or in the source folder.
std::string ResolveSceneFile(const std::string& file, const std::string& scene,
                             const std::string& where, const char* key);
std::optional<Shape> ReadSceneShape(YamlReader& yaml, const std::string& key);

void ReadDemonstrator(YamlReader yaml, const std::string& scene, SceneDemonstrator& d);
void ReadEyes(YamlReader yaml, SceneEyes& e);

}  // namespace springgrasp
