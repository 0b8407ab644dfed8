#include "sim/scene_yaml.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <set>

#include "base/error.h"
#include "base/yaml_reader.h"
#include "sim/scene.h"

namespace springgrasp {
namespace {

namespace fs = std::filesystem;

constexpr Bounds kInSpace{-10, 10};
constexpr Bounds kAngle{-6.2832, 6.2832};
constexpr Bounds kFraction{0, 1};
constexpr Bounds kError{-0.9, 10};

void ReadPlane(YamlReader& yaml, const std::string& key, Eigen::Vector2d& value) {
  std::vector<double> v{value.x(), value.y()};
  yaml.Read(key, v, kInSpace);
  ThrowUnless(v.size() == 2, "{}: {} has {} numbers, expected 2 (x y)", yaml.Where(key), key,
              v.size());
  value = {v[0], v[1]};
}

void CheckName(const std::string& name, const std::string& where) {
  const bool plain = !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_';
  });
  ThrowUnless(plain, "{}: name is '{}', expected letters, digits and underscores", where, name);
  const std::set<std::string> taken = {"world", "table", "floor", "mmm_hand", "shown_object"};
  ThrowUnless(taken.count(name) == 0 && name.rfind("hand_", 0) != 0 && name.rfind("arm_", 0) != 0,
              "{}: the name '{}' is reserved, choose another", where, name);
}

void ReadObjectPose(YamlReader& yaml, SceneObject& object) {
  yaml.Require("pose");
  std::vector<double> v;
  yaml.Read("pose", v, kInSpace);
  object.resting = v.size() == 2;
  if (v.size() == 2) {
    object.X_WO.translation() = Eigen::Vector3d(v[0], v[1], 0);
  } else {
    ThrowUnless(v.size() == 3 || v.size() == 7,
                "{}: pose has {} numbers, expected 2 (x y, resting on the table), 3 (x y z) or 7 "
                "(x y z qw qx qy qz)",
                yaml.Where("pose"), v.size());
    yaml.Read("pose", object.X_WO);
  }
  yaml.Read("yaw", object.yaw, kAngle);
}

// Mass and friction of an MJCF are the file's; a mesh has neither.
void ReadFacts(SceneObject& object, const std::string& where) {
  try {
    const ObjectFile file = ReadObjectFile(object.model);
    object.parts = file.parts;
    if (fs::path(object.model).extension() != ".xml") return;
    object.mass = file.mass;
    object.friction = file.friction;
    object.friction_of_file = true;
  } catch (const Error& e) {
    Fail("{}: {}", where, e.what());
  }
}

constexpr double kThickest = 0.03;  // m, of a plate in a slot

SceneObject ReadObject(YamlReader& yaml, const std::string& scene) {
  SceneObject o;
  yaml.Read("name", o.name);
  CheckName(o.name, yaml.Where("name"));
  o.shape = ReadSceneShape(yaml, "shape");
  yaml.Read("model", o.model);
  ThrowUnless(o.shape || !o.model.empty(),
              "{}: object '{}' needs either a shape or a model (a file), or both",
              yaml.Where("name"), o.name);
  if (!o.model.empty()) o.model = ResolveSceneFile(o.model, scene, yaml.Where("model"), "model");
  if (o.shape) {
    ThrowUnless(o.shape->size.minCoeff() >= 0.001 && o.shape->size.maxCoeff() <= 2,
                "{}: extents of {} must lie between 0.001 and 2 m", yaml.Where("shape"),
                FormatShape(*o.shape));
  }
  if (!o.model.empty()) ReadFacts(o, yaml.Where("model"));
  yaml.Read("mass", o.mass, {1e-4, 50});
  yaml.Read("friction", o.friction, {0.01, 5});
  o.friction_of_file = o.friction_of_file && !yaml.Has("friction");
  ReadObjectPose(yaml, o);
  YamlReader noise = yaml.Child("pose_noise");
  noise.Read("x", o.pose_noise.x, kFraction);
  noise.Read("y", o.pose_noise.y, kFraction);
  noise.Read("yaw", o.pose_noise.yaw, {0, 3.1416});
  noise.Finish();
  yaml.Read("on_ring", o.on_ring);
  ThrowUnless(!o.on_ring || SeatOnRing(o),
              "{}: on_ring is for spheres, and for files whose parts are spheres on the z axis",
              yaml.Where("on_ring"));
  yaml.Read("ring_height", o.ring_height, {0, 0.5});
  yaml.Read("pedestal", o.pedestal, {0.005, 0.6});
  ThrowUnless(!(yaml.Has("pedestal") && (o.on_ring || !o.resting)),
              "{}: a pedestal is for objects that stand on it: no on_ring, pose of two numbers",
              yaml.Where("pedestal"));
  if (yaml.Has("place")) {
    std::vector<double> place;
    yaml.Read("place", place, {-10, 10});
    ThrowUnless(place.size() == 2, "{}: place has {} numbers, expected 2 (x, y)",
                yaml.Where("place"), place.size());
    o.place = Eigen::Vector2d(place[0], place[1]);
  }
  yaml.Read("slot", o.slot, {0.002, 0.2});
  ThrowUnless(
      !yaml.Has("slot") ||
          (o.resting && o.model.empty() && o.shape && o.shape->kind == Shape::Kind::kBox &&
           std::min(o.shape->size.x(), o.shape->size.y()) <= kThickest),
      "{}: a slot is for upright plates: boxes of at most {} m in x or y, pose of two numbers",
      yaml.Where("slot"), kThickest);
  yaml.Read("colour", o.colour, kFraction);
  YamlReader believed = yaml.Child("believed");
  believed.Read("position", o.believed.position, {-1, 1});
  believed.Read("yaw", o.believed.yaw, {-3.1416, 3.1416});
  believed.Read("size", o.believed.size, kError);
  believed.Read("mass", o.believed.mass, kError);
  believed.Read("friction", o.believed.friction, kError);
  believed.Finish();
  yaml.Finish();
  return o;
}

