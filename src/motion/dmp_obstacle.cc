#include "motion/dmp_obstacle.h"

#include <algorithm>
#include <cmath>

namespace springgrasp {
namespace {

using Eigen::VectorXd;

// A unit vector across `n`.
VectorXd Across(const VectorXd& n) {
  Eigen::Index smallest = 0;
  n.cwiseAbs().minCoeff(&smallest);
  VectorXd out = VectorXd::Unit(n.size(), smallest);
  out -= out.dot(n) * n;
  return out.normalized();
}

}  // namespace

double ObstacleDistance(const SphereObstacle& obstacle, const VectorXd& x) {
  return (x.head(obstacle.centre.size()) - obstacle.centre).norm() - obstacle.radius -
         obstacle.clearance;
}

void AvoidObstacle(const SphereObstacle& obstacle, const VectorXd& x, const VectorXd& v,
                   VectorXd& a) {
  const Eigen::Index dim = obstacle.centre.size();
  const VectorXd d = x.head(dim) - obstacle.centre;
  const double distance = std::max(d.norm(), 1e-9);
  const VectorXd n = d / distance;
  const double h = distance - obstacle.radius - obstacle.clearance;
  const VectorXd place_v = v.head(dim);
  const double speed = place_v.norm();
  const double v_n = n.dot(place_v);
  const VectorXd v_t = place_v - v_n * n;
  if (v_n < 0 && speed > 1e-9 && dim > 1) {
    const double phi = std::atan2(v_t.norm(), -v_n);
    // Head on, any side will do.
    const VectorXd aside = v_t.norm() > 1e-6 * speed ? VectorXd(v_t.normalized()) : Across(n);
    VectorXd t = aside - aside.dot(place_v) / (speed * speed) * place_v;
    t.normalize();
    const double head_on = std::max(phi, 0.05);
    a.head(dim) += obstacle.steering * speed * head_on * std::exp(-3 * phi) *
                   std::exp(-std::max(h, 0.0) / obstacle.range) * t;
  }
  const double w = obstacle.rate;
  const double least = -2 * w * v_n - w * w * h - v_t.squaredNorm() / distance;
  const double now = n.dot(a.head(dim));
  if (now < least) a.head(dim) += (least - now) * n;
}

}  // namespace springgrasp
