// What a scene says of the demonstrator and of the eyes.
#include <algorithm>
#include <filesystem>

#include "base/error.h"
#include "base/files.h"
#include "base/fingers.h"
#include "sim/scene_yaml.h"

namespace springgrasp {
namespace {

constexpr Bounds kFraction{0, 1};
constexpr int kManyThings = 8;  // of `clutter: true`

// Caps and skin; keys that are absent leave the model's.
void ReadLook(YamlReader& yaml, SceneDemonstrator& d) {
  if (yaml.Has("cap_diameter")) {
    yaml.Read("cap_diameter", d.cap_diameter.emplace(), {0.012, 0.03});
  }
  if (yaml.Has("skin_colour")) yaml.Read("skin_colour", d.skin_colour.emplace(), kFraction);
  if (!yaml.Has("cap_colour")) return;
  Eigen::Vector3d& colour = d.cap_colour.emplace(Eigen::Vector3d::Zero());
  yaml.Read("cap_colour", colour, kFraction);
  // The tracker finds caps by their hue; greys have none, and what is dark has none in a picture.
  ThrowUnless(colour.maxCoeff() >= 0.3 && colour.minCoeff() <= 0.5 * colour.maxCoeff(),
              "{}: cap_colour is [{}, {}, {}], expected a bright colour with a hue (the largest at "
              "least 0.3, the smallest at most half of it)",
              yaml.Where("cap_colour"), colour.x(), colour.y(), colour.z());
}

void ReadOcclusion(YamlReader yaml, SceneOcclusion& occlusion) {
  std::vector<std::string> names;
  yaml.Read("fingers", names);
  for (const std::string& name : names) {
    const auto finger = std::find(kFingerNames.begin(), kFingerNames.end(), name);
    ThrowUnless(finger != kFingerNames.end(), "{}: fingers holds '{}', expected some of {}",
                yaml.Where("fingers"), name, fmt::join(kFingerNames, ", "));
    occlusion.fingers.push_back(static_cast<int>(finger - kFingerNames.begin()));
  }
  yaml.Read("frames", occlusion.frames, {0, 1000});
  yaml.Finish();
}

void ReadClutter(YamlReader& yaml, int& clutter) {
  if (!yaml.Has("clutter")) return;
  const std::string text = yaml.Text("clutter");
  if (text == "true" || text == "false") {
    clutter = text == "true" ? kManyThings : 0;
  } else {
    yaml.Read("clutter", clutter, {0, 24});
  }
}

}  // namespace

// Full path of a file that a scene names: absolute, beside the scene, or in the source folder.
std::string ResolveSceneFile(const std::string& file, const std::string& scene,
                             const std::string& where, const char* key) {
  const std::filesystem::path beside = std::filesystem::path(scene).parent_path() / file;
  const std::filesystem::path shipped = std::filesystem::path(SourceFolder()) / file;
  std::error_code ignored;
  if (std::filesystem::is_regular_file(beside, ignored))
    return std::filesystem::absolute(beside).lexically_normal();
  if (std::filesystem::is_regular_file(shipped, ignored)) return shipped.lexically_normal();
  Fail("{}: {} names '{}', but there is no such file beside the scene or in {}", where, key, file,
       SourceFolder());
}

std::optional<Shape> ReadSceneShape(YamlReader& yaml, const std::string& key) {
  std::string text;
  yaml.Read(key, text);
  if (text.empty()) return std::nullopt;
  try {
    return ParseShape(text);
  } catch (const Error& e) {
    Fail("{}: {}", yaml.Where(key), e.what());
  }
}

void ReadDemonstrator(YamlReader yaml, const std::string& scene, SceneDemonstrator& d) {
  yaml.Read("kind", d.kind, {"synthesised", "recorded"});
  yaml.Read("type", d.type, {"pinch", "tripod", "power", "lateral"});
  yaml.Read("approach", d.approach, {"usual", "side", "above"});
  yaml.Read("file", d.file);
  if (d.kind == "recorded") {
    yaml.Require("file");
    d.file = ResolveSceneFile(d.file, scene, yaml.Where("file"), "file");
  } else {
    ThrowUnless(d.file.empty(), "{}: file is given, but kind is synthesised, expected recorded",
                yaml.Where("file"));
  }
  d.object = ReadSceneShape(yaml, "object");
  yaml.Read("object_visible", d.object_visible);
  if (yaml.Has("pose")) {
    d.X_WO = Pose::Identity();
    yaml.Read("pose", *d.X_WO);
  }
  yaml.Read("hand_length", d.hand_length, {0.1, 0.3});
  ReadLook(yaml, d);
  yaml.Read("fps", d.fps, {5, 1000});
  if (yaml.Has("distance")) yaml.Read("distance", d.distance.emplace(), {0.25, 2});
  if (yaml.Has("speed")) yaml.Read("speed", d.speed.emplace(), {0.05, 10});
  ReadOcclusion(yaml.Child("occlusion"), d.occlusion);
  ReadClutter(yaml, d.clutter);
  yaml.Finish();
}

void ReadEyes(YamlReader yaml, SceneEyes& e) {
  yaml.Read("width", e.width, {320, 1920});
  yaml.Read("height", e.height, {240, 1080});
  yaml.Read("noise", e.noise, {0, 255});
  std::vector<double> k(e.distortion.begin(), e.distortion.end());
  yaml.Read("distortion", k, {-5, 5});
  ThrowUnless(k.size() == 5, "{}: distortion has {} numbers, expected 5 (k1 k2 p1 p2 k3)",
              yaml.Where("distortion"), k.size());
  std::copy(k.begin(), k.end(), e.distortion.begin());
  yaml.Read("exposure", e.exposure, {0, 0.2});
  yaml.Read("subframes", e.subframes, {2, 100});
  yaml.Read("brightness_drift", e.brightness_drift, {0, 1.8});
  yaml.Read("white_balance_drift", e.white_balance_drift, {0, 1.8});
  yaml.Read("frame_drops", e.frame_drops, {0, 0.9});
  yaml.Read("time_offset", e.time_offset, {-0.2, 0.2});
  YamlReader error = yaml.Child("calibration_error");
  error.Read("rotation", e.calibration_error.rotation, {0, 0.2});
  error.Read("focal", e.calibration_error.focal, {-0.3, 0.3});
  error.Finish();
  yaml.Read("tracker", e.tracker, {"outline", "paper"});
  yaml.Finish();
}

}  // namespace springgrasp