void ReadTable(YamlReader yaml, SceneTable& table) {
  yaml.Read("height", table.height, {0.05, 2});
  yaml.Read("size", table.size, {0.005, 5});
  ReadPlane(yaml, "position", table.position);
  yaml.Read("yaw", table.yaw, kAngle);
  yaml.Finish();
}

SceneLight ReadLight(YamlReader& yaml) {
  SceneLight light;
  yaml.Read("position", light.position, kInSpace);
  yaml.Read("lookat", light.lookat, kInSpace);
  yaml.Read("brightness", light.brightness, kFraction);
  yaml.Read("shadow", light.shadow);
  yaml.Finish();
  return light;
}

SceneCamera ReadCamera(YamlReader& yaml) {
  SceneCamera camera;
  yaml.Require("name");
  yaml.Read("name", camera.name);
  CheckName(camera.name, yaml.Where("name"));
  yaml.Require("position");
  yaml.Read("position", camera.position, kInSpace);
  yaml.Require("lookat");
  yaml.Read("lookat", camera.lookat, kInSpace);
  yaml.Read("fovy_deg", camera.fovy_deg, {1, 150});
  ThrowUnless((camera.position - camera.lookat).norm() > 1e-3,
              "{}: the camera stands where it looks at", yaml.Where("lookat"));
  yaml.Finish();
  return camera;
}

void ReadPhysics(YamlReader yaml, ScenePhysics& p) {
  yaml.Read("timestep", p.timestep, {1e-5, 0.01});
  yaml.Read("integrator", p.integrator, {"Euler", "implicit"});
  yaml.Read("solver", p.solver, {"Newton", "CG", "PGS"});
  yaml.Read("iterations", p.iterations, {1, 1000});
  yaml.Read("cone", p.cone, {"elliptic", "pyramidal"});
  yaml.Read("impratio", p.impratio, {0.1, 1000});
  yaml.Read("noslip_iterations", p.noslip_iterations, {0, 1000});
  yaml.Read("condim", p.condim, {3, 6});
  ThrowUnless(p.condim != 5, "{}: condim is 5, expected 3, 4 or 6", yaml.Where("condim"));
  yaml.Read("torsional_friction", p.torsional_friction, kFraction);
  yaml.Read("rolling_friction", p.rolling_friction, kFraction);
  yaml.Read("solref", p.solref, {1e-4, 10});
  ThrowUnless(p.solref.size() == 2,
              "{}: solref has {} numbers, expected 2 (time constant, "
              "damping ratio)",
              yaml.Where("solref"), p.solref.size());
  yaml.Read("solimp", p.solimp, {1e-5, 1});
  ThrowUnless(p.solimp.size() == 3, "{}: solimp has {} numbers, expected 3 (least, most, width)",
              yaml.Where("solimp"), p.solimp.size());
  yaml.Finish();
}

