// Names to ids and back. A missing name is an error that lists the names that exist.
#pragma once

#include <mujoco/mujoco.h>

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "base/pose.h"

namespace springgrasp {

// Id of a named element (mjOBJ_BODY, mjOBJ_JOINT, ...). Throws Error listing the existing names.
int IdOf(const mjModel& model, mjtObj type, const std::string& name);
// -1 when absent.
int FindId(const mjModel& model, mjtObj type, const std::string& name);
// Empty for a nameless element.
std::string NameOf(const mjModel& model, mjtObj type, int id);
// Names of all elements of a type, by id.
std::vector<std::string> NamesOf(const mjModel& model, mjtObj type);

// Pose from MuJoCo's position and row-major 3x3 matrix (xpos/xmat), or w-first quaternion.
Pose PoseFromXmat(const mjtNum* pos, const mjtNum* mat);
Pose PoseFromQuat(const mjtNum* pos, const mjtNum* quat);
Eigen::Vector3d Vector3From(const mjtNum* v);

// World poses at the instant of the last kinematics.
Pose BodyPose(const mjModel& model, const mjData& data, const std::string& body);
Pose SitePose(const mjModel& model, const mjData& data, const std::string& site);

}  // namespace springgrasp
