#include "sim/measure_drives.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "sim/model_index.h"
#include "sim/mujoco_handles.h"

namespace springgrasp {
namespace {

constexpr double kHeld = 1e6;           // Nm s/rad: damping that holds a joint for seconds
constexpr double kFineStep = 5e-4;      // s, for a light finger on a stiff hold
constexpr double kPadStiffness = 3000;  // N/m, of what holds the pad

// A copy without gravity whose joints outside the hands do not move.
ModelPtr FreeHands(const mjModel& model) {
  ModelPtr copy(mj_copyModel(nullptr, &model));
  std::fill_n(copy->opt.gravity, 3, 0.0);
  for (int i = 0; i < copy->nv; ++i) {
    const std::string joint = NameOf(*copy, mjOBJ_JOINT, copy->dof_jntid[i]);
    if (joint.rfind("hand_", 0) != 0) copy->dof_damping[i] = kHeld;
  }
  return copy;
}

std::vector<int> JointsOf(const mjModel& model, int valve) {
  const int id = model.actuator_trnid[2 * valve];
  if (model.actuator_trntype[valve] == mjTRN_JOINT) return {id};
  std::vector<int> joints;
  for (int w = 0; w < model.tendon_num[id]; ++w) {
    joints.push_back(model.wrap_objid[model.tendon_adr[id] + w]);
  }
  return joints;
}

int PressureOf(const mjModel& model, int valve) {
  int address = 0;
  for (int a = 0; a < valve; ++a) address += model.actuator_dyntype[a] != mjDYN_NONE;
  return address;
}

double TorquePerBar(const mjModel& model, int valve) {
  return model.actuator_gainprm[mjNGAIN * valve] * model.actuator_gear[6 * valve];
}

double SpringRest(const mjModel& model, int joint) {
  return model.qpos_spring[model.jnt_qposadr[joint]];
}

}  // namespace

std::vector<std::string> ValvesOf(const mjModel& model) {
  std::vector<std::string> valves;
  for (int a = 0; a < model.nu; ++a) {
    if (model.actuator_dyntype[a] != mjDYN_NONE) {
      valves.push_back(NameOf(model, mjOBJ_ACTUATOR, a));
    }
  }
  return valves;
}

double MidPressure(const mjModel& model, const std::string& valve) {
  const int id = IdOf(model, mjOBJ_ACTUATOR, valve);
  const int joint = JointsOf(model, id).front();
  const double middle = (model.jnt_range[2 * joint] + model.jnt_range[2 * joint + 1]) / 2;
  return model.jnt_stiffness[joint] * (middle - SpringRest(model, joint)) / TorquePerBar(model, id);
}

DriveStep MeasureDriveStep(const mjModel& source, const std::string& valve, double pressure,
                           double duration) {
  const ModelPtr model = FreeHands(source);
  const DataPtr data = MakeData(*model);
  const int id = IdOf(*model, mjOBJ_ACTUATOR, valve);
  const std::vector<int> joints = JointsOf(*model, id);
  // The springs hold every joint at its open end, where the variant's thumb would start too.
  for (int j = 0; j < model->njnt; ++j) {
    if (NameOf(*model, mjOBJ_JOINT, j).rfind("hand_", 0) != 0) continue;
    data->qpos[model->jnt_qposadr[j]] = model->jnt_range[2 * j];
  }
  const int first = model->jnt_qposadr[joints.front()];
  const double start = data->qpos[first];
  DriveStep step;
  step.valve = valve;
  step.pressure = pressure;
  data->ctrl[id] = pressure;
  while (data->time < duration) {
    step.t.push_back(data->time);
    step.p.push_back(data->act[PressureOf(*model, id)]);
    step.q.push_back(data->qpos[first]);
    mj_step(model.get(), data.get());
  }
  for (const int joint : joints) {
    step.joints.push_back(NameOf(*model, mjOBJ_JOINT, joint));
    step.steady.push_back(data->qpos[model->jnt_qposadr[joint]]);
    step.balance.push_back(
        std::clamp(SpringRest(*model, joint) +
                       pressure * TorquePerBar(*model, id) / model->jnt_stiffness[joint],
                   model->jnt_range[2 * joint], model->jnt_range[2 * joint + 1]));
  }
  const auto reaches = [&](const std::vector<double>& value, double level) {
    const auto found =
        std::find_if(value.begin(), value.end(), [&](double x) { return x >= level; });
    return found == value.end() ? duration : step.t[found - value.begin()];
  };
  step.time_constant = reaches(step.p, (1 - std::exp(-1.0)) * pressure);
  step.rise_time = reaches(step.q, start + 0.9 * (step.steady.front() - start));
  return step;
}

double MeasurePadForce(const mjModel& source, const std::string& hand, const std::string& finger,
                       double q, double pressure) {
  const ModelPtr model = FreeHands(source);
  model->opt.timestep = kFineStep;
  const DataPtr data = MakeData(*model);
  const std::string name = hand + "_" + finger;
  for (const char* joint : {"_j0", "_j1"}) {
    const int id = IdOf(*model, mjOBJ_JOINT, name + joint);
    data->qpos[model->jnt_qposadr[id]] = q;
    for (int a = 0; a < model->nu; ++a) {
      const std::vector<int> driven =
          model->actuator_dyntype[a] == mjDYN_NONE ? std::vector<int>() : JointsOf(*model, a);
      if (std::count(driven.begin(), driven.end(), id) > 0) data->ctrl[a] = pressure;
    }
  }
  const int pad = IdOf(*model, mjOBJ_SITE, name + "_pad");
  const int tip = IdOf(*model, mjOBJ_SITE, name + "_tip");
  mj_forward(model.get(), data.get());
  const Eigen::Vector3d held = Vector3From(data->site_xpos + 3 * pad);
  const int body = model->site_bodyid[pad];
  const double damping = std::sqrt(kPadStiffness * model->body_mass[body]);
  Eigen::Vector3d before = held, force = Eigen::Vector3d::Zero();
  while (data->time < 1) {
    const Eigen::Vector3d now = Vector3From(data->site_xpos + 3 * pad);
    force = kPadStiffness * (held - now) - damping * (now - before) / model->opt.timestep;
    before = now;
    std::fill_n(data->qfrc_applied, model->nv, 0.0);
    mj_applyFT(model.get(), data.get(), force.data(), nullptr, now.data(), body,
               data->qfrc_applied);
    mj_step(model.get(), data.get());
  }
  const Eigen::Vector3d normal =
      (Vector3From(data->site_xpos + 3 * pad) - Vector3From(data->site_xpos + 3 * tip))
          .normalized();
  return -force.dot(normal);
}

}  // namespace springgrasp
