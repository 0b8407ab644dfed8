#include "render/camera_geometry.h"

#include <cmath>

#include "base/error.h"
#include "sim/model_index.h"

namespace springgrasp {

Eigen::Matrix3d PinholeMatrix(double fovy_deg, int width, int height) {
  const double focal_px = height / (2 * std::tan(fovy_deg * M_PI / 360));
  Eigen::Matrix3d K = Eigen::Matrix3d::Identity();
  K(0, 0) = K(1, 1) = focal_px;
  K(0, 2) = (width - 1) / 2.0;
  K(1, 2) = (height - 1) / 2.0;
  return K;
}

double CameraFovyDeg(const mjModel& model, const std::string& camera) {
  return model.cam_fovy[IdOf(model, mjOBJ_CAMERA, camera)];
}

Pose CameraPose(const mjModel& model, const mjData& data, const std::string& camera) {
  const int id = IdOf(model, mjOBJ_CAMERA, camera);
  Pose X_WC = PoseFromXmat(data.cam_xpos + 3 * id, data.cam_xmat + 9 * id);
  // MuJoCo's cameras look along -z with y up; OpenCV's along +z with y down.
  X_WC.linear().col(1) *= -1;
  X_WC.linear().col(2) *= -1;
  return X_WC;
}

Pose LookAtPose(const Eigen::Vector3d& p_WC, const Eigen::Vector3d& p_WT) {
  const Eigen::Vector3d forward = p_WT - p_WC;
  ThrowUnless(forward.norm() > 1e-9, "a camera cannot look at its own place");
  const Eigen::Vector3d z = forward.normalized();
  const Eigen::Vector3d up =
      std::abs(z.z()) > 0.999 ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d x = z.cross(up).normalized();
  Pose X_WC = Pose::Identity();
  X_WC.linear().col(0) = x;
  X_WC.linear().col(1) = z.cross(x);
  X_WC.linear().col(2) = z;
  X_WC.translation() = p_WC;
  return X_WC;
}

Eigen::Vector3d ProjectToPixel(const Eigen::Matrix3d& K, const Pose& X_WC,
                               const Eigen::Vector3d& p_WQ) {
  const Eigen::Vector3d p_CQ = X_WC.inverse() * p_WQ;
  const Eigen::Vector3d h = K * p_CQ;
  return {h.x() / h.z(), h.y() / h.z(), p_CQ.z()};
}

}  // namespace springgrasp
