#include "kinematics/arm_swivel.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace springgrasp {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;
constexpr double kSame = 1e-6;        // m or unit vectors: a point, a right angle
constexpr double kNarrowest = 1e-12;  // rad, of an interval

Matrix3d Cross(const Vector3d& v) {
  Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

// The angle that differs from `middle` by at most half a turn.
double Near(double angle, double middle) {
  return angle - 2 * kPi * std::round((angle - middle) / (2 * kPi));
}

double MiddleOffset(const SphericalJoint& j) {
  return std::atan2(j.axis[0].dot(j.axis[1].cross(j.axis[2])), j.axis[0].dot(j.axis[2]));
}

// With b = q2 - offset: R a3 = cos b a1 + sin b (cos q1 a2 x a1 + sin q1 a2), and for the last
// angle R' a1 = cos b a3 + sin b (cos q3 a3 x a2 + sin q3 a2).
Eigen::Matrix<double, 5, 1> Numbers(const SphericalJoint& j, const Matrix3d& R) {
  const Vector3d u = R * j.axis[2], v = R.transpose() * j.axis[0];
  Eigen::Matrix<double, 5, 1> n;
  n << j.axis[1].cross(j.axis[0]).dot(u), j.axis[1].dot(u), j.axis[0].dot(u),
      j.axis[2].cross(j.axis[1]).dot(v), j.axis[1].dot(v);
  return n;
}

Vector3d AnglesOf(const SphericalJoint& j, const Eigen::Matrix<double, 5, 1>& n, int branch) {
  return {std::atan2(branch * n[1], branch * n[0]),
          j.offset + branch * std::acos(std::clamp(n[2], -1.0, 1.0)),
          std::atan2(branch * n[4], branch * n[3])};
}

// Swivels with a cos + b sin + c = 0.
void AddRoots(double a, double b, double c, std::vector<double>& roots) {
  const double r = std::hypot(a, b);
  if (r < 1e-14 || std::abs(c) > r) return;
  const double middle = std::atan2(b, a), half = std::acos(-c / r);
  roots.push_back(Near(middle + half, 0));
  roots.push_back(Near(middle - half, 0));
}

bool Square(const Vector3d& a, const Vector3d& b) { return std::abs(a.dot(b)) < kSame; }

// The point where two lines meet; absent if they do not.
std::optional<Vector3d> Crossing(const Vector3d& p, const Vector3d& a, const Vector3d& q,
                                 const Vector3d& b) {
  const Vector3d normal = a.cross(b);
  if (normal.norm() < kSame || std::abs(normal.normalized().dot(q - p)) > kSame) {
    return std::nullopt;
  }
  return p + a * (q - p).cross(b).dot(normal) / normal.squaredNorm();
}

std::optional<Vector3d> CentreOf(const SphericalJoint& joint, const Vector3d* points) {
  const auto& a = joint.axis;
  if (!Square(a[0], a[1]) || !Square(a[1], a[2])) return std::nullopt;
  const std::optional<Vector3d> centre = Crossing(points[0], a[0], points[1], a[1]);
  if (!centre || a[2].cross(*centre - points[2]).norm() > kSame) return std::nullopt;
  return centre;
}

}  // namespace

std::optional<ArmGeometry> GeometryOf(const Arm& arm) {
  if (arm.num_joints() != 7) return std::nullopt;
  Eigen::VectorXd zero = arm.q;
  for (const int j : arm.joints) zero[j] = 0;
  std::vector<Pose> X_WB;
  ForwardKinematics(arm.tree, zero, X_WB);
  std::array<Vector3d, 7> axis, point;
  ArmGeometry g;
  for (int i = 0; i < 7; ++i) {
    int node = arm.tree.frames[arm.frame].node;
    while (node >= 0 && arm.tree.nodes[node].joint != arm.joints[i]) {
      node = arm.tree.nodes[node].parent;
    }
    if (node < 0 || arm.tree.nodes[node].slide) return std::nullopt;
    axis[i] = X_WB[node].linear() * arm.tree.nodes[node].axis;
    point[i] = X_WB[node].translation();
    g.lower[i] = arm.tree.lower[arm.joints[i]];
    g.upper[i] = arm.tree.upper[arm.joints[i]];
    if (g.upper[i] - g.lower[i] > 2 * kPi) return std::nullopt;
  }
  g.shoulder.axis = {axis[0], axis[1], axis[2]};
  g.wrist.axis = {axis[4], axis[5], axis[6]};
  const std::optional<Vector3d> shoulder = CentreOf(g.shoulder, point.data());
  const std::optional<Vector3d> wrist = CentreOf(g.wrist, point.data() + 4);
  if (!shoulder || !wrist) return std::nullopt;
  g.shoulder.offset = MiddleOffset(g.shoulder);
  g.wrist.offset = MiddleOffset(g.wrist);
  const Pose X_WH = FramePose(arm.tree, X_WB, arm.frame);
  g.elbow_axis = axis[3];
  g.p_WS = *shoulder;
  g.p_SE = point[3] - *shoulder;
  g.p_EC = *wrist - point[3];
  g.p_HC = X_WH.inverse() * *wrist;
  g.R_WH = X_WH.linear();

  // Ahead is where the wrist is with all joints in mid range.
  const SevenJoints middle = 0.5 * (g.lower + g.upper);
  Matrix3d R = Matrix3d::Identity();
  for (int i = 0; i < 3; ++i) R = R * Eigen::AngleAxisd(middle[i], axis[i]);
  const Vector3d reach = g.p_SE + Eigen::AngleAxisd(middle[3], g.elbow_axis) * g.p_EC;
  g.ahead = (R * reach).normalized();
  Vector3d down = -Vector3d::UnitZ();
  if (down.cross(g.ahead).norm() < 0.1) down = -Vector3d::UnitY();
  g.side = (down - down.dot(g.ahead) * g.ahead).normalized();
  g.bend = g.elbow_axis.cross(reach).dot(g.p_SE) > 0 ? 1 : -1;
  return g;
}

