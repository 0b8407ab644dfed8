// Poses and rotations. X_AB is the pose of frame B in frame A, R_AB its rotation, p_AQ a point Q
// in A. Files and MuJoCo write quaternions w first; Eigen's coeffs() has w last: convert here only.
#pragma once

#include <Eigen/Geometry>
#include <vector>

namespace springgrasp {

using Pose = Eigen::Isometry3d;  // rigid transform; metres

// Pose from a translation (m) and a unit quaternion (normalised here).
Pose MakePose(const Eigen::Vector3d& p_AB, const Eigen::Quaterniond& R_AB);

// Pose from seven numbers x y z qw qx qy qz (m, quaternion w first).
Pose PoseFromArray(const double* xyz_wxyz);

// The reverse of PoseFromArray; the quaternion has w >= 0.
Eigen::Matrix<double, 7, 1> PoseToArray(const Pose& X_AB);

// Logarithm of a rotation: axis times angle, angle in [0, pi] (rad).
Eigen::Vector3d LogRotation(const Eigen::Quaterniond& R);
// Exponential of a rotation vector (rad); exact inverse of LogRotation for |w| < pi.
Eigen::Quaterniond ExpRotation(const Eigen::Vector3d& w);

// Angle between two rotations, in [0, pi] (rad).
double RotationDistance(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b);

// Between two poses: straight, turning evenly; u in [0, 1].
Pose Interpolate(const Pose& a, const Pose& b, double u);
// On a path of poses (not empty) at a fraction of an index; before and after it, its ends.
Pose PoseAlong(const std::vector<Pose>& path, double index);

// Right-handed frame whose x is along `x` and whose z is the part of `z_hint` orthogonal to x.
// Throws Error if x is zero or z_hint is parallel to it.
Eigen::Matrix3d FrameFromXZ(const Eigen::Vector3d& x, const Eigen::Vector3d& z_hint);

}  // namespace springgrasp
