// What the file of an object tells besides its looks: mass, friction, and where it is solid.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "base/pose.h"

namespace springgrasp {

// One convex part that can be touched.
struct ObjectPart {
  enum class Kind { kSphere, kCapsule, kCylinder, kEllipsoid, kBox, kMesh };
  Kind kind = Kind::kSphere;
  // m: sphere: radius; capsule and cylinder: radius, half length along z (in the first two);
  // ellipsoid and box: half extents.
  Eigen::Vector3d size = Eigen::Vector3d::Zero();
  Pose X_OP = Pose::Identity();
  std::vector<Eigen::Vector3d> vertices;  // mesh: p_PV, m
};

struct ObjectFile {
  double mass = 0;      // kg
  double friction = 0;  // sliding coefficient, the least of its parts
  std::vector<ObjectPart> parts;
};

// Reads an MJCF (.xml) with exactly one body in its world, whose frame is O, or a mesh (as if of
// water, with MuJoCo's friction). Throws Error.
ObjectFile ReadObjectFile(const std::string& path);

// How far the parts reach from the origin of O along a unit direction, m. Zero without parts.
double ReachOf(const std::vector<ObjectPart>& parts, const Eigen::Vector3d& direction_O);

}  // namespace springgrasp
