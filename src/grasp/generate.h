// From a grasp of the library to the fingertip motion for a new object (paper section III-C):
// DMP rollout, central force (Eq. (7)), springs (Eq. (5)), contacts on the new surface.
#pragma once

#include <memory>
#include <optional>

#include "base/pose.h"
#include "base/shape.h"
#include "base/triangle_mesh.h"
#include "grasp/fingertip_motion.h"
#include "grasp/grasp.h"

namespace springgrasp {

struct GenerateOptions {
  Shape shape;  // the new object
  // Its surface where it is a mesh (mesh_contacts.h), `shape` being the box around it; else null.
  std::shared_ptr<const TriangleMesh> mesh;
  Pose X_WO = Pose::Identity();  // its believed pose
  double tip_radius = 0.008;     // m, of the hand that will grasp
  // Eq. (6) alone: no contact points; the involved fingers are drawn to the mean radius of the
  // object's section about its centre, from where the demonstrated hand had them.
  bool object_centre = false;
  // Where the reach starts: G in the world. Absent: as demonstrated relative to the object.
  std::optional<Pose> X_WG_start;
  std::optional<double> duration;  // T, s; absent: as demonstrated
  double dt = 0.005;               // s, step of samples and integrator
  // The shape of a reach from another start. false: the learned path about the object plus an
  // offset that fades (the plain DMP). true: the learned path turned and scaled with the vector
  // from start to goal: the forcing term of Eq. (12) with its position weights turned and scaled
  // alike. For robots whose start lies elsewhere than the demonstrator's.
  bool similar_reach = false;
  // Lateral grasps of boxes: contacts on the two large faces, this far from their edges, m
  // (PlateContacts); 0: along the learned rays.
  double inset = 0;
  // Further rotation of the whole reach about the object's z, rad (what symmetry leaves free).
  double yaw = 0;
};

// Samples from 0 to 1.5 T, of the grasp as EncloseAlongAxis fits it to the shape. Fingers converge
// to the contacts at T and stay. Throws Error for a duration or step that is not positive.
FingertipMotion GenerateMotion(const Grasp& grasp, const GenerateOptions& options);

// Contacts of the involved fingers on a shape: the learned rays, or where one meets no surface a
// point at the mean section radius (Eq. (6)).
PerFinger<Contact> ContactsOn(const Grasp& grasp, const Shape& shape, double tip_radius,
                              const TriangleMesh* mesh = nullptr);

// Midway between the thumb's contact and the mean of the others, in O, m.
Eigen::Vector3d MiddleOfContacts(const PerFinger<Contact>& contacts,
                                 const PerFinger<bool>& involved);

}  // namespace springgrasp
