// Contacts as plain values, and who is who among the geoms.
#pragma once

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <string>
#include <vector>

#include "base/fingers.h"

namespace springgrasp {

struct ContactPoint {
  int geom1 = -1, geom2 = -1;
  int body1 = -1, body2 = -1;
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();  // midway between the surfaces, m
  // Columns: normal from geom1 to geom2, two tangents.
  Eigen::Matrix3d R_WC = Eigen::Matrix3d::Identity();
  double distance = 0;                                 // m, negative: penetration
  double normal_force = 0;                             // N, never negative
  Eigen::Vector3d f_W = Eigen::Vector3d::Zero();       // whole force of body 1 on body 2, N
  Eigen::Vector3d torque_W = Eigen::Vector3d::Zero();  // friction torque of 1 on 2 about p_W, Nm
  double friction = 0;                                 // sliding coefficient in force here
};

// Fills `contacts` (its capacity is reused) from the last constraint solution in `data`.
void ReadContacts(const mjModel& model, const mjData& data, std::vector<ContactPoint>& contacts);

enum class GeomPart { kOther, kFloor, kTable, kRing, kObject, kArm, kPalm, kFinger };
struct GeomRole {
  GeomPart part = GeomPart::kOther;
  int finger = -1;   // kFinger: 0..4
  int phalanx = -1;  // kFinger: 0 proximal (moved by j0), 1 distal (j1)
  bool hand() const { return part == GeomPart::kPalm || part == GeomPart::kFinger; }
};

// Role of every geom, by the names of its body and joints (see README, "Names").
std::vector<GeomRole> ClassifyGeoms(const mjModel& model);

// What the hand does to one body, summed over contacts.
struct HandLoad {
  PerFinger<double> normal{};           // N, sum of normal forces, all phalanges
  PerFinger<double> proximal_normal{};  // N, of that by the proximal phalanx
  PerFinger<Eigen::Vector3d> f_W;       // N, force on the body
  double palm_normal = 0;
  Eigen::Vector3d palm_f_W = Eigen::Vector3d::Zero();
  double total_normal = 0;  // N, fingers and palm
  HandLoad() { f_W.fill(Eigen::Vector3d::Zero()); }
};
HandLoad LoadOnBody(const std::vector<ContactPoint>& contacts, const std::vector<GeomRole>& roles,
                    int body);

}  // namespace springgrasp
