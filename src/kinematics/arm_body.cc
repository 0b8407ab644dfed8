#include "kinematics/arm_body.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kinematics/shape_distance.h"

namespace springgrasp {

using Eigen::Vector3d;

double SegmentDistance(const Vector3d& p, const Vector3d& q, const Vector3d& r, const Vector3d& s) {
  // Closest points p + t u and r + w v with t, w in [0, 1] (Ericson, Real-Time Collision Detection,
  // 5.1.9).
  constexpr double kPoint = 1e-12;
  const Vector3d u = q - p, v = s - r, between = p - r;
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), vb = v.dot(between);
  double t = 0, w = 0;
  if (uu < kPoint && vv < kPoint) return between.norm();
  if (uu < kPoint) {
    w = std::clamp(vb / vv, 0.0, 1.0);
  } else {
    const double ub = u.dot(between);
    if (vv < kPoint) {
      t = std::clamp(-ub / uu, 0.0, 1.0);
    } else {
      const double uv = u.dot(v), determinant = uu * vv - uv * uv;
      if (determinant > kPoint * uu * vv) {
        t = std::clamp((uv * vb - ub * vv) / determinant, 0.0, 1.0);
      }
      w = (uv * t + vb) / vv;
      if (w < 0) {
        w = 0;
        t = std::clamp(-ub / uu, 0.0, 1.0);
      } else if (w > 1) {
        w = 1;
        t = std::clamp((uv - ub) / uu, 0.0, 1.0);
      }
    }
  }
  return (between + t * u - w * v).norm();
}

double SelfClearance(const Arm& arm, const ArmBody& body, const Eigen::VectorXd& q, double enough,
                     std::vector<Pose>& X_WB) {
  Eigen::VectorXd full = arm.q;
  for (int i = 0; i < arm.num_joints(); ++i) full[arm.joints[i]] = q[i];
  ForwardKinematics(arm.tree, full, X_WB);
  double least = enough;
  std::size_t pair = 0, block_pair = 0;
  for (const BodyCapsule& link : body.links) {
    const Vector3d a = X_WB[link.node] * link.a, b = X_WB[link.node] * link.b;
    const Vector3d middle = 0.5 * (a + b);
    const double half = 0.5 * (b - a).norm();
    for (const BodyCapsule& other : body.rest) {
      if (body.exempt_rest[pair++]) continue;
      const double radii = link.radius + other.radius;
      const double reach = half + 0.5 * (other.b - other.a).norm();
      if ((middle - 0.5 * (other.a + other.b)).norm() - reach - radii > least) continue;
      least = std::min(least, SegmentDistance(a, b, other.a, other.b) - radii);
    }
    for (const ArmBody::Block& block : body.blocks) {
      if (body.exempt_blocks[block_pair++]) continue;
      const Pose X_OW = block.X_WO.inverse();
      if (SignedDistance(block.shape, X_OW * middle) - half - link.radius > least) continue;
      least = std::min(least, CapsuleDistance(block.shape, X_OW * a, X_OW * b, link.radius));
    }
  }
  return least;
}

double ArmDistance(const Arm& arm, const ArmBody& body, const Eigen::VectorXd& q,
                   const Shape& shape, const Pose& X_WO, std::vector<Pose>& X_WB) {
  Eigen::VectorXd full = arm.q;
  for (int i = 0; i < arm.num_joints(); ++i) full[arm.joints[i]] = q[i];
  ForwardKinematics(arm.tree, full, X_WB);
  const Pose X_OW = X_WO.inverse();
  const int hand = arm.tree.frames[arm.frame].node;
  double least = std::numeric_limits<double>::infinity();
  for (const BodyCapsule& link : body.links) {
    if (link.node == hand) continue;
    const Vector3d a = X_OW * (X_WB[link.node] * link.a), b = X_OW * (X_WB[link.node] * link.b);
    const double about = SignedDistance(shape, 0.5 * (a + b)) - 0.5 * (b - a).norm() - link.radius;
    if (about < least) least = std::min(least, CapsuleDistance(shape, a, b, link.radius));
  }
  return least;
}

}  // namespace springgrasp
