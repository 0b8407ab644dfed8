#include "grasp/object_contacts.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/shape_ray.h"
#include "grasp/section_mean.h"

namespace springgrasp {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kTiny = 1e-12;

// A cylinder is a box in the half plane (distance from the axis, |z|): both shapes share the
// exterior/interior distance of an axis-aligned box given by its excess `q` over the half extents.
template <int N>
double BoxDistance(const Eigen::Matrix<double, N, 1>& q) {
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
}

// Gradient of BoxDistance with respect to q.
template <int N>
Eigen::Matrix<double, N, 1> BoxGradient(const Eigen::Matrix<double, N, 1>& q) {
  if (q.maxCoeff() > 0) return q.cwiseMax(0.0).normalized();
  Eigen::Index face = 0;
  q.maxCoeff(&face);
  return Eigen::Matrix<double, N, 1>::Unit(face);
}

double SignOf(double x) { return x < 0 ? -1.0 : 1.0; }

Vector3d BoxExcess(const Shape& shape, const Vector3d& p) {
  return p.cwiseAbs() - 0.5 * shape.size;
}

Vector2d CylinderExcess(const Shape& shape, const Vector3d& p) {
  return {p.head<2>().norm() - 0.5 * shape.size.x(), std::abs(p.z()) - 0.5 * shape.size.z()};
}

}  // namespace

double SignedDistance(const Shape& shape, const Vector3d& p) {
  switch (shape.kind) {
    case Shape::Kind::kSphere:
      return p.norm() - 0.5 * shape.size.x();
    case Shape::Kind::kCylinder:
      return BoxDistance<2>(CylinderExcess(shape, p));
    case Shape::Kind::kBox:
      break;
  }
  return BoxDistance<3>(BoxExcess(shape, p));
}

Vector3d OutwardNormal(const Shape& shape, const Vector3d& p) {
  switch (shape.kind) {
    case Shape::Kind::kSphere:
      return p.norm() > kTiny ? Vector3d(p.normalized()) : Vector3d::UnitX();
    case Shape::Kind::kCylinder: {
      const double rho = p.head<2>().norm();
      const Vector2d radial = rho > kTiny ? Vector2d(p.head<2>() / rho) : Vector2d::UnitX();
      const Vector2d g = BoxGradient<2>(CylinderExcess(shape, p));
      return {g.x() * radial.x(), g.x() * radial.y(), g.y() * SignOf(p.z())};
    }
    case Shape::Kind::kBox:
      break;
  }
  const Vector3d g = BoxGradient<3>(BoxExcess(shape, p));
  return {g.x() * SignOf(p.x()), g.y() * SignOf(p.y()), g.z() * SignOf(p.z())};
}

Vector3d NearestSurfacePoint(const Shape& shape, const Vector3d& p) {
  return p - SignedDistance(shape, p) * OutwardNormal(shape, p);
}

std::optional<Vector3d> RayExit(const Shape& shape, const Vector3d& origin,
                                const Vector3d& direction) {
  if (direction.norm() < kTiny) return std::nullopt;
  const Vector3d d = direction.normalized();
  const auto span = RayThrough(shape, origin, d);
  if (!span) return std::nullopt;
  return Vector3d(origin + span->leave * d);
}

ContactRay RayOfContact(const Shape& shape, const Vector3d& p_OF) {
  const Vector3d surface = NearestSurfacePoint(shape, p_OF);
  ContactRay ray;
  // A contact on an end face has no horizontal ray; its ray starts a little below the face.
  const double limit = shape.kind == Shape::Kind::kSphere ? 0.5 : 0.49;
  ray.height = std::clamp(surface.z() / shape.size.z(), -limit, limit);
  const Vector3d along = surface - Vector3d(0, 0, ray.height * shape.size.z());
  ray.direction =
      along.norm() > kTiny ? Vector3d(along.normalized()) : Vector3d(0, 0, SignOf(surface.z()));
  return ray;
}

std::optional<Contact> ContactOfRay(const Shape& shape, const ContactRay& ray, double tip_radius) {
  const Vector3d origin(0, 0, ray.height * shape.size.z());
  const std::optional<Vector3d> surface = RayExit(shape, origin, ray.direction);
  if (!surface) return std::nullopt;
  // Just inside, the normal at an edge is that of one face instead of none.
  const Vector3d inside = *surface - 1e-9 * ray.direction.normalized();
  Contact contact;
  contact.n_O = OutwardNormal(shape, inside);
  contact.p_OC = *surface + tip_radius * contact.n_O;
  return contact;
}

double MeanSectionRadius(const Shape& shape, const Vector3d& normal) {
  return MeanOverSection(normal, [&](const Vector3d& d) {
    const auto hit = RayExit(shape, Vector3d::Zero(), d);
    return hit ? hit->norm() : 0.0;
  });
}

Symmetry SymmetryOf(const Shape& shape, double tolerance) {
  Symmetry symmetry;
  symmetry.any_rotation = shape.kind == Shape::Kind::kSphere;
  symmetry.about_z = shape.kind != Shape::Kind::kBox;
  // The 24 rotations of the cube that map the extents onto themselves within `tolerance` (m). For
  // a cylinder those about z are part of the continuum, and a turn about x or y tips it over.
  const std::vector<Vector3d> axes = {Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ()};
  for (int x = 0; x < 6; ++x) {
    for (int y = 0; y < 6; ++y) {
      if (x / 2 == y / 2) continue;
      Eigen::Matrix3d R;
      R.col(0) = (x % 2 == 0 ? 1.0 : -1.0) * axes[x / 2];
      R.col(1) = (y % 2 == 0 ? 1.0 : -1.0) * axes[y / 2];
      R.col(2) = R.col(0).cross(R.col(1));
      const Vector3d turned = (R * shape.size).cwiseAbs();
      if ((turned - shape.size).cwiseAbs().maxCoeff() > tolerance) continue;
      if (shape.kind == Shape::Kind::kCylinder && std::abs(R(2, 2)) < 0.5) continue;
      symmetry.rotations.emplace_back(R);
    }
  }
  // x = +X, y = +Y comes first: the identity.
  return symmetry;
}

std::vector<double> FreeYaws(const Shape& shape, int steps) {
  constexpr double kPi = std::numbers::pi;
  std::vector<double> yaws = {0};
  int count = steps;
  if (shape.kind == Shape::Kind::kBox) {
    count = std::abs(shape.size.x() - shape.size.y()) < 1e-3 ? 4 : 2;
  }
  // 0, +1, -1, +2, -2, ... steps: nearest to the demonstrated first.
  for (int i = 1; i <= count / 2; ++i) {
    yaws.push_back(2 * kPi * i / count);
    if (2 * i != count) yaws.push_back(-2 * kPi * i / count);
  }
  return yaws;
}

}  // namespace springgrasp
