// What a known object hides from a camera.
#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core.hpp>

#include "base/pose.h"
#include "demonstration/demonstration.h"
#include "vision/camera_model.h"

namespace springgrasp {

// Depth along the optical axis of the object's surface: entry (i, j) stands for picture pixel
// (j * step, i * step).
struct ObjectDepth {
  cv::Mat depth;  // CV_32FC1, m; 1e9 where the object is not
  int step = 2;
  bool Covers(const Eigen::Vector2d& pixel) const { return At(pixel) < 1e8; }
  // Of the nearest entry; 1e9 outside the picture.
  double At(const Eigen::Vector2d& pixel) const;
};
ObjectDepth SeeObject(const CameraModel& camera, const DemonstratedObject& object, int step = 2);

// The object as both eyes see it.
struct KnownObject {
  DemonstratedObject object;
  std::array<ObjectDepth, 2> depth;  // left, right
};

}  // namespace springgrasp
