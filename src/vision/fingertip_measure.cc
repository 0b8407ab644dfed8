#include "vision/fingertip_tracker_impl.h"

namespace springgrasp {

using namespace tracker_internal;  // NOLINT: the tracker's own names

// The finger's direction: in the picture plane away from the skin next to the cap, in depth as
// before.
Eigen::Vector3d FingertipTracker::Impl::ExpectedAxis(const std::array<const cv::Mat*, 2>& pictures,
                                                     int f) const {
  const Eigen::Vector3d& before = fingers[f].axis_W;
  Eigen::Vector3d across = Eigen::Vector3d::Zero();
  for (int v = 0; v < 2; ++v) {
    if (!views[v].active[f]) continue;
    const double r = RadiusPx(v, fingers[f].p_W);
    const Eigen::Vector2d away = -SkinDirection(*pictures[v], skin, views[v].region[f], r);
    across += 0.5 * cameras.view(v).X_WC.linear() * Eigen::Vector3d(away.x(), away.y(), 0);
  }
  const double strength = across.norm();
  if (strength < 0.2) return before;
  const Eigen::Vector3d forward = cameras.left.X_WC.linear().col(2);
  // Fingers of a palm that faces the camera bend towards it: a weak pull, which outlines overrule.
  const double depth = 0.85 * before.dot(forward) + 0.15 * kUsualDepth;
  const Eigen::Vector3d flat = across - across.dot(forward) * forward;
  const Eigen::Vector3d seen =
      depth * forward + std::sqrt(std::max(0.0, 1 - depth * depth)) * flat.normalized();
  return (before + std::min(1.0, 1.5 * strength) * seen).normalized();
}

// Positions in space from the regions of both views.
TrackedFrame FingertipTracker::Impl::Measure(const std::array<const cv::Mat*, 2>& pictures) {
  TrackedFrame frame;
  for (int f = 0; f < kNumFingers; ++f) {
    TrackedFinger& out = frame.fingers[f];
    for (int v = 0; v < 2; ++v) {
      if (views[v].active[f]) out.pixel[v] = views[v].region[f];
    }
    if (!out.pixel[0] || !out.pixel[1]) continue;
    const auto point = Triangulate(cameras, *out.pixel[0], *out.pixel[1]);
    if (!point) continue;
    out.residual_px = EpipolarDistance(cameras, *out.pixel[0], *out.pixel[1]);
    if (out.residual_px > options.max_epipolar_px) continue;
    out.p_W = point->p_WQ;
    out.axis_W = fingers[f].axis_W;
    double agreement = 1;
    if (options.kind == TrackerKind::kOutline) {
      std::array<CapContour, 2> contours;
      for (int v = 0; v < 2; ++v) {
        const double r = RadiusPx(v, *out.p_W);
        contours[v] = TraceCap(*pictures[v], colour, *out.pixel[v],
                               1.1 * r * cap.full_length() / cap.radius + 4);
      }
      const auto fit = FitCap(cameras, contours, ShapeOf(f), *out.p_W, ExpectedAxis(pictures, f));
      // A fit that wanders off was led by something else than this cap.
      if (fit && (fit->p_W - *out.p_W).norm() < 0.025) {
        out.p_W = fit->p_W;
        out.axis_W = fit->axis_W;
        agreement = std::min(1.0, 1.6 * std::min(fit->agreement[0], fit->agreement[1]));
        for (int v = 0; v < 2; ++v) out.pixel[v] = Project(cameras.view(v), fit->p_W);
        // A running mean over the first frames in which nearly the whole outline is seen.
        FingerState& state = fingers[f];
        if (agreement > 0.9 && state.radius_count < kRadiusFrames) {
          const double radius = std::clamp(fit->radius, 0.85 * cap.radius, 1.15 * cap.radius);
          state.radius += (radius - state.radius) / (2 + state.radius_count++);
        }
      } else {
        agreement = 0.3;
      }
    }
    const double mass = std::min(views[0].mass[f], views[1].mass[f]);
    const double similarity = std::min(views[0].similarity[f], views[1].similarity[f]);
    const double together = std::exp(-0.5 * std::pow(out.residual_px / options.max_epipolar_px, 2));
    out.confidence = std::min(1.0, 1.2 * mass) * similarity * together * (0.4 + 0.6 * agreement);
  }
  return frame;
}

}  // namespace springgrasp
