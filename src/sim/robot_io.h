// The one place that knows where the robot's joints and actuators lie in qpos, qvel, act and ctrl.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/pose.h"
#include "control/robot_state.h"
#include "sim/simulation.h"

namespace springgrasp {

// Addresses of one side's arm and hand. `side` is "r" (or "l").
class RobotIo {
 public:
  // Throws Error naming the joint, actuator or site that the model lacks.
  explicit RobotIo(const mjModel& model, const std::string& side = "r");

  // The hand with an opposition joint if the model has that joint, else the documented one.
  const HandLayout& layout() const { return *layout_; }

  RobotState Read(const Simulation& simulation) const;
  void Write(const RobotCommand& command, Simulation& simulation) const;

  // Sets joints (not velocities); call simulation.Forward() afterwards.
  void Place(const ArmVector& arm_q, const HandVector& hand_q, Simulation& simulation) const;

  // Sets joints and their velocities; for ideal drives, in the place of Write.
  void MoveArm(const ArmVector& q, const ArmVector& qd, Simulation& simulation) const;
  void MoveHand(const HandVector& q, const HandVector& qd, Simulation& simulation) const;

  // Hand frame and pad centres now (truth; for records, not for control).
  Pose HandPose(const Simulation& simulation) const;
  Eigen::Vector3d Fingertip(const Simulation& simulation, int finger) const;

  ArmVector arm_lower, arm_upper;     // rad
  HandVector hand_lower, hand_upper;  // rad, in the layout's order
  ArmVector max_arm_torque;           // Nm

 private:
  const HandLayout* layout_;
  std::array<int, kNumArmJoints> arm_qpos_, arm_dof_, arm_ctrl_;
  std::vector<int> hand_qpos_, hand_dof_;
  std::array<int, kNumValves> valve_ctrl_, valve_act_;
  ValveVector min_valve_control_, max_valve_control_;  // of the model, bar
  int hand_site_ = -1;
  std::array<int, 5> tip_sites_;
};

}  // namespace springgrasp
