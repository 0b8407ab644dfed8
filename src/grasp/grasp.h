// GRASP: one entry of the library. What a demonstration taught: the reach as a DMP, the fingers as
// a system of virtual springs, the contacts as rays on the object.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/fingers.h"
#include "base/pose.h"
#include "base/shape.h"
#include "grasp/gains.h"
#include "grasp/object_contacts.h"
#include "motion/dmp.h"

namespace springgrasp {

// A virtual spring between two fingers (Eq. (1)).
struct GraspEdge {
  int i = 0, j = 1;           // fingers
  double k = 0;               // N/m, at the demonstrated duration
  double rest_length = 0;     // m
  double damping = 0;         // N s/m
  double standard_error = 0;  // of k, N/m; 0 if k was not estimated
};

// How well the grasp reproduces what it was learned from.
struct GraspQuality {
  PerFinger<double> rmse = {};  // reproduced against smoothed tips in H, m; 0 if not observed
  PerFinger<int> samples = {};  // observed samples that the error is taken over
  double begin = 0;             // time of the recording at which the reach begins, s
  double reach_rmse = 0;        // DMP against observed hand, m
  // Widest aperture between thumb and the other involved tips (m) and its time (of T), observed and
  // reproduced.
  double aperture = 0, aperture_time = 0;
  double aperture_reproduced = 0, aperture_time_reproduced = 0;
  double aperture_rmse = 0;     // over the reach, m
  double condition_number = 0;  // of the scaled regression (Eq. (8))
  double planarity = 0;         // RMS distance of the involved tips from the hand plane, m
  double noise = 0;             // estimated deviation of one fingertip coordinate, m
};

struct Grasp {
  std::string name;
  std::string type = "pinch";  // pinch | tripod | power | lateral
  std::string source;          // the demonstration it was learned from
  // human | paper | unforced: delay and closing gain free, or 0 and 1, or f_cen
  // = 0
  std::string profile = "human";
  double hand_length = 0.189;                 // m, of the demonstrating hand
  PerFinger<bool> involved = {};              // the paper's c(i)
  PerFinger<double> share = {1, 1, 1, 1, 1};  // of c(i); below 1 only between two grasps (blend.h)

  bool object_given = false;         // else inferred from the grasp
  Shape shape;                       // the demonstrated object
  double tip_radius = 0.008;         // m, of the demonstrating fingers
  PerFinger<ContactRay> rays;        // of the involved fingers
  PerFinger<double> clearance = {};  // m, of a finger's contact from the surface; see share
  Pose X_OH = Pose::Identity();      // hand in O at contact
  Pose X_HG = Pose::Identity();      // grasp frame in H at contact

  int dim = 3;                   // 2: the paper's, in the plane below; 3
  Pose X_HP = Pose::Identity();  // hand plane P (dim 2): origin the contact centroid, z normal
  double mass = 0.02;            // of every fingertip, kg
  double kc = 1, dc = 0.3;       // contact stiffness N/m and damping N s/m (Eq. (3))
  std::vector<GraspEdge> edges;
  double ambient_damping = 0;           // d0, N s/m
  double reach_gain = 50;               // gamma A / (m x0)
  double delay = 0;                     // of f_cen, fraction of T
  double closing = 1;                   // beta
  double holding = 0.5;                 // f_cen after T / (kc x0)
  std::string ratio = "balanced";       // paper | reciprocal | balanced: Eq. (4) while f_cen < 0
  double max_ratio = 16;                // Rmax
  std::string switch_rule = "learned";  // learned: peak speed (Eq. (7)); fitted: t_switch below
  double t_switch = 0.5;                // fraction of T

  // At the start, relative to the contacts (uninvolved fingers: in H), m and m/s.
  PerFinger<Eigen::Vector3d> offset;
  PerFinger<Eigen::Vector3d> velocity;
  PerFinger<bool> observed = {};  // false: never seen, posed at rest
  // Preshape: where f_cen < 0 pushes an involved finger, from its contact in H, m; their lengths
  // share the force (ratio balanced). Zero: along the outward normal.
  PerFinger<Eigen::Vector3d> opening = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(),
                                        Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(),
                                        Eigen::Vector3d::Zero()};

  // The bend of the ways out in H, 1/m (spring_system.h). Profile human.
  PerFinger<Eigen::Vector3d> opening_bend = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(),
                                             Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(),
                                             Eigen::Vector3d::Zero()};
  // How the involved fingers come back: the bend of their ways in H, 1/m (spring_system.h), and how
  // much later than t_switch each closes, fraction of T. Profile human.
  PerFinger<Eigen::Vector3d> bend = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(),
                                     Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(),
                                     Eigen::Vector3d::Zero()};
  PerFinger<double> lag = {};

  ReachScales scales;  // T, A, x0 of the demonstration
  PoseDmp reach;       // of G in O
  GraspQuality quality;
};

// Dimensionless gains of a grasp and their SI values for a new movement.
DimensionlessGains GainsOf(const Grasp& grasp);
SpringGains GainsFor(const Grasp& grasp, const ReachScales& scales);

// Grasp YAML (README, "Files"). Numbers are written with 17 digits: reading gives the same values.
// Reading throws Error with file and line.
std::string FormatGrasp(const Grasp& grasp);
Grasp ParseGrasp(const std::string& text, const std::string& name);
Grasp ReadGrasp(const std::string& path);
void WriteGrasp(const Grasp& grasp, const std::string& path);

// What `learn` prints: each k with its error, a sentence for each that the data cannot determine,
// and a line per finger `index RMSE 2.1 mm`, involved ones marked with *.
std::string ReportGrasp(const Grasp& grasp);

}  // namespace springgrasp
