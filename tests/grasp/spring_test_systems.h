// Seeded random spring systems for tests: sizes and stiffnesses of a human hand.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <string>

#include "base/random.h"
#include "grasp/spring_system.h"
#include "motion/central_force.h"
#include "motion/dmp.h"

namespace springgrasp {

inline Eigen::MatrixXd RandomPoints(RandomEngine& engine, int dim, int N, double size) {
  Eigen::MatrixXd out(dim, N);
  for (double& x : out.reshaped()) x = Uniform(engine, -size, size);
  return out;
}

// Five fingers, everything random, everybody but perhaps one finger involved.
inline SpringSystem RandomSystem(RandomEngine& engine, int dim, const std::string& topology) {
  SpringSystem system = MakeSpringSystem(5, dim, 0.02);
  for (double& m : system.mass) m = Uniform(engine, 0.01, 0.04);
  for (const auto& [i, j] : SpringTopology(topology)) {
    system.springs.push_back({i, j, Uniform(engine, 0.05, 1.0), Uniform(engine, 0.02, 0.08),
                              Uniform(engine, 0.02, 0.2)});
  }
  system.anchors = RandomPoints(engine, dim, 5, 0.04);
  system.involved.assign(5, true);
  system.involved[3] = Uniform01(engine) < 0.5;
  system.kc = Uniform(engine, 0.5, 2);
  system.dc = Uniform(engine, 0.3, 0.8);
  system.normals = RandomPoints(engine, dim, 5, 1);
  system.normals.colwise().normalize();
  return system;
}

// A power or pinch grasp as in the design of the model: contacts on a 30 mm object, the hand
// relaxed, k about 0.3 kc.
inline SpringSystem GraspSystem(bool power, int dim = 2) {
  SpringSystem system = MakeSpringSystem(5, dim, 0.02);
  const double x[5] = {-0.055, 0.05, 0.055, 0.05, 0.04};
  const double y[5] = {0.01, 0.035, 0.01, -0.015, -0.038};
  const double scale[5] = {0.5, 0.48, 0.45, 0.5, 0.55};
  Eigen::MatrixXd rest(dim, 5);
  for (int i = 0; i < 5; ++i) {
    rest(0, i) = x[i];
    rest(1, i) = y[i];
    if (dim == 3) rest(2, i) = 0.012 * (i % 3) - 0.01;
    system.anchors.col(i) = scale[i] * rest.col(i);
    system.involved[static_cast<std::size_t>(i)] = power || i < 2;
  }
  const auto edges = SpringTopology(dim == 2 ? "fan7" : "brace9");
  const double stiffness[9] = {0.45, 0.35, 0.3, 0.4, 0.5, 0.25, 0.38, 0.33, 0.42};
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto [i, j] = edges[e];
    const double distance = (rest.col(i) - rest.col(j)).norm();
    system.springs.push_back({i, j, stiffness[e], 0.9 * distance, 0.144});
  }
  system.kc = 1.28;
  system.dc = 0.48;
  return system;
}

// Start of GraspSystem: the rest positions of the fingers.
inline Eigen::MatrixXd GraspStart(int dim = 2) {
  const SpringSystem system = GraspSystem(true, dim);
  const double scale[5] = {0.5, 0.48, 0.45, 0.5, 0.55};
  Eigen::MatrixXd p(dim, 5);
  for (int i = 0; i < 5; ++i) p.col(i) = system.anchors.col(i) / scale[i];
  return p;
}

// Central force of a straight minimum-jerk reach of 0.3 m in 1 s, sampled every `dt`.
inline CentralForce ReachForce(double gamma, double dt) {
  CentralForce force;
  force.t = EvenTimes(1.0, dt);
  force.a.resize(force.t.size());
  for (Eigen::Index i = 0; i < force.t.size(); ++i) {
    const double s = force.t[i];
    force.a[i] = std::abs(0.3 * (60 * s - 180 * s * s + 120 * s * s * s));
  }
  force.gamma = gamma;
  return force;
}

}  // namespace springgrasp
