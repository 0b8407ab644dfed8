#include "grasp/mesh_contacts.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "grasp/section_mean.h"

namespace springgrasp {
namespace {

using Eigen::Vector3d;

constexpr double kTiny = 1e-12;

struct Corners {
  Vector3d least, most;
};
Corners CornersOf(const TriangleMesh& mesh) {
  Corners corners{Vector3d::Constant(1e300), Vector3d::Constant(-1e300)};
  for (const Vector3d& v : mesh.vertices) {
    corners.least = corners.least.cwiseMin(v);
    corners.most = corners.most.cwiseMax(v);
  }
  return corners;
}

// A place on the mesh, by its length along a ray.
struct Hit {
  double length = -1;  // m
  Vector3d normal = Vector3d::Zero();
};

// Last triangle along the ray p + s d, s >= 0 (Moeller and Trumbore; edges belong to both sides).
std::optional<Hit> LastHit(const TriangleMesh& mesh, const Vector3d& p, const Vector3d& d) {
  constexpr double kEdge = 1e-9;  // of a triangle's side
  Hit last;
  for (const auto& face : mesh.faces) {
    const Vector3d& a = mesh.vertices[static_cast<std::size_t>(face[0])];
    const Vector3d ab = mesh.vertices[static_cast<std::size_t>(face[1])] - a;
    const Vector3d ac = mesh.vertices[static_cast<std::size_t>(face[2])] - a;
    const Vector3d q = d.cross(ac);
    const double determinant = ab.dot(q);
    if (std::abs(determinant) < kTiny * ab.norm() * ac.norm()) continue;
    const Vector3d from = p - a;
    const double u = from.dot(q) / determinant;
    const Vector3d r = from.cross(ab);
    const double v = d.dot(r) / determinant;
    if (u < -kEdge || v < -kEdge || u + v > 1 + kEdge) continue;
    const double length = ac.dot(r) / determinant;
    if (length < 0 || length <= last.length) continue;
    // Outward is where the ray goes when it leaves.
    const Vector3d normal = ab.cross(ac).normalized();
    last = {length, normal.dot(d) < 0 ? Vector3d(-normal) : normal};
  }
  if (last.length < 0) return std::nullopt;
  return last;
}

}  // namespace

Shape BoxAround(const TriangleMesh& mesh) {
  const Corners corners = CornersOf(mesh);
  return {Shape::Kind::kBox, corners.most - corners.least};
}

TriangleMesh CentredMesh(TriangleMesh mesh) {
  ThrowUnless(!mesh.vertices.empty() && !mesh.faces.empty(), "mesh: it has no triangles");
  const Corners corners = CornersOf(mesh);
  ThrowUnless((corners.most - corners.least).minCoeff() > 0,
              "mesh: it is flat, {} x {} x {} m; expected a body",
              corners.most.x() - corners.least.x(), corners.most.y() - corners.least.y(),
              corners.most.z() - corners.least.z());
  const Vector3d middle = 0.5 * (corners.least + corners.most);
  for (Vector3d& v : mesh.vertices) v -= middle;
  return mesh;
}

std::optional<Contact> ContactOfRay(const TriangleMesh& mesh, const ContactRay& ray,
                                    double tip_radius) {
  if (ray.direction.norm() < kTiny) return std::nullopt;
  const Vector3d origin(0, 0, ray.height * BoxAround(mesh).size.z());
  const Vector3d d = ray.direction.normalized();
  const auto hit = LastHit(mesh, origin, d);
  if (!hit) return std::nullopt;
  Contact contact;
  contact.n_O = hit->normal;
  contact.p_OC = origin + hit->length * d + tip_radius * hit->normal;
  return contact;
}

double MeanSectionRadius(const TriangleMesh& mesh, const Vector3d& normal) {
  return MeanOverSection(normal, [&](const Vector3d& d) {
    const auto hit = LastHit(mesh, Vector3d::Zero(), d);
    return hit ? hit->length : 0.0;
  });
}

}  // namespace springgrasp