void ArmSolutions::Solve(const ArmGeometry& g, const Pose& X_WH, double margin) {
  geometry_ = &g;
  margin_ = margin;
  for (Family& family : families_) family.valid = false;
  intervals_.clear();
  const Vector3d d = X_WH * g.p_HC - g.p_WS;
  // |p_SE + R4 p_EC| = |d| gives the elbow: a cos + b sin = c.
  const Vector3d& e = g.elbow_axis;
  const double along = g.p_SE.dot(e) * g.p_EC.dot(e);
  const double a = g.p_SE.dot(g.p_EC) - along, b = g.p_SE.dot(e.cross(g.p_EC));
  const double c = 0.5 * (d.squaredNorm() - g.p_SE.squaredNorm() - g.p_EC.squaredNorm()) - along;
  const double r = std::hypot(a, b);
  const double distance = d.norm();
  if (std::abs(c) > r * (1 + 1e-12) || distance < kSame) return;
  const double middle = std::atan2(b, a), half = std::acos(std::clamp(c / r, -1.0, 1.0));
  const Vector3d ahead = d / distance;
  const Matrix3d carry = Eigen::Quaterniond::FromTwoVectors(g.ahead, ahead).toRotationMatrix();
  const Matrix3d R_target = X_WH.linear() * g.R_WH.transpose();
  const Matrix3d axial = ahead * ahead.transpose();
  const Matrix3d turn_cos = Matrix3d::Identity() - axial, turn_sin = Cross(ahead);
  ahead_ = ahead;
  for (const int side : {1, -1}) {
    const double elbow = Near(middle + side * half, 0.5 * (g.lower[3] + g.upper[3]));
    if (elbow < g.lower[3] + margin || elbow > g.upper[3] - margin) continue;
    Family& family = families_[side > 0 ? 0 : 1];
    family.valid = true;
    family.elbow = elbow;
    const Matrix3d R_elbow = Eigen::AngleAxisd(elbow, e).toRotationMatrix();
    const Vector3d reach = (g.p_SE + R_elbow * g.p_EC).normalized();
    const Vector3d out = g.bend * e.cross(reach).normalized();
    Matrix3d from, to;
    from << reach, out, reach.cross(out);
    to << g.ahead, g.side, g.ahead.cross(g.side);
    // R123 = turn(swivel) M.
    const Matrix3d M = carry * to * from.transpose();
    family.M = M;
    family.shoulder << Numbers(g.shoulder, turn_cos * M), Numbers(g.shoulder, turn_sin * M),
        Numbers(g.shoulder, axial * M);
    const Matrix3d left = R_elbow.transpose() * M.transpose();
    family.wrist << Numbers(g.wrist, left * turn_cos * R_target),
        Numbers(g.wrist, left * turn_sin.transpose() * R_target),
        Numbers(g.wrist, left * axial * R_target);
    const Vector3d p_SE = M * g.p_SE;
    family.height << (turn_cos * p_SE).z(), (turn_sin * p_SE).z(), (axial * p_SE).z();
    AddIntervals(side);
    if (half == 0) break;
  }
}

