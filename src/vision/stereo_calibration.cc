#include <Eigen/Dense>
#include <opencv2/core.hpp>
#include <opencv2/core/persistence.hpp>

#include "base/error.h"
#include "base/files.h"
#include "vision/camera_model.h"

namespace springgrasp {
namespace {

cv::FileStorage OpenCalibration(const std::string& path) {
  ReadFile(path);  // names the path when it cannot be read
  try {
    cv::FileStorage storage(path, cv::FileStorage::READ);
    if (storage.isOpened()) return storage;
  } catch (const cv::Exception&) {
    // Reported below in the project's own words.
  }
  Fail("{}: not a calibration file that OpenCV reads (YAML, XML or JSON)", path);
}

// Matrix `name` as doubles. `count` < 0 takes any number of elements.
cv::Mat ReadMatrix(const cv::FileStorage& storage, const std::string& path, const char* name,
                   int rows, int cols) {
  cv::Mat matrix;
  try {
    const cv::FileNode node = storage[name];
    ThrowUnless(!node.empty(), "{}: matrix '{}' is missing", path, name);
    node >> matrix;
  } catch (const cv::Exception&) {
    Fail("{}: '{}' is not a matrix that OpenCV reads", path, name);
  }
  ThrowUnless(!matrix.empty() && matrix.channels() == 1, "{}: '{}' is not a matrix", path, name);
  matrix.convertTo(matrix, CV_64F);
  matrix = matrix.clone();
  if (rows > 0) {
    ThrowUnless(matrix.rows * matrix.cols == rows * cols,
                "{}: matrix '{}' is {}x{}, expected {}x{}", path, name, matrix.rows, matrix.cols,
                rows, cols);
  }
  for (std::size_t i = 0; i < matrix.total(); ++i) {
    ThrowUnless(std::isfinite(matrix.ptr<double>()[i]),
                "{}: matrix '{}' has a value that is not a number", path, name);
  }
  return matrix;
}

CameraModel ReadCamera(const cv::FileStorage& storage, const std::string& path, const char* M,
                       const char* D, int width, int height) {
  const cv::Mat K = ReadMatrix(storage, path, M, 3, 3);
  const cv::Mat k = ReadMatrix(storage, path, D, 0, 0);
  const double* m = K.ptr<double>();
  ThrowUnless(
      m[0] > 1 && m[4] > 1 && m[8] == 1,
      "{}: camera matrix '{}' has focal lengths {} and {}, expected positive ones in pixels", path,
      M, m[0], m[4]);
  // The axis of a camera for this size lies in the middle half of the picture.
  ThrowUnless(
      m[2] > 0.25 * width && m[2] < 0.75 * width && m[5] > 0.25 * height && m[5] < 0.75 * height,
      "{}: camera matrix '{}' has its centre at ({}, {}), not that of {}x{} pictures", path, M,
      m[2], m[5], width, height);
  CameraModel camera;
  camera.width = width;
  camera.height = height;
  camera.fx = m[0];
  camera.fy = m[4];
  camera.cx = m[2];
  camera.cy = m[5];
  const double* d = k.ptr<double>();
  for (std::size_t i = 0; i < k.total(); ++i) {
    ThrowUnless(
        i < camera.distortion.size() || d[i] == 0,
        "{}: distortion '{}' has {} coefficients, expected at most 8 (k1 k2 p1 p2 k3 k4 k5 k6)",
        path, D, k.total());
    if (i < camera.distortion.size()) camera.distortion[i] = d[i];
  }
  return camera;
}

}  // namespace

StereoCameras ReadStereoCalibration(const std::string& intrinsics, const std::string& extrinsics,
                                    int width, int height, const Pose& X_WL) {
  StereoCameras cameras;
  const cv::FileStorage in = OpenCalibration(intrinsics);
  cameras.left = ReadCamera(in, intrinsics, "M1", "D1", width, height);
  cameras.right = ReadCamera(in, intrinsics, "M2", "D2", width, height);
  const cv::FileStorage ex = OpenCalibration(extrinsics);
  const cv::Mat R = ReadMatrix(ex, extrinsics, "R", 3, 3);
  const cv::Mat T = ReadMatrix(ex, extrinsics, "T", 3, 1);
  Pose X_RL = Pose::Identity();
  X_RL.linear() = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(R.ptr<double>());
  X_RL.translation() = Eigen::Map<const Eigen::Vector3d>(T.ptr<double>());
  const double skew = (X_RL.linear() * X_RL.linear().transpose() - Eigen::Matrix3d::Identity())
                          .cwiseAbs()
                          .maxCoeff();
  ThrowUnless(skew < 1e-3 && X_RL.linear().determinant() > 0,
              "{}: matrix 'R' is not a rotation (R R' differs from 1 by {})", extrinsics, skew);
  const double baseline = X_RL.translation().norm();
  ThrowUnless(baseline > 1e-3 && baseline < 5,
              "{}: 'T' is {} long, expected a baseline of 0.001 to 5 metres", extrinsics, baseline);
  X_RL.linear() = Eigen::Quaterniond(X_RL.linear()).normalized().toRotationMatrix();
  cameras.left.X_WC = X_WL;
  cameras.right.X_WC = X_WL * X_RL.inverse();
  return cameras;
}

}  // namespace springgrasp
