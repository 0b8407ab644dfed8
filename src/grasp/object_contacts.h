// Contacts on objects of known shape: signed distance, rays, and what symmetry leaves free.
// Everything is in the object frame O (origin at the shape's centre, upright along z).
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "base/shape.h"

namespace springgrasp {

// Distance from Q to the surface, m; negative inside.
double SignedDistance(const Shape& shape, const Eigen::Vector3d& p_OQ);

// Unit outward normal of the surface nearest to Q (gradient of SignedDistance; finite everywhere).
Eigen::Vector3d OutwardNormal(const Shape& shape, const Eigen::Vector3d& p_OQ);

// Surface point nearest to Q, m.
Eigen::Vector3d NearestSurfacePoint(const Shape& shape, const Eigen::Vector3d& p_OQ);

// Where the ray from `origin` (inside or outside) along `direction` leaves the shape, m. Nothing
// if the ray misses it or the direction is zero.
std::optional<Eigen::Vector3d> RayExit(const Shape& shape, const Eigen::Vector3d& origin,
                                       const Eigen::Vector3d& direction);

// A contact as it is carried from object to object: a ray from the point `height` * size.z above
// O's origin along `direction` (system: "rays from the origin of O, height as a fraction of the
// object's").
struct ContactRay {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  // in O, unit
  double height = 0;                                     // -0.5 (bottom) to 0.5 (top)
};

// A contact of a fingertip of radius r: the tip's centre, one tip radius outside the surface.
struct Contact {
  Eigen::Vector3d p_OC = Eigen::Vector3d::Zero();  // tip centre, m
  Eigen::Vector3d n_O = Eigen::Vector3d::UnitX();  // outward normal at the surface point, unit
};

// Ray whose contact on `shape` is the surface point nearest to the tip centre p_OF.
ContactRay RayOfContact(const Shape& shape, const Eigen::Vector3d& p_OF);

// The reverse for any shape; nothing if the ray meets no surface.
std::optional<Contact> ContactOfRay(const Shape& shape, const ContactRay& ray, double tip_radius);

// Mean distance of the surface from O's origin in the section orthogonal to `normal` (Eq. (6)), m.
double MeanSectionRadius(const Shape& shape, const Eigen::Vector3d& normal);

// Rotations R about O's axes that leave the shape as it is; `free_axis` marks a continuum.
struct Symmetry {
  bool any_rotation = false;                  // sphere
  bool about_z = false;                       // sphere and cylinder: any angle about z
  std::vector<Eigen::Quaterniond> rotations;  // discrete: identity first; box and cylinder
};
Symmetry SymmetryOf(const Shape& shape, double tolerance = 1e-3);

// Yaw angles (rad, in (-pi, pi], 0 first) by which the object may be turned about z without being
// changed: `steps` even ones where it is round, multiples of 90 or 180 degrees for a box.
std::vector<double> FreeYaws(const Shape& shape, int steps);

}  // namespace springgrasp
