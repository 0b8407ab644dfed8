// A calibrated camera and what two of them say about a point. Pixels: whole numbers are pixel
// centres, (0, 0) the upper left one, u right, v down. Camera axes as OpenCV: x right, y down,
// z forward.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>

#include "base/pose.h"

namespace springgrasp {

struct CameraModel {
  int width = 640, height = 480;          // px
  double fx = 540.5, fy = 540.5;          // px
  double cx = 319.5, cy = 239.5;          // px
  std::array<double, 8> distortion = {};  // OpenCV's k1 k2 p1 p2 k3 k4 k5 k6; zeros: pinhole
  Pose X_WC = Pose::Identity();           // pose of the camera in W
  bool distorted() const;
};

// Camera with square pixels and centred axis; K is [f 0 cx; 0 f cy; 0 0 1] as rendered.
CameraModel PinholeCamera(int width, int height, const Eigen::Matrix3d& K, const Pose& X_WC);

// Pixel of a point of the world; nothing for points behind the camera (depth < 1 mm).
std::optional<Eigen::Vector2d> Project(const CameraModel& camera, const Eigen::Vector3d& p_WQ);
// The same with the derivative d pixel / d p_WQ (2 x 3), lens distortion included.
std::optional<Eigen::Vector2d> Project(const CameraModel& camera, const Eigen::Vector3d& p_WQ,
                                       Eigen::Matrix<double, 2, 3>* J);

// Direction (in W, unit) of the ray through a pixel; distortion undone by fixed-point iteration.
Eigen::Vector3d PixelRay(const CameraModel& camera, const Eigen::Vector2d& pixel);

struct StereoCameras {
  CameraModel left, right;
  const CameraModel& view(int i) const { return i == 0 ? left : right; }
};

struct TriangulatedPoint {
  Eigen::Vector3d p_WQ;
  double residual_px = 0;  // root mean square reprojection error of the four coordinates
};

// Point seen at pixel `left` and `right`: midpoint of the rays, then Gauss-Newton steps on the
// reprojection error. Nothing for parallel rays or a point behind a camera.
std::optional<TriangulatedPoint> Triangulate(const StereoCameras& cameras,
                                             const Eigen::Vector2d& left,
                                             const Eigen::Vector2d& right);

// Distance of `right` from the epipolar line of `left` in the right picture, px (lens distortion
// accounted for to first order).
double EpipolarDistance(const StereoCameras& cameras, const Eigen::Vector2d& left,
                        const Eigen::Vector2d& right);

// Reads calibration as OpenCV's `stereo_calib` sample writes it (YAML): intrinsics with M1 D1 M2
// D2, extrinsics with R T (T in metres, x_right = R x_left + T). `X_WL` is the pose of the left
// camera. Throws Error naming file and matrix if one is missing, of a wrong size, singular, not
// finite, not a rotation, or for pictures of another size than width x height.
StereoCameras ReadStereoCalibration(const std::string& intrinsics, const std::string& extrinsics,
                                    int width, int height, const Pose& X_WL = Pose::Identity());

struct CalibrationText {
  std::string text, name;  // content of a file, and how messages call it
};
StereoCameras ParseStereoCalibration(const CalibrationText& intrinsics,
                                     const CalibrationText& extrinsics, int width, int height,
                                     const Pose& X_WL = Pose::Identity());

}  // namespace springgrasp
