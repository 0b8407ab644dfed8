#include "vision/object_depth.h"

#include <cmath>

#include "base/shape_ray.h"

namespace springgrasp {

double ObjectDepth::At(const Eigen::Vector2d& pixel) const {
  const int j = static_cast<int>(std::lround(pixel.x() / step));
  const int i = static_cast<int>(std::lround(pixel.y() / step));
  if (i < 0 || j < 0 || i >= depth.rows || j >= depth.cols) return 1e9;
  return static_cast<double>(depth.at<float>(i, j));
}

ObjectDepth SeeObject(const CameraModel& camera, const DemonstratedObject& object, int step) {
  ObjectDepth seen;
  seen.step = step;
  seen.depth.create((camera.height + step - 1) / step, (camera.width + step - 1) / step, CV_32FC1);
  const Pose X_OW = object.X_WO.inverse();
  const Eigen::Vector3d p_O = X_OW * camera.X_WC.translation();
  const Eigen::Vector3d forward = camera.X_WC.linear().col(2);
  for (int i = 0; i < seen.depth.rows; ++i) {
    for (int j = 0; j < seen.depth.cols; ++j) {
      const Eigen::Vector3d ray = PixelRay(camera, Eigen::Vector2d(j * step, i * step));
      const auto span = RayThrough(object.shape, p_O, X_OW.linear() * ray);
      seen.depth.at<float>(i, j) = span ? static_cast<float>(span->enter * ray.dot(forward)) : 1e9f;
    }
  }
  return seen;
}

}  // namespace springgrasp
