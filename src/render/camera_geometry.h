// Intrinsics and poses of a model's cameras, as OpenCV wants them: x right, y down, z forward.
#pragma once

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <string>
#include <vector>

#include "base/pose.h"

namespace springgrasp {

// K of an ideal pinhole: focal length (px) = height / (2 tan(fovy / 2)) on both axes, principal
// point ((width - 1) / 2, (height - 1) / 2): whole numbers are the centres of pixels, and (0, 0) is
// the centre of the upper left one.
Eigen::Matrix3d PinholeMatrix(double fovy_deg, int width, int height);

// Vertical field of view of a named camera, degrees. Throws Error listing the cameras.
double CameraFovyDeg(const mjModel& model, const std::string& camera);

// X_WC of a named camera in OpenCV's convention, at the last kinematics of `data`.
Pose CameraPose(const mjModel& model, const mjData& data, const std::string& camera);

// Pose of a camera at `p_WC` looking at `p_WT`, picture upright (world z up).
Pose LookAtPose(const Eigen::Vector3d& p_WC, const Eigen::Vector3d& p_WT);

// Pixel of a world point (u right, v down); z of the result is the depth in metres.
Eigen::Vector3d ProjectToPixel(const Eigen::Matrix3d& K, const Pose& X_WC,
                               const Eigen::Vector3d& p_WQ);

}  // namespace springgrasp
