#include "sim/robot_io.h"

#include <algorithm>
#include <limits>

#include "base/error.h"
#include "sim/model_index.h"

namespace springgrasp {
namespace {

std::string Name(const char* part, const std::string& side, std::string_view name) {
  return fmt::format("{}_{}_{}", part, side, name);
}

// Looks a hinge up and notes its addresses and range.
void FindHinge(const mjModel& model, const std::string& name, int& qpos, int& dof, double& lower,
               double& upper) {
  const int id = IdOf(model, mjOBJ_JOINT, name);
  ThrowUnless(model.jnt_type[id] == mjJNT_HINGE, "joint '{}' is not a hinge", name);
  qpos = model.jnt_qposadr[id];
  dof = model.jnt_dofadr[id];
  lower = model.jnt_limited[id] ? model.jnt_range[2 * id] : -mjPI;
  upper = model.jnt_limited[id] ? model.jnt_range[2 * id + 1] : mjPI;
}

}  // namespace

RobotIo::RobotIo(const mjModel& model, const std::string& side) {
  for (int i = 0; i < kNumArmJoints; ++i) {
    const std::string name = Name("arm", side, kArmJointNames[i]);
    FindHinge(model, name, arm_qpos_[i], arm_dof_[i], arm_lower[i], arm_upper[i]);
    const int motor = IdOf(model, mjOBJ_ACTUATOR, name);
    arm_ctrl_[i] = motor;
    max_arm_torque[i] = model.actuator_ctrllimited[motor] ? model.actuator_ctrlrange[2 * motor + 1]
                                                          : std::numeric_limits<double>::infinity();
  }
  const bool opposition = FindId(model, mjOBJ_JOINT, Name("hand", side, "thumb_opposition")) >= 0;
  layout_ = opposition ? &OppositionHand() : &DocumentedHand();
  const int joints = layout_->num_joints();
  hand_lower.resize(joints);
  hand_upper.resize(joints);
  hand_qpos_.resize(joints);
  hand_dof_.resize(joints);
  for (int i = 0; i < joints; ++i) {
    FindHinge(model, Name("hand", side, layout_->joints[i]), hand_qpos_[i], hand_dof_[i],
              hand_lower[i], hand_upper[i]);
  }
  // Activations stand in the order of the actuators that have one: here the valves.
  for (int i = 0; i < kNumValves; ++i) {
    const int valve = IdOf(model, mjOBJ_ACTUATOR, Name("hand", side, layout_->valves[i]));
    ThrowUnless(model.actuator_dyntype[valve] != mjDYN_NONE,
                "actuator '{}' has no pressure state, expected dynamics such as filter",
                NameOf(model, mjOBJ_ACTUATOR, valve));
    valve_ctrl_[i] = valve;
    min_valve_control_[i] = model.actuator_ctrlrange[2 * valve];
    max_valve_control_[i] = model.actuator_ctrlrange[2 * valve + 1];
    valve_act_[i] = 0;
    for (int a = 0; a < valve; ++a) valve_act_[i] += model.actuator_dyntype[a] != mjDYN_NONE;
  }
  hand_site_ = IdOf(model, mjOBJ_SITE, Name("hand", side, "H"));
  for (int f = 0; f < kNumFingers; ++f) {
    tip_sites_[f] = IdOf(model, mjOBJ_SITE, Name("hand", side, kFingerNames[f]) + "_tip");
  }
}

RobotState RobotIo::Read(const Simulation& simulation) const {
  const mjModel& model = simulation.model();
  const mjData& data = simulation.data();
  RobotState state;
  state.t = data.time;
  for (int i = 0; i < kNumArmJoints; ++i) {
    state.arm_q[i] = data.qpos[arm_qpos_[i]];
    state.arm_qd[i] = data.qvel[arm_dof_[i]];
    state.arm_bias[i] = data.qfrc_bias[arm_dof_[i]];
  }
  state.hand_q.resize(layout_->num_joints());
  state.hand_qd.resize(layout_->num_joints());
  state.hand_bias.resize(layout_->num_joints());
  for (int i = 0; i < layout_->num_joints(); ++i) {
    state.hand_q[i] = data.qpos[hand_qpos_[i]];
    state.hand_qd[i] = data.qvel[hand_dof_[i]];
    state.hand_bias[i] = data.qfrc_bias[hand_dof_[i]];
  }
  for (int i = 0; i < kNumValves; ++i) state.pressure[i] = data.act[valve_act_[i]];
  // MuJoCo keeps row i of the inertia sparse: its own dof, then that dof's ancestors.
  state.arm_mass.setZero();
  for (int i = 0; i < kNumArmJoints; ++i) {
    int address = model.dof_Madr[arm_dof_[i]];
    for (int dof = arm_dof_[i]; dof >= 0; dof = model.dof_parentid[dof], ++address) {
      const auto* found = std::find(arm_dof_.begin(), arm_dof_.end(), dof);
      if (found == arm_dof_.end()) continue;
      const auto j = found - arm_dof_.begin();
      state.arm_mass(i, j) = state.arm_mass(j, i) = data.qM[address];
    }
  }
  return state;
}

void RobotIo::Write(const RobotCommand& command, Simulation& simulation) const {
  for (int i = 0; i < kNumArmJoints; ++i) {
    simulation.SetControl(arm_ctrl_[i],
                          std::clamp(command.arm_torque[i], -max_arm_torque[i], max_arm_torque[i]));
  }
  for (int i = 0; i < kNumValves; ++i) {
    simulation.SetControl(valve_ctrl_[i], std::clamp(command.valve_pressure[i],
                                                     min_valve_control_[i], max_valve_control_[i]));
  }
}

void RobotIo::Place(const ArmVector& arm_q, const HandVector& hand_q,
                    Simulation& simulation) const {
  mjData& data = simulation.mutable_data();
  for (int i = 0; i < kNumArmJoints; ++i) data.qpos[arm_qpos_[i]] = arm_q[i];
  for (int i = 0; i < layout_->num_joints(); ++i) data.qpos[hand_qpos_[i]] = hand_q[i];
}

void RobotIo::MoveArm(const ArmVector& q, const ArmVector& qd, Simulation& simulation) const {
  mjData& data = simulation.mutable_data();
  for (int i = 0; i < kNumArmJoints; ++i) {
    data.qpos[arm_qpos_[i]] = q[i];
    data.qvel[arm_dof_[i]] = qd[i];
  }
}

void RobotIo::MoveHand(const HandVector& q, const HandVector& qd, Simulation& simulation) const {
  mjData& data = simulation.mutable_data();
  for (int i = 0; i < layout_->num_joints(); ++i) {
    data.qpos[hand_qpos_[i]] = q[i];
    data.qvel[hand_dof_[i]] = qd[i];
  }
}

Pose RobotIo::HandPose(const Simulation& simulation) const {
  const mjData& data = simulation.data();
  return PoseFromXmat(data.site_xpos + 3 * hand_site_, data.site_xmat + 9 * hand_site_);
}

Eigen::Vector3d RobotIo::Fingertip(const Simulation& simulation, int finger) const {
  return Vector3From(simulation.data().site_xpos + 3 * tip_sites_[finger]);
}

}  // namespace springgrasp
