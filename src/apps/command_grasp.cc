// springgrasp grasp: from an object and a demonstration of one's own to a scored trial.
#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <memory>
#include <optional>

#include "apps/command.h"
#include "apps/learn_options.h"
#include "apps/perform_once.h"
#include "apps/recorded_options.h"
#include "base/error.h"
#include "base/files.h"
#include "base/yaml_reader.h"
#include "demonstration/demonstration.h"
#include "grasp/learn.h"
#include "sim/closest_shape.h"

namespace springgrasp {
namespace {

namespace fs = std::filesystem;

// A table, a robot and a place for the object, where nothing else is asked for.
const std::map<std::string, std::string> kScenes = {{"pinch", "pinch_cylinder.yaml"},
                                                    {"tripod", "tripod_side.yaml"},
                                                    {"power", "power_cylinder.yaml"},
                                                    {"lateral", "lateral_plate.yaml"}};

struct Options {
  std::string object, shape, demonstration, scene;
  std::optional<double> mass, friction;
  LearnOptions learn;
  ObserveRecordedOptions recorded;
  bool recorded_only = false;  // an option of recorded video was given
  PerformOnceOptions once;

  std::string In(const std::string& file) const { return (fs::path(once.directory) / file); }
};

bool IsPrimitive(const std::string& object) {
  for (const char* kind : {"sphere:", "cylinder:", "box:"}) {
    if (object.rfind(kind, 0) == 0) return true;
  }
  return false;
}

// What the robot takes the object for.
Shape ShapeOf(const Options& options) {
  const bool primitive = IsPrimitive(options.object);
  ThrowUnless(!primitive || options.shape.empty(),
              "--shape is for objects from a file; {} is what it is", options.object);
  if (primitive) return ParseShape(options.object);
  ThrowUnless(
      fs::is_regular_file(options.object),
      "{}: no such file; an object is a mesh (OBJ, STL), an MJCF, or sphere:D, cylinder:DxH "
      "or box:XxYxZ",
      options.object);
  const ObjectFile file = ReadObjectFile(options.object);
  if (!options.shape.empty()) return ParseShape(options.shape);
  try {
    return FindClosestShape(file.parts).shape;
  } catch (const Error& e) {
    Fail("{}: {}", options.object, e.what());
  }
}

// The text of the scene with the object in the place of its first one.
std::string SceneText(const std::string& path, const Shape& shape, const Options& options) {
  std::string text = ReadFile(path);
  const Scene scene = ParseScene(text, path);  // messages with the lines of the file
  ThrowUnless(!scene.objects.empty(), "{}: the scene has no object whose place could be taken",
              path);
  const auto set = [&](const std::string& key, const std::string& value) {
    text = ApplyOverride(text, "objects.0." + key + "=" + value);
  };
  text = RemoveKey(text, "objects.0.model");
  if (fs::path(options.object).extension() == ".xml") {
    for (const char* own : {"mass", "friction"}) {
      text = RemoveKey(text, std::string("objects.0.") + own);
    }
  }
  if (!IsPrimitive(options.object)) set("model", "'" + fs::absolute(options.object).string() + "'");
  set("shape", FormatShape(shape));
  if (options.mass) set("mass", fmt::format("{}", *options.mass));
  if (options.friction) set("friction", fmt::format("{}", *options.friction));
  return text;
}

int RunGrasp(Options options) {
  const bool recorded = IsRecorded(options.recorded);
  ThrowUnless(recorded == options.demonstration.empty(),
              "grasp takes either --demonstration or --left, --right, --intrinsics and "
              "--extrinsics");
  ThrowUnless(recorded || !options.recorded_only,
              "--camera-pose, --marker-hue, --cap-* and --hand are for recorded video");
  CheckOutputPaths(options.once);
  const Shape shape = ShapeOf(options);
  const std::string path = options.scene.empty()
                               ? SourceFolder() + "/scenes/" + kScenes.at(options.learn.type)
                               : options.scene;
  const std::string scene_text = SceneText(path, shape, options);
  const Scene scene = ParseScene(scene_text, path);
  if (recorded) {
    options.demonstration = options.recorded.output = options.In("demonstration.csv");
    const int code = ObserveRecorded(options.recorded);
    if (code != kDone) return code;
  }
  const Grasp grasp = LearnGrasp(ReadDemonstration(options.demonstration), options.learn);
  MakeFolderOf(options.In("grasp.yaml"));
  WriteGrasp(grasp, options.In("grasp.yaml"));
  WriteFileAtomically(options.In("scene.yaml"), scene_text);
  fmt::print("{}object taken for {}\n", ReportGrasp(grasp), FormatShape(shape));
  PerformOnce(grasp, scene, options.once);
  return kDone;
}

}  // namespace

void AddGraspCommand(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = AddCommand(
      app, "grasp", "Your object, your demonstration: learns, performs once, and judges.",
      "models/objects/bottle.xml --demonstration models/grasps/power.csv --type power "
      "-o out/grasp");
  command
      ->add_option("object", options->object,
                   "mesh (OBJ, STL; metres, its middle the origin, z up), MJCF, or a primitive as "
                   "sphere:D, cylinder:DxH, box:XxYxZ")
      ->required();
  command->add_option("--demonstration", options->demonstration, "demonstration CSV");
  const std::vector<CLI::Option*> recorded_only = AddRecordedOptions(*command, options->recorded);
  AddLearnOptions(*command, options->learn);
  command->add_option("--shape", options->shape,
                      "that the robot takes a file's object for (default: the closest primitive)");
  command->add_option("--mass", options->mass, "kg (default: an MJCF's own, the scene's)");
  command->add_option("--friction", options->friction, "sliding coefficient (default: likewise)");
  command->add_option("--scene", options->scene,
                      "whose first object's place it takes (default: one of the type)");
  AddPerformOnceOptions(*command, options->once);
  command->callback([options, recorded_only, &exit_code] {
    options->recorded_only = AnyGiven(recorded_only);
    exit_code = RunGrasp(*options);
  });
}

}  // namespace springgrasp
