// One run of the fingertip springs along a reach. Learning and generating share it, so that what
// was fitted is what is generated.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/fingers.h"
#include "base/pose.h"
#include "grasp/gains.h"
#include "grasp/spring_system.h"
#include "motion/central_force.h"

namespace springgrasp {

using Fingertips = PerFinger<Eigen::Vector3d>;

struct FingerRun {
  int dim = 3;                   // 2: springs in the xy-plane of P, 3
  Pose X_HP = Pose::Identity();  // hand plane (dim 2)
  PerFinger<bool> involved = {};
  PerFinger<double> share = {1, 1, 1, 1, 1};  // of c(i); below 1 only between two grasps
  Fingertips p_HC, n_H;                       // contacts (tip centres) and outward normals in H
  // Eq. (6): p_HC is the object's centre, and involved fingers are drawn to
  // this distance from it, m. 0: to p_HC itself (Eq. (3)).
  double mean_radius = 0;
  Fingertips p_HF, v_HF;  // state at t = 0, m and m/s
  std::vector<std::pair<int, int>> edges;
  std::vector<double> rest_lengths;  // per edge, m
  SpringGains gains;
  double ambient_damping = 0;  // N s/m
  // Preshape of the involved fingers from their contacts in H, m; all zero: along n_H.
  Fingertips opening = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(),
                        Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  // Of the ways out and of those back to the contacts, in H, 1/m (spring_system.h).
  Fingertips opening_bend = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(),
                             Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(),
                             Eigen::Vector3d::Zero()};
  Fingertips bend = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(),
                     Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  PerFinger<double> lag = {};      // s, by which a finger closes later than t_switch
  std::string ratio = "balanced";  // paper | reciprocal | balanced
  double max_ratio = 16;
  bool hold =
      true;      // profile human: closes with a rising force that then holds; paper: Eq. (7) alone
  double T = 1;  // s
  double t_switch = 0.5;  // s
};

// The springs as a system of the listed fingers, in the plane or in space.
SpringSystem MakeSystem(const FingerRun& run, const std::vector<int>& fingers);
// Points or (`direction`) vectors in H as columns of that system, and a column back.
Eigen::MatrixXd SystemPoints(const FingerRun& run, const std::vector<int>& fingers,
                             const Fingertips& p_H, bool direction = false);

// Eq. (7) on the listed fingers with the run's gains, from |a| of H's origin (m/s^2) at even steps.
// The sign is blended around the switch, since |a| is not zero there on curved reaches: over 0.05
// T, with `hold` over 0.2 T.
CentralForce MakeRunForce(const FingerRun& run, const std::vector<int>& fingers,
                          const std::vector<double>& acceleration, double dt);

// Holding force that keeps every involved tip within about 1 mm of its contact against the pull of
// the virtual springs, at least gains.holding, N.
double HoldingForce(const FingerRun& run);

struct FingerMotion {
  std::vector<Fingertips> p_HF;  // at even steps, the first is the start, m
  std::vector<double> f_cen;     // N
};

// Largest distance of an involved tip from its contact (Eq. (6): its sphere) from T on, m.
double ContactError(const FingerRun& run, const FingerMotion& motion, double dt);

// Fingertips in H at even steps of `dt`. With `hold`, the central force after the switch never
// falls below a ramp that rises to the holding force at T; that force is raised where the tips
// would not have landed at T (spring-model note, section 5: slower hands miss the contact), by half
// again up to `tries` times. Nothing if the springs run away.
std::optional<FingerMotion> SimulateFingers(const FingerRun& run,
                                            const std::vector<double>& acceleration, double dt,
                                            int tries = 16);

}  // namespace springgrasp
