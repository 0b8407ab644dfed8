#include "grasp/fingertip_motion.h"

#include <fmt/format.h>

#include <iterator>

namespace springgrasp {
namespace {

void AppendPose(std::string& out, const Pose& pose) {
  for (const double value : PoseToArray(pose)) {
    fmt::format_to(std::back_inserter(out), ",{:.9g}", value);
  }
}

}  // namespace

std::string FormatFingertipMotion(const FingertipMotion& motion) {
  std::string out;
  auto to = std::back_inserter(out);
  fmt::format_to(to, "# grasp: {}\n# object: {}; pose:", motion.type, FormatShape(motion.shape));
  for (const double value : PoseToArray(motion.X_WO)) fmt::format_to(to, " {:.9g}", value);
  fmt::format_to(to, "\n# T: {:.9g} s; t_switch: {:.9g} s\n", motion.T, motion.t_switch);
  out += "t,f_cen";
  for (const std::string_view frame : {"grasp", "wrist"}) {
    for (const std::string_view c : {"x", "y", "z", "qw", "qx", "qy", "qz"}) {
      fmt::format_to(to, ",{}_{}", frame, c);
    }
  }
  for (const std::string_view finger : kFingerNames) {
    fmt::format_to(to, ",{0}_x,{0}_y,{0}_z", finger);
  }
  out += '\n';
  for (const FingertipMotionSample& sample : motion.samples) {
    fmt::format_to(to, "{:.9g},{:.9g}", sample.t, sample.f_cen);
    AppendPose(out, sample.X_WG);
    AppendPose(out, sample.X_WH);
    for (const Eigen::Vector3d& p_HF : sample.p_HF) {
      const Eigen::Vector3d p = sample.X_WH * p_HF;
      fmt::format_to(to, ",{:.9g},{:.9g},{:.9g}", p.x(), p.y(), p.z());
    }
    out += '\n';
  }
  return out;
}

}  // namespace springgrasp
