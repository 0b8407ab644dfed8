// Contacts and Eq. (6) on an object that is given as a mesh; as object_contacts.h does for
// primitives. Everything is in O, its origin inside the mesh.
#pragma once

#include <optional>

#include "base/triangle_mesh.h"
#include "grasp/object_contacts.h"

namespace springgrasp {

// The box around a mesh, centred at O's origin. The mesh must be so too (CentredMesh).
Shape BoxAround(const TriangleMesh& mesh);

// The mesh moved so that the middle of its box is O's origin. Throws Error if it has no extent.
TriangleMesh CentredMesh(TriangleMesh mesh);

// Contact of a tip (radius in m) where the ray leaves the mesh for the last time; its height is a
// fraction of the box's. Nothing if the ray meets no triangle.
std::optional<Contact> ContactOfRay(const TriangleMesh& mesh, const ContactRay& ray,
                                    double tip_radius);

// Mean distance between the surface points {p_s} in the section orthogonal to `normal` (the
// silhouette there) and the object's centre, m (Eq. (6)).
double MeanSectionRadius(const TriangleMesh& mesh, const Eigen::Vector3d& normal);

}  // namespace springgrasp