void ReadPneumatics(YamlReader yaml, PneumaticParameters& p) {
  const auto read = [&](const char* key, std::optional<double>& value, const Bounds& bounds) {
    if (!yaml.Has(key)) return;
    value = 0;
    yaml.Read(key, *value, bounds);
  };
  read("fill_time", p.fill_time, {0.005, 2});
  read("supply", p.supply, {0.1, 20});
  read("area", p.area, {0.01, 100});
  read("lever", p.lever, {0.1, 10});
  read("spring", p.spring, {0.001, 10});
  read("damping", p.damping, {0, 1});
  read("friction", p.friction, {0, 1});
  yaml.Read("leakage", p.leakage, {0, 10});
  yaml.Read("delay", p.delay, {0, 0.5});
  yaml.Read("hysteresis", p.hysteresis, {0, 2});
  yaml.Read("max_rate", p.max_rate, {0, 1000});
  yaml.Read("pressure_noise", p.pressure_noise, {0, 1});
  yaml.Read("angle_noise", p.angle_noise, {0, 0.5});
  yaml.Read("sensing_delay", p.sensing_delay, {0, 0.2});
  yaml.Read("model_error", p.model_error, {0, 0.5});
  yaml.Finish();
}

// Two lamps, and two overview cameras: one sees robot and table, one the first object.
void FillDefaultView(Scene& scene) {
  const Eigen::Vector3d top(scene.table.position.x(), scene.table.position.y(), scene.table.height);
  if (scene.lights.empty()) {
    // One from the front, one past the robot's shoulder onto what its eyes see.
    scene.lights = {{top + Eigen::Vector3d(0.6, 1.2, 2.0), top, 0.5, true},
                    {top + Eigen::Vector3d(-1.2, -2.2, 1.2), top, 0.35, false}};
  }
  if (!scene.cameras.empty()) return;
  Eigen::Vector3d target = top;
  if (!scene.objects.empty()) target = ObjectStartPose(scene, 0).translation();
  scene.cameras = {{"front", top + Eigen::Vector3d(0.75, 1.55, 0.65),
                    top + Eigen::Vector3d(-0.2, -0.3, 0.15), 42},
                   {"close", target + Eigen::Vector3d(0.42, 0.42, 0.22),
                    target + Eigen::Vector3d(0, -0.03, 0.05), 40}};
}

Scene ReadSceneFrom(YamlReader yaml, const std::string& name) {
  Scene scene;
  scene.source = name;
  yaml.Read("robot", scene.robot);
  yaml.Read("hand", scene.hand, {"documented", "opposition"});
  yaml.Read("active", scene.active);
  const std::set<std::string> subsystems = {"platform",   "torso",    "head",     "right_arm",
                                            "right_hand", "left_arm", "left_hand"};
  for (const std::string& s : scene.active) {
    ThrowUnless(subsystems.count(s) > 0, "{}: active holds '{}', expected some of {}",
                yaml.Where("active"), s, fmt::join(subsystems, ", "));
  }
  YamlReader start = yaml.Child("start");
  for (const std::string& joint : start.Keys()) start.Read(joint, scene.start[joint], kAngle);
  start.Finish();
  yaml.Read("torso", scene.torso, {"fixed", "free"});
  ReadTable(yaml.Child("table"), scene.table);
  std::set<std::string> names;
  for (YamlReader& child : yaml.Children("objects")) {
    scene.objects.push_back(ReadObject(child, name));
    ThrowUnless(names.insert(scene.objects.back().name).second, "{}: a second object is named '{}'",
                child.Where("name"), scene.objects.back().name);
  }
  yaml.Read("max_finger_force", scene.max_finger_force, {0.1, 100});
  for (YamlReader& child : yaml.Children("lights")) scene.lights.push_back(ReadLight(child));
  for (YamlReader& child : yaml.Children("cameras")) scene.cameras.push_back(ReadCamera(child));
  ReadDemonstrator(yaml.Child("demonstrator"), name, scene.demonstrator);
  ReadEyes(yaml.Child("eyes"), scene.eyes);
  ReadPhysics(yaml.Child("physics"), scene.physics);
  ReadPneumatics(yaml.Child("pneumatics"), scene.pneumatics);
  yaml.Finish();
  FillDefaultView(scene);
  return scene;
}

}  // namespace

Scene ReadScene(const std::string& path) { return ReadSceneFrom(YamlReader::FromFile(path), path); }

Scene ParseScene(const std::string& yaml_text, const std::string& name) {
  return ReadSceneFrom(YamlReader::FromText(yaml_text, name), name);
}

}  // namespace springgrasp
