#include "sim/describe_model.h"

#include <map>

#include "base/error.h"
#include "sim/model_index.h"
#include "sim/scene_builder.h"

namespace springgrasp {
namespace {

std::string Range(bool limited, const mjtNum* range) {
  return limited ? fmt::format("{:8.3f} .. {:7.3f}", range[0], range[1]) : "unlimited";
}

std::string JointKind(int type) {
  switch (type) {
    case mjJNT_FREE:
      return "free";
    case mjJNT_BALL:
      return "ball";
    case mjJNT_SLIDE:
      return "slide, m";
    default:
      return "hinge, rad";
  }
}

std::string ActuatorKind(const mjModel& model, int id) {
  const double gain = model.actuator_gainprm[mjNGAIN * id] * model.actuator_gear[6 * id];
  if (model.actuator_dyntype[id] != mjDYN_NONE) {
    return fmt::format("valve, bar, {:g} Nm/bar, {:g} s", gain, model.actuator_dynprm[mjNDYN * id]);
  }
  if (model.actuator_biastype[id] == mjBIAS_AFFINE)
    return fmt::format("servo, {:g} per unit", gain);
  return fmt::format("motor, Nm x {:g}", gain);
}

// By its own name, its joint's, or its parent's.
std::string SubsystemOfBody(const mjModel& model, int body) {
  for (; body > 0; body = model.body_parentid[body]) {
    std::string subsystem = SubsystemOfJoint(NameOf(model, mjOBJ_BODY, body));
    if (subsystem.empty() && model.body_jntnum[body] > 0) {
      subsystem = SubsystemOfJoint(NameOf(model, mjOBJ_JOINT, model.body_jntadr[body]));
    }
    if (!subsystem.empty()) return subsystem;
  }
  return "";
}

struct Subsystem {
  int joints = 0, actuators = 0;
  double mass = 0;  // kg
};

// Empty if nothing in the model is named as a part of a robot.
std::string SubsystemTable(const mjModel& model) {
  std::map<std::string, Subsystem> parts;
  for (int j = 0; j < model.njnt; ++j) {
    ++parts[SubsystemOfJoint(NameOf(model, mjOBJ_JOINT, j))].joints;
  }
  for (int a = 0; a < model.nu; ++a) {
    ++parts[SubsystemOfJoint(NameOf(model, mjOBJ_ACTUATOR, a))].actuators;
  }
  for (int b = 1; b < model.nbody; ++b) parts[SubsystemOfBody(model, b)].mass += model.body_mass[b];
  std::string text;
  for (const char* name :
       {"platform", "torso", "head", "right_arm", "right_hand", "left_arm", "left_hand"}) {
    const Subsystem part = parts[name];
    if (part.mass == 0) continue;
    text += fmt::format("  {:<12} {:>2} joints, {:>2} actuators {:>9.4f} kg\n", name, part.joints,
                        part.actuators, part.mass);
  }
  return text.empty() ? text : "\nsubsystems\n" + text;
}

}  // namespace

std::string DescribeModel(const mjModel& model) {
  std::string text = fmt::format(
      "{} bodies, {} joints ({} degrees of freedom, {} of them actuated), {} geoms, {} cameras, "
      "{:.3f} kg\n",
      model.nbody - 1, model.njnt, model.nv, model.nu, model.ngeom, model.ncam,
      model.body_subtreemass[0]);
  text += SubsystemTable(model);
  text += "\njoints\n";
  for (int j = 0; j < model.njnt; ++j) {
    text += fmt::format("  {:<26} {:<11} {:<20} on {}\n", NameOf(model, mjOBJ_JOINT, j),
                        JointKind(model.jnt_type[j]),
                        Range(model.jnt_limited[j], model.jnt_range + 2 * j),
                        NameOf(model, mjOBJ_BODY, model.jnt_bodyid[j]));
  }
  text += "\nactuators\n";
  for (int a = 0; a < model.nu; ++a) {
    text += fmt::format("  {:<26} {:<20} {}\n", NameOf(model, mjOBJ_ACTUATOR, a),
                        Range(model.actuator_ctrllimited[a], model.actuator_ctrlrange + 2 * a),
                        ActuatorKind(model, a));
  }
  text += "\ncameras\n";
  for (int c = 0; c < model.ncam; ++c) {
    text += fmt::format("  {:<26} fovy {:.2f} deg, on {}\n", NameOf(model, mjOBJ_CAMERA, c),
                        model.cam_fovy[c], NameOf(model, mjOBJ_BODY, model.cam_bodyid[c]));
  }
  text += "\nbodies with mass\n";
  for (int b = 1; b < model.nbody; ++b) {
    if (model.body_mass[b] <= 0) continue;
    text += fmt::format("  {:<26} {:9.4f} kg\n", NameOf(model, mjOBJ_BODY, b), model.body_mass[b]);
  }
  return text;
}

}  // namespace springgrasp
