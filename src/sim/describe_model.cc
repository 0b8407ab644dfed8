#include "sim/describe_model.h"

#include "base/error.h"
#include "sim/model_index.h"

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
  const bool pressure = model.actuator_dyntype[id] != mjDYN_NONE;
  if (!pressure) return fmt::format("motor, Nm x {:g}", model.actuator_gainprm[mjNGAIN * id]);
  return fmt::format("valve, bar, {:g} Nm/bar, {:g} s", model.actuator_gainprm[mjNGAIN * id],
                     model.actuator_dynprm[mjNDYN * id]);
}

}  // namespace

std::string DescribeModel(const mjModel& model) {
  std::string text = fmt::format(
      "{} bodies, {} joints ({} degrees of freedom), {} actuators, {} geoms, {} cameras, "
      "{:.3f} kg\n",
      model.nbody - 1, model.njnt, model.nv, model.nu, model.ngeom, model.ncam,
      model.body_subtreemass[0]);
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
