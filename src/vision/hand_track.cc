#include <Eigen/Dense>
#include <cmath>

#include "vision/hand_pose.h"

namespace springgrasp {

std::vector<HandSample> SmoothHandTrack(const std::vector<HandSample>& track, double half_window) {
  std::vector<HandSample> smooth = track;
  for (std::size_t i = 0; i < track.size(); ++i) {
    // Weighted quadratic in (t - t_i); tricube weights. The constant term is the smoothed value.
    const auto regress = [&](auto&& value, Eigen::Vector3d& out) {
      Eigen::Matrix3d A = Eigen::Matrix3d::Zero(), B = Eigen::Matrix3d::Zero();
      int count = 0;
      for (std::size_t k = 0; k < track.size(); ++k) {
        const double dt = track[k].t - track[i].t, u = std::abs(dt) / half_window;
        const std::optional<Eigen::Vector3d> sample = u < 1 ? value(track[k]) : std::nullopt;
        if (!sample) continue;
        const double weight = std::pow(1 - u * u * u, 3);
        const Eigen::Vector3d basis(1, dt / half_window, dt * dt / (half_window * half_window));
        A += weight * basis * basis.transpose();
        B += weight * basis * sample->transpose();
        ++count;
      }
      if (count < 4) return false;
      A.diagonal().array() += 1e-9;
      out = A.ldlt().solve(B).row(0).transpose();
      return true;
    };
    Eigen::Vector3d value;
    if (track[i].p_WH && regress([](const HandSample& s) { return s.p_WH; }, value)) {
      smooth[i].p_WH = value;
    }
    if (!track[i].R_WH) continue;
    const Eigen::Quaterniond centre = *track[i].R_WH;
    const auto turn = [&](const HandSample& s) -> std::optional<Eigen::Vector3d> {
      if (!s.R_WH) return std::nullopt;
      return LogRotation(centre.conjugate() * *s.R_WH);
    };
    if (regress(turn, value)) smooth[i].R_WH = (centre * ExpRotation(value)).normalized();
  }
  return smooth;
}

}  // namespace springgrasp
