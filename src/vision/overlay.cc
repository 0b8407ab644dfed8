#include "vision/overlay.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

namespace springgrasp {
namespace {

void OutlinedText(cv::Mat& picture, const std::string& text, cv::Point at, const cv::Scalar& colour,
                  double scale) {
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, scale, {255, 255, 255}, 3, cv::LINE_AA);
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, scale, colour, 1, cv::LINE_AA);
}

cv::Point ToPoint(const Eigen::Vector2d& pixel, int shift) {
  return {static_cast<int>(std::lround(pixel.x())) + shift,
          static_cast<int>(std::lround(pixel.y()))};
}

}  // namespace

cv::Mat DrawOverlay(const cv::Mat& left, const cv::Mat& right, const StereoCameras& cameras,
                    const TrackedFrame& frame, double cap_radius, const OverlayOptions& options) {
  cv::Mat both(left.rows, left.cols + right.cols, CV_8UC3);
  left.copyTo(both(cv::Rect(0, 0, left.cols, left.rows)));
  right.copyTo(both(cv::Rect(left.cols, 0, right.cols, right.rows)));
  for (int v = 0; v < 2; ++v) {
    const int shift = v * left.cols;
    cv::Mat half = both(cv::Rect(shift, 0, left.cols, left.rows));
    if (options.particles[v] != nullptr) {
      for (const Regions& particle : options.particles[v]->regions) {
        for (int f = 0; f < kNumFingers; ++f) {
          cv::circle(half, ToPoint(particle[f], 0), 1, kFingerColours[f], cv::FILLED);
        }
      }
    }
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();
    int count = 0;
    for (const TrackedFinger& finger : frame.fingers) {
      if (!finger.pixel[v]) continue;
      middle += *finger.pixel[v];
      ++count;
    }
    if (count > 0) middle /= count;
    for (int f = 0; f < kNumFingers; ++f) {
      const TrackedFinger& finger = frame.fingers[f];
      if (!finger.pixel[v]) continue;
      const CameraModel& camera = cameras.view(v);
      double radius = 10;
      if (finger.p_W) {
        const double depth =
            camera.X_WC.linear().col(2).dot(*finger.p_W - camera.X_WC.translation());
        radius = std::max(4.0, 1.25 * camera.fx * cap_radius / std::max(0.05, depth));
      }
      const cv::Point centre = ToPoint(*finger.pixel[v], 0);
      cv::circle(half, centre, static_cast<int>(std::lround(radius)), {255, 255, 255},
                 finger.p_W ? 3 : 1, cv::LINE_AA);
      cv::circle(half, centre, static_cast<int>(std::lround(radius)), kFingerColours[f],
                 finger.p_W ? 2 : 1, cv::LINE_AA);
      cv::circle(half, centre, 1, {255, 255, 255}, cv::FILLED);
      if (!options.labels) continue;
      // Outside the hand: away from the middle of the tips.
      Eigen::Vector2d away = *finger.pixel[v] - middle;
      away = away.norm() > 1 ? Eigen::Vector2d(away.normalized()) : Eigen::Vector2d(0, -1);
      const Eigen::Vector2d at = *finger.pixel[v] + (radius + 14) * away + Eigen::Vector2d(-20, 5);
      OutlinedText(half, std::string(kFingerNames[f]), ToPoint(at, 0), kFingerColours[f], 0.45);
    }
    if (options.X_WH) {
      const auto origin = Project(cameras.view(v), options.X_WH->translation());
      for (int axis = 0; axis < 3 && origin; ++axis) {
        const auto end = Project(
            cameras.view(v), options.X_WH->translation() + 0.05 * options.X_WH->linear().col(axis));
        const cv::Scalar colours[3] = {{0, 0, 255}, {0, 200, 0}, {255, 0, 0}};
        if (end)
          cv::line(half, ToPoint(*origin, 0), ToPoint(*end, 0), colours[axis], 2, cv::LINE_AA);
      }
    }
  }
  std::string missing;
  for (int f = 0; f < kNumFingers; ++f) {
    if (!frame.fingers[f].p_W) missing.append(" ").append(kFingerNames[f]);
  }
  if (!missing.empty()) {
    OutlinedText(both, "not seen:" + missing, {8, both.rows - 10}, {40, 40, 40}, 0.5);
  }
  if (options.t >= 0) {
    char text[32];
    std::snprintf(text, sizeof(text), "%.2f s", options.t);
    OutlinedText(both, text, {8, 20}, {40, 40, 40}, 0.5);
  }
  return both;
}

}  // namespace springgrasp
