// Means of the hand-object contacts over a window of time: what the verdict looks at.
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "base/fingers.h"
#include "base/pose.h"
#include "experiment/grasp_quality.h"
#include "sim/contacts.h"

namespace springgrasp {

// One pair of touching geoms, averaged with the normal force as weight.
struct MeanContact {
  GeomRole role;            // of the hand's geom
  double normal = 0;        // N, mean over the whole window
  QualityContact geometry;  // in O
};

struct ContactWindow {
  double duration = 0;                     // s
  PerFinger<double> normal = {};           // N, mean sum of normal forces, all phalanges
  PerFinger<double> proximal_normal = {};  // N, of that by the proximal phalanx
  PerFinger<Eigen::Vector3d> f_H;          // N, mean force on the object, in H
  double palm_normal = 0;                  // N
  Eigen::Vector3d palm_f_H = Eigen::Vector3d::Zero();
  double total_normal = 0;    // N, all hand-object contacts
  double support_normal = 0;  // N, table, ring and floor on the object
  std::vector<MeanContact> contacts;
  Eigen::Matrix3d R_WO = Eigen::Matrix3d::Identity();  // at the window's end
  ContactWindow() { f_H.fill(Eigen::Vector3d::Zero()); }

  double LoadShare(int finger) const {
    return total_normal > 0 ? normal[finger] / total_normal : 0;
  }
};

// Mean contact forces of a hand (R_WH) at rest against the object's true weight (N), as a fraction
// of it.
double WeightError(const ContactWindow& window, const Eigen::Matrix3d& R_WH, double weight);

// Collects contacts of one object over time steps.
class ContactAccumulator {
 public:
  // `roles` as ClassifyGeoms gives them; must outlive this.
  ContactAccumulator(const std::vector<GeomRole>& roles, int object_body);

  void Add(const std::vector<ContactPoint>& contacts, const Pose& X_WO_com, const Pose& X_WH,
           double torsion, double dt);
  ContactWindow Mean() const;
  void Clear();

 private:
  struct Sum {
    GeomRole role;
    double weight = 0;
    Eigen::Vector3d p = Eigen::Vector3d::Zero(), n = Eigen::Vector3d::Zero();
    double friction = 0, torsion = 0;
  };
  const std::vector<GeomRole>& roles_;
  int body_;
  ContactWindow sum_;
  std::map<int, Sum> per_geom_;
};

}  // namespace springgrasp
