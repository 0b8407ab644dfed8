// Force-closure quality of a set of contacts [Ferrari, Canny 1992].
#pragma once

#include <Eigen/Core>
#include <vector>

namespace springgrasp {

// A soft-finger contact: normal force with Coulomb friction and torsion about the normal.
struct QualityContact {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();   // m, relative to the object's centre of mass
  Eigen::Vector3d n = Eigen::Vector3d::UnitX();  // unit, into the object
  double friction = 0.9;                         // sliding coefficient
  double torsion = 0.005;                        // m, torsional friction over normal force
};

struct GraspQuality6d {
  double epsilon = 0;  // radius of the largest ball about 0 in the wrench hull; <= 0: no closure
  double volume = 0;   // of the hull, N^6 (torques divided by the object's radius)
  // How far the hull reaches against the worst of the tasks, N per N of each contact's normal
  // force [Li, Sastry 1988]; <= 0: one of them is not withstood at all.
  double task = 0;
};

// Hull of the unit wrenches of all contacts: friction cones with 8 edges, two torsional wrenches
// each, torques divided by `object_radius` (m). `tasks`: unit wrenches (force, torque over radius)
// that act on the object at its centre of mass. Fewer than two contacts: all 0.
GraspQuality6d EvaluateGraspQuality(const std::vector<QualityContact>& contacts,
                                    double object_radius,
                                    const std::vector<Eigen::Matrix<double, 6, 1>>& tasks = {});

}  // namespace springgrasp
