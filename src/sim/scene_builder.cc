#include "sim/scene_builder.h"

#include <algorithm>
#include <filesystem>

#include "base/error.h"
#include "base/files.h"
#include "sim/demonstrator_part.h"
#include "sim/display_furniture.h"
#include "sim/mjcf_part.h"
#include "sim/model_index.h"
#include "sim/scene_furniture.h"

namespace springgrasp {
namespace {

// Angle at which a joint starts: as the scene says, else 0 or the nearest limit.
double StartPosition(const Scene& scene, const mjModel& model, int joint) {
  const std::string name = NameOf(model, mjOBJ_JOINT, joint);
  const bool limited = model.jnt_limited[joint];
  const double lower = model.jnt_range[2 * joint], upper = model.jnt_range[2 * joint + 1];
  const auto given = scene.start.find(name);
  if (given == scene.start.end()) return limited ? std::clamp(0.0, lower, upper) : 0.0;
  ThrowUnless(!limited || (given->second >= lower - 1e-9 && given->second <= upper + 1e-9),
              "{}: start.{} is {} rad, expected a number from {} to {}", scene.source, name,
              given->second, lower, upper);
  return given->second;
}

void CheckStartNames(const Scene& scene, const mjModel& robot) {
  for (const auto& [joint, position] : scene.start) {
    ThrowUnless(FindId(robot, mjOBJ_JOINT, joint) >= 0,
                "{}: start names the joint '{}', expected one of {}", scene.source, joint,
                fmt::join(NamesOf(robot, mjOBJ_JOINT), ", "));
  }
}

bool IsActive(const Scene& scene, const std::string& joint) {
  const std::string subsystem = SubsystemOfJoint(joint);
  if (subsystem == "torso" && scene.torso == "free") return true;
  return subsystem.empty() || std::count(scene.active.begin(), scene.active.end(), subsystem) > 0;
}

// The robot's file, or its variant with the opposition joint.
std::string RobotPath(const Scene& scene) {
  const std::filesystem::path path(ModelPath(scene.robot));
  if (scene.hand == "documented") return path;
  const std::filesystem::path variant =
      path.parent_path() / (path.stem().string() + "_" + scene.hand + path.extension().string());
  ThrowUnless(std::filesystem::is_regular_file(variant),
              "{}: hand is '{}', but there is no model {}", scene.source, scene.hand,
              variant.string());
  return variant;
}

void AddRobot(const Scene& scene, bool with_looks, XmlDocument& document) {
  const std::string path = RobotPath(scene);
  const ModelPtr robot = LoadModelFile(path);
  CheckStartNames(scene, *robot);
  std::map<std::string, double> frozen;
  for (int j = 0; j < robot->njnt; ++j) {
    const std::string name = NameOf(*robot, mjOBJ_JOINT, j);
    if (!IsActive(scene, name)) frozen[name] = StartPosition(scene, *robot, j);
  }
  const std::unique_ptr<XmlDocument> part = ReadMjcfPart(path, "robot");
  if (!with_looks) DropLooks(*part);
  FreezeJoints(*part, *robot, frozen);
  MergeMjcfPart(*part, document);
}

void AddDemonstrator(const Scene& scene, const BuildOptions& options, XmlDocument& document) {
  const std::unique_ptr<XmlDocument> part =
      ReadDemonstratorPart(ModelPath(options.demonstrator_model), scene);
  XmlElement* world = ChildOf(part->FirstChildElement("mujoco"), "worldbody");
  FindBody(world, "mmm_hand")->SetAttribute("mocap", "true");
  MakeIntangible(world);
  MergeMjcfPart(*part, document);
}

// Masses of file objects follow the scene, and friction where it overrules the file. What the
// object says of contact holds in all its contacts (priority).
void FitFileObjects(const Scene& scene, mjModel& model) {
  bool changed = false;
  for (const SceneObject& object : scene.objects) {
    if (object.model.empty()) continue;
    const int body = FindId(model, mjOBJ_BODY, object.name);
    if (body < 0) continue;
    const double factor = object.mass / model.body_subtreemass[body];
    for (int b = body; b < model.nbody; ++b) {
      if (model.body_rootid[b] != body) continue;
      model.body_mass[b] *= factor;
      for (int k = 0; k < 3; ++k) model.body_inertia[3 * b + k] *= factor;
    }
    for (int g = 0; g < model.ngeom; ++g) {
      if (model.body_rootid[model.geom_bodyid[g]] != body) continue;
      model.geom_priority[g] = std::max(model.geom_priority[g], 1);
      if (!object.friction_of_file) model.geom_friction[3 * g] = object.friction;
    }
    changed = true;
  }
  if (changed) mj_setConst(&model, MakeData(model).get());
}

// The keyframe was compiled empty, since qpos addresses are only known now.
void FillStartKey(const Scene& scene, mjModel& model) {
  const int key = IdOf(model, mjOBJ_KEY, "start");
  mjtNum* qpos = model.key_qpos + key * model.nq;
  std::copy_n(model.qpos0, model.nq, qpos);
  for (int j = 0; j < model.njnt; ++j) {
    const int type = model.jnt_type[j];
    if (type == mjJNT_FREE || type == mjJNT_BALL) continue;
    qpos[model.jnt_qposadr[j]] = StartPosition(scene, model, j);
  }
  // Servos (position actuators) hold the posture in which they start.
  for (int a = 0; a < model.nu; ++a) {
    if (model.actuator_biastype[a] != mjBIAS_AFFINE || model.actuator_trntype[a] != mjTRN_JOINT) {
      continue;
    }
    model.key_ctrl[key * model.nu + a] = StartPosition(scene, model, model.actuator_trnid[2 * a]);
  }
  for (int b = 0; b < model.nbody; ++b) {
    const int mocap = model.body_mocapid[b];
    if (mocap < 0) continue;
    std::copy_n(model.body_pos + 3 * b, 3, model.key_mpos + 3 * (key * model.nmocap + mocap));
    std::copy_n(model.body_quat + 4 * b, 4, model.key_mquat + 4 * (key * model.nmocap + mocap));
  }
}

}  // namespace

std::string ModelPath(const std::string& path) {
  const std::filesystem::path p(path);
  return p.is_absolute() ? path : (std::filesystem::path(SourceFolder()) / "models" / p).string();
}

std::string SubsystemOfJoint(const std::string& joint) {
  static const std::vector<std::pair<std::string, std::string>> prefixes = {
      {"platform_", "platform"}, {"torso_", "torso"},    {"neck_", "head"},
      {"head_", "head"},         {"eye", "head"},        {"arm_r_", "right_arm"},
      {"hand_r_", "right_hand"}, {"arm_l_", "left_arm"}, {"hand_l_", "left_hand"}};
  for (const auto& [prefix, subsystem] : prefixes) {
    if ((joint + "_").rfind(prefix, 0) == 0) return subsystem;
  }
  return "";
}

std::string BuildMjcf(const Scene& scene, const BuildOptions& options) {
  XmlDocument document;
  XmlElement* root = document.NewElement("mujoco");
  document.InsertFirstChild(root);
  root->SetAttribute("model", "scene");
  AddSettings(scene, options.offscreen_samples, root);
  if (options.with_robot) AddRobot(scene, options.with_looks, document);
  if (options.with_demonstrator) AddDemonstrator(scene, options, document);
  AddSurroundings(scene, root);
  if (options.with_table) AddTable(scene, root);
  if (options.with_objects) {
    for (int i = 0; i < static_cast<int>(scene.objects.size()); ++i) {
      if (options.with_table) AddRing(scene, i, root);
      if (options.with_table) AddPedestal(scene, i, root);
      if (options.with_table) AddSlot(scene, i, root);
      AddObject(scene, i, document);
    }
  }
  if (options.shown_object) AddShownObject(*options.shown_object, scene, root);
  if (options.with_demonstrator) {
    AddOccluders(scene, root);
    AddClutter(scene, root);
  }
  ChildOf(root, "keyframe")->InsertNewChildElement("key")->SetAttribute("name", "start");
  tinyxml2::XMLPrinter printer;
  document.Print(&printer);
  return printer.CStr();
}

ModelPtr BuildModel(const Scene& scene, const BuildOptions& options) {
  ModelPtr model = LoadModelText(BuildMjcf(scene, options), scene.source);
  FitFileObjects(scene, *model);
  ApplyPneumatics(scene.pneumatics, *model);
  FillStartKey(scene, *model);
  return model;
}

}  // namespace springgrasp
