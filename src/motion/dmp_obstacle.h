// Obstacle term of a movement primitive: added to Eq. (10) (our extension; the paper has none).
//
// Steering: a movement that heads for the obstacle is turned aside, as people do (Fajen and Warren
// 2003; Hoffmann et al., ICRA 2009):
//   a += steering |v| phi exp(-3 phi) exp(-h / range) t,
// phi the angle between v and the obstacle's centre, t the unit vector across v away from it.
// Barrier: h = |x - centre| - radius - clearance never becomes negative, because
//   h'' + 2 w h' + w^2 h >= 0
// is kept by the least push along the outward normal. It holds exactly if it holds at the start,
// which a start at rest outside the clearance does.
#pragma once

#include <Eigen/Core>

namespace springgrasp {

struct SphereObstacle {
  Eigen::VectorXd centre;   // m; its size says how many first coordinates are a place
  double radius = 0.03;     // m
  double clearance = 0.01;  // m, kept free around it
  double steering = 100;    // 1/s
  double range = 0.05;      // m, over which steering fades
  double rate = 20;         // 1/s, w: how late the barrier brakes
};

// Changes the acceleration `a` (m/s^2) of a state so that the obstacle is avoided.
void AvoidObstacle(const SphereObstacle& obstacle, const Eigen::VectorXd& x,
                   const Eigen::VectorXd& v, Eigen::VectorXd& a);

// Distance from the obstacle's clearance, m; negative inside.
double ObstacleDistance(const SphereObstacle& obstacle, const Eigen::VectorXd& x);

}  // namespace springgrasp
