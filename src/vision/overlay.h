// Pictures of the tracking in the manner of the paper's Fig. 4.
#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "base/fingers.h"
#include "vision/camera_model.h"
#include "vision/fingertip_tracker.h"

namespace springgrasp {

// Thumb red, index light blue, middle blue, ring pink, pinkie dark red (BGR).
inline const PerFinger<cv::Scalar> kFingerColours = {
    cv::Scalar(40, 40, 255), cv::Scalar(255, 215, 110), cv::Scalar(255, 70, 20),
    cv::Scalar(190, 110, 255), cv::Scalar(20, 10, 140)};

struct OverlayOptions {
  bool labels = true;
  const ParticleSet* particles[2] = {nullptr, nullptr};  // drawn as dots where given
  std::optional<Pose> X_WH;                              // hand frame drawn as three axes
  double t = -1;                                         // s, written in a corner if not negative
};

// Left and right picture side by side with circles about the fingers; a finger seen in one view
// only has a thin circle; missing ones are listed at the bottom. Returns CV_8UC3 of twice the
// width.
cv::Mat DrawOverlay(const cv::Mat& left, const cv::Mat& right, const StereoCameras& cameras,
                    const TrackedFrame& frame, double cap_radius,
                    const OverlayOptions& options = {});

}  // namespace springgrasp
