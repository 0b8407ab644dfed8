// A stereo recording made for a test: drawn hand, calibration, in a folder.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>
#include <string>

#include "base/files.h"
#include "base/fingers.h"
#include "vision/synthetic_caps.h"

namespace springgrasp {

inline std::string CalibrationMatrix(const std::string& name, int rows, int cols,
                                     const std::string& data) {
  return fmt::format("{}: !!opencv-matrix\n   rows: {}\n   cols: {}\n   dt: d\n   data: [ {} ]\n",
                     name, rows, cols, data);
}

// As stereo_calib writes it.
inline std::string IntrinsicsText(const StereoCameras& eyes) {
  std::string text = "%YAML:1.0\n---\n";
  for (int v = 0; v < 2; ++v) {
    const CameraModel& c = eyes.view(v);
    text += CalibrationMatrix(
        fmt::format("M{}", v + 1), 3, 3,
        fmt::format("{}, 0., {}, 0., {}, {}, 0., 0., 1.", c.fx, c.cx, c.fy, c.cy));
    text += CalibrationMatrix(fmt::format("D{}", v + 1), 1, 8,
                              fmt::format("{}", fmt::join(c.distortion, ", ")));
  }
  return text;
}

inline std::string ExtrinsicsText(const StereoCameras& eyes) {
  const Pose X_RL = eyes.right.X_WC.inverse() * eyes.left.X_WC;
  const Eigen::Matrix3d R_t = X_RL.linear().transpose();  // column-major storage: rows of R
  const Eigen::Vector3d T = X_RL.translation();
  return "%YAML:1.0\n---\n" +
         CalibrationMatrix("R", 3, 3,
                           fmt::format("{}", fmt::join(R_t.data(), R_t.data() + 9, ", "))) +
         CalibrationMatrix("T", 3, 1, fmt::format("{}", fmt::join(T.data(), T.data() + 3, ", ")));
}

// TestEyes for pictures of another size: the same view, scaled.
inline StereoCameras EyesOfSize(int width, int height) {
  StereoCameras eyes = TestEyes();
  const double scale = height / 480.0;
  for (CameraModel* camera : {&eyes.left, &eyes.right}) {
    camera->width = width;
    camera->height = height;
    camera->fx *= scale;
    camera->fy *= scale;
    camera->cx = 0.5 * (width - 1);
    camera->cy = 0.5 * (height - 1);
  }
  return eyes;
}

// Frame i of a hand that moves and closes a little at each step.
inline DrawnHand HandOfFrame(int i) {
  return MakeDrawnHand({0.06 - 0.002 * i, 0.05, 0.62}, 0.02 * i);
}

// Draws frames of that hand, or one that keeps still, which is faster; as left_000.png ... and
// right_000.png ...
inline void DrawRecording(const StereoCameras& eyes, int frames, const std::string& folder,
                          bool still = false) {
  cv::Mat left, right;
  for (int i = 0; i < frames; ++i) {
    if (i == 0 || !still) {
      const DrawnHand hand = HandOfFrame(i);
      left = DrawCapsules(eyes.left, hand.capsules);
      right = DrawCapsules(eyes.right, hand.capsules);
    }
    const std::vector<int> fast = {cv::IMWRITE_PNG_COMPRESSION, 1};
    cv::imwrite(fmt::format("{}/left_{:03d}.png", folder, i), left, fast);
    cv::imwrite(fmt::format("{}/right_{:03d}.png", folder, i), right, fast);
  }
}

// Truth of DrawRecording at 30 Hz, in the left camera's frame.
inline std::string TruthText(int frames, bool still = false) {
  std::string text = "t";
  for (const std::string_view finger : kFingerNames) {
    for (const char axis : {'x', 'y', 'z'}) text += fmt::format(",{}_{}", finger, axis);
  }
  text += "\n";
  for (int i = 0; i < frames; ++i) {
    text += fmt::format("{}", i / 30.0);
    for (const auto& p : HandOfFrame(still ? 0 : i).tips)
      text += fmt::format(",{},{},{}", p.x(), p.y(), p.z());
    text += "\n";
  }
  return text;
}

}  // namespace springgrasp
