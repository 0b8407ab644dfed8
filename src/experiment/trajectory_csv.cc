#include "experiment/trajectory_csv.h"

#include <fmt/format.h>

#include <iterator>

namespace springgrasp {
namespace {

template <typename Values>
void Append(std::string& text, const Values& values) {
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    fmt::format_to(std::back_inserter(text), ",{:.6g}", values[i]);
  }
}

void AppendPoseNames(std::string& text, const char* name) {
  for (const char* part : {"x", "y", "z", "qw", "qx", "qy", "qz"}) {
    text += fmt::format(",{}_{}", name, part);
  }
}

}  // namespace

std::string FormatTrajectory(const std::vector<TrajectorySample>& trajectory,
                             const HandLayout& hand) {
  std::string text = "t,phase";
  AppendPoseNames(text, "object");
  AppendPoseNames(text, "hand");
  AppendPoseNames(text, "hand_planned");
  for (const auto finger : kFingerNames) text += fmt::format(",{0}_x,{0}_y,{0}_z", finger);
  for (const auto finger : kFingerNames) {
    text += fmt::format(",{0}_planned_x,{0}_planned_y,{0}_planned_z", finger);
  }
  for (const auto finger : kFingerNames) text += fmt::format(",{}_normal_n", finger);
  text += ",palm_normal_n";
  for (const auto joint : kArmJointNames) text += fmt::format(",arm_{}", joint);
  for (const auto joint : hand.joints) text += fmt::format(",hand_{}", joint);
  for (const auto joint : hand.joints) text += fmt::format(",hand_planned_{}", joint);
  for (const auto valve : hand.valves) text += fmt::format(",{}_bar", valve);
  for (const auto joint : kArmJointNames) text += fmt::format(",{}_torque_nm", joint);
  for (const auto valve : hand.valves) text += fmt::format(",{}_command_bar", valve);
  for (const auto finger : kFingerNames) text += fmt::format(",{}_force_target_n", finger);
  for (const auto finger : kFingerNames) text += fmt::format(",{}_force_sensed_n", finger);
  text += '\n';
  for (const TrajectorySample& s : trajectory) {
    text += fmt::format("{:.4f},{}", s.t, PhaseName(s.phase));
    Append(text, PoseToArray(s.X_WO));
    Append(text, PoseToArray(s.X_WH));
    Append(text, PoseToArray(s.X_WH_planned));
    for (const Eigen::Vector3d& tip : s.p_WF) Append(text, tip);
    for (const Eigen::Vector3d& tip : s.p_WF_planned) Append(text, tip);
    for (const double n : s.normal) text += fmt::format(",{:.4g}", n);
    text += fmt::format(",{:.4g}", s.palm_normal);
    Append(text, s.state.arm_q);
    Append(text, s.state.hand_q);
    Append(text, s.hand_planned);
    Append(text, s.state.pressure);
    Append(text, s.command.arm_torque);
    Append(text, s.command.valve_pressure);
    for (const double n : s.force_target) text += fmt::format(",{:.4g}", n);
    for (const double n : s.force_sensed) text += fmt::format(",{:.4g}", n);
    text += '\n';
  }
  return text;
}

}  // namespace springgrasp