bool ArmSolutions::Inside(const SevenJoints& q) const {
  constexpr double kRounding = 1e-12;  // rad
  return (q.array() >= geometry_->lower.array() + (margin_ - kRounding)).all() &&
         (q.array() <= geometry_->upper.array() - (margin_ - kRounding)).all();
}

void ArmSolutions::AddIntervals(int elbow) {
  const ArmGeometry& g = *geometry_;
  const Family& family = families_[elbow > 0 ? 0 : 1];
  roots_.clear();
  for (const bool wrist : {false, true}) {
    const SphericalJoint& joint = wrist ? g.wrist : g.shoulder;
    const Linear& n = wrist ? family.wrist : family.shoulder;
    for (int i = 0; i < 3; ++i) {
      const int k = (wrist ? 4 : 0) + i;
      for (const double limit : {g.lower[k] + margin_, g.upper[k] - margin_}) {
        Eigen::RowVector3d row;
        if (i == 1) {
          row = n.row(2);
          row[2] -= std::cos(limit - joint.offset);
        } else {
          const int x = i == 0 ? 0 : 3;
          row = std::cos(limit) * n.row(x + 1) - std::sin(limit) * n.row(x);
        }
        AddRoots(row[0], row[1], row[2], roots_);
      }
    }
  }
  std::sort(roots_.begin(), roots_.end());
  if (roots_.empty()) roots_.push_back(-kPi);
  const std::size_t count = roots_.size();
  for (const int shoulder : {1, -1}) {
    for (const int wrist : {1, -1}) {
      const std::size_t first = intervals_.size();
      for (std::size_t i = 0; i < count; ++i) {
        SwivelInterval part{elbow, shoulder, wrist, roots_[i],
                            i + 1 < count ? roots_[i + 1] : roots_[0] + 2 * kPi};
        if (part.to - part.from < kNarrowest) continue;
        if (!Inside(JointsAt(part, 0.5 * (part.from + part.to)))) continue;
        if (intervals_.size() > first && part.from - intervals_.back().to < kNarrowest) {
          intervals_.back().to = part.to;
        } else {
          intervals_.push_back(part);
        }
      }
      // The last one may go on in the first.
      if (intervals_.size() > first + 1 &&
          intervals_.back().to - 2 * kPi - intervals_[first].from > -kNarrowest) {
        intervals_[first].from = intervals_.back().from - 2 * kPi;
        intervals_.pop_back();
      }
    }
  }
}

SevenJoints ArmSolutions::JointsAt(const SwivelInterval& branch, double swivel) const {
  const ArmGeometry& g = *geometry_;
  const Family& family = FamilyOf(branch);
  const Vector3d turn(std::cos(swivel), std::sin(swivel), 1);
  SevenJoints q;
  q << AnglesOf(g.shoulder, family.shoulder * turn, branch.shoulder), family.elbow,
      AnglesOf(g.wrist, family.wrist * turn, branch.wrist);
  for (int i = 0; i < 7; ++i) q[i] = Near(q[i], 0.5 * (g.lower[i] + g.upper[i]));
  return q;
}

std::optional<std::pair<SwivelInterval, double>> ArmSolutions::SwivelOf(
    const SevenJoints& q) const {
  constexpr double kSameElbow = 0.02;  // rad
  const ArmGeometry& g = *geometry_;
  SwivelInterval branch;
  const auto off = [&](int i) {
    return families_[i].valid ? std::abs(families_[i].elbow - q[3]) : 2 * kPi;
  };
  branch.elbow = off(0) <= off(1) ? 1 : -1;
  if (std::min(off(0), off(1)) > kSameElbow) return std::nullopt;
  branch.shoulder = std::sin(q[1] - g.shoulder.offset) >= 0 ? 1 : -1;
  branch.wrist = std::sin(q[5] - g.wrist.offset) >= 0 ? 1 : -1;
  Matrix3d R = Matrix3d::Identity();
  for (int i = 0; i < 3; ++i) R = R * Eigen::AngleAxisd(q[i], g.shoulder.axis[i]);
  const Matrix3d turn = R * FamilyOf(branch).M.transpose();
  const Vector3d twice(turn(2, 1) - turn(1, 2), turn(0, 2) - turn(2, 0), turn(1, 0) - turn(0, 1));
  return std::make_pair(branch, std::atan2(twice.dot(ahead_), turn.trace() - 1));
}

double ArmSolutions::ElbowHeight(const SwivelInterval& branch, double swivel) const {
  const Vector3d& h = FamilyOf(branch).height;
  const double most = std::hypot(h[0], h[1]);
  return most < 1e-3 ? 0 : (h[0] * std::cos(swivel) + h[1] * std::sin(swivel)) / most;
}

}  // namespace springgrasp
