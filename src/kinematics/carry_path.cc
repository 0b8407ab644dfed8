#include "kinematics/carry_path.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "kinematics/swivel_path.h"
#include "motion/minimum_jerk.h"

namespace springgrasp {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kBigStep = 0.15;     // rad between samples: a jump
constexpr double kOutside = 1e4;      // per rad^2 beyond a range: leads the search back
constexpr double kBendWeight = 4;     // of the joints' second differences along the line
constexpr double kFirstStep = 0.15;   // rad, of the search for slope and bend ...
constexpr int kHalvings = 7;          // ... and how often it is halved
constexpr double kShakeWeight = 200;  // of its joints' squared steps against the lift's cost
constexpr double kTwoPi = 2 * std::numbers::pi;

Pose Moved(const Pose& X_WH, const Eigen::Vector3d& by_W) {
  Pose moved = X_WH;
  moved.translation() += by_W;
  return moved;
}

std::vector<Pose> LiftPoses(const CarryRequest& request) {
  const int steps = static_cast<int>(std::lround(request.lift_duration / request.dt));
  std::vector<Pose> poses;
  for (int k = 0; k <= steps; ++k) {
    const double z = request.lift * MinimumJerkPosition(static_cast<double>(k) / steps);
    poses.push_back(Moved(request.X_WH, Eigen::Vector3d(0, 0, z)));
  }
  return poses;
}

// Displacements over `request.shake`, from and to rest.
std::vector<double> ShakeCourse(const CarryRequest& request) {
  std::vector<double> course;
  const int steps = static_cast<int>(std::lround(request.shake_duration / request.dt));
  for (int k = 0; k <= steps; ++k) {
    const double t = request.dt * k;
    // Fades in and out within a quarter period, so that it starts and ends at rest.
    const double fade = 4 * request.shake_frequency;
    const double envelope =
        MinimumJerkPosition(fade * t) * MinimumJerkPosition(fade * (request.shake_duration - t));
    course.push_back(envelope * std::sin(kTwoPi * request.shake_frequency * t));
  }
  return course;
}

CarryPath CarryNumerically(const Arm& arm, const CarryRequest& request) {
  CarryPath carry;
  const std::vector<Pose> X_lift = LiftPoses(request);
  const ArmPath lift = TrackArmPath(arm, X_lift, request.q, kBigStep);
  if (!lift.complete) {
    carry.reason = "lifting: " + lift.reason;
    return carry;
  }
  carry.lift = lift.q;
  for (int axis = 0; axis < 3; ++axis) {
    // Every pose from the same posture, so that the arm comes back to it.
    ArmIkOptions ik;
    ik.limit_weight = 0;
    for (const double s : ShakeCourse(request)) {
      const auto q =
          SolveArmIk(arm, Moved(X_lift.back(), s * request.shake * Eigen::Vector3d::Unit(axis)),
                     lift.q.back(), ik);
      if (!q) {
        carry.reason = "the lifted arm cannot be shaken as far as asked";
        return carry;
      }
      carry.shake[axis].push_back(*q);
    }
  }
  carry.complete = true;
  return carry;
}

}  // namespace

ShakePostures::ShakePostures(const ArmGeometry& geometry, const Pose& X_WH,
                             const Eigen::Vector3d& by_W, double max_slope, double margin)
    : geometry_(geometry), X_WH_(X_WH), by_W_(by_W), max_slope_(max_slope), margin_(margin) {
  for (int i = 0; i < kPoints; ++i) {
    solutions_[i].Solve(geometry, Moved(X_WH, (2.0 * i / (kPoints - 1) - 1) * by_W), margin);
  }
}

double ShakePostures::CostOf(double slope, double bend) const {
  std::array<SevenJoints, kPoints> q;
  double cost = 0;
  for (int i = 0; i < kPoints; ++i) {
    if (!solutions_[i].Has(branch_)) return kInfinity;
    const double s = 2.0 * i / (kPoints - 1) - 1;
    q[i] = solutions_[i].JointsAt(branch_, swivel_ + s * (slope + s * bend));
    const auto low = (geometry_.lower.array() + margin_ - q[i].array()).max(0.0);
    const auto high = (q[i].array() - geometry_.upper.array() + margin_).max(0.0);
    cost += kOutside * (low.square() + high.square()).sum();
    if (i > 0) cost += (q[i] - q[i - 1]).squaredNorm();
    if (i > 1) cost += kBendWeight * (q[i] - 2 * q[i - 1] + q[i - 2]).squaredNorm();
  }
  return cost;
}

double ShakePostures::Fit(const SwivelInterval& branch, double swivel) {
  branch_ = branch;
  swivel_ = swivel;
  slope_ = bend_ = 0;
  double best = CostOf(0, 0);
  if (best == kInfinity) return best;
  double step = kFirstStep;
  for (int halving = 0; halving < kHalvings; ++halving, step *= 0.5) {
    for (const Eigen::Vector2d& d : {Eigen::Vector2d(1, 0), Eigen::Vector2d(-1, 0),
                                     Eigen::Vector2d(0, 1), Eigen::Vector2d(0, -1)}) {
      const double cost = CostOf(slope_ + step * d.x(), bend_ + step * d.y());
      if (cost >= best) continue;
      best = cost;
      slope_ += step * d.x();
      bend_ += step * d.y();
    }
  }
  SevenJoints before;
  for (int i = 0; i < kPoints; ++i) {
    constexpr double kRounding = 1e-9;  // rad
    const double ds = 2.0 / (kPoints - 1), s = i * ds - 1;
    const SevenJoints q = solutions_[i].JointsAt(branch_, swivel_ + s * (slope_ + s * bend_));
    if ((q - geometry_.lower).minCoeff() < margin_ - kRounding ||
        (geometry_.upper - q).minCoeff() < margin_ - kRounding) {
      return kInfinity;
    }
    if (i > 0 && (q - before).cwiseAbs().maxCoeff() > max_slope_ * ds) return kInfinity;
    before = q;
  }
  return best;
}

SevenJoints ShakePostures::At(double s) const {
  ArmSolutions solutions;
  solutions.Solve(geometry_, Moved(X_WH_, s * by_W_), margin_);
  return solutions.JointsAt(branch_, swivel_ + s * (slope_ + s * bend_));
}

CarryPath PlanCarry(const Arm& arm, const CarryRequest& request) {
  const std::optional<ArmGeometry> geometry = GeometryOf(arm);
  if (!geometry) return CarryNumerically(arm, request);
  CarryPath carry;
  SwivelPathRequest lift;
  lift.X_WH = LiftPoses(request);
  lift.dt = request.dt;
  lift.start = request.q;
  lift.max_speed = request.max_speed;
  lift.margin = request.margin;
  const int last = static_cast<int>(lift.X_WH.size()) - 1;
  // Fastest in the middle of the shake.
  const double max_slope = request.max_speed / (kTwoPi * request.shake_frequency);
  std::vector<ShakePostures> shakes;
  for (int axis = 0; axis < 3; ++axis) {
    shakes.emplace_back(*geometry, lift.X_WH.back(), request.shake * Eigen::Vector3d::Unit(axis),
                        max_slope, request.margin);
  }
  ArmSolutions lifted;
  lifted.Solve(*geometry, lift.X_WH.back(), request.margin);
  const auto shake_cost = [&](const SevenJoints& q) {
    const auto found = lifted.SwivelOf(q);
    if (!found) return kInfinity;
    double cost = 0;
    for (ShakePostures& shake : shakes) cost += shake.Fit(found->first, found->second);
    return kShakeWeight * cost;
  };
  lift.obstacles = [&](const SevenJoints& q, int sample) {
    double cost = request.obstacles ? request.obstacles(q) : 0;
    if (sample == last && cost < kInfinity) cost += shake_cost(q);
    return cost;
  };
  const ArmPath lifting = PlanSwivelPath(*geometry, lift);
  if (!lifting.complete) {
    carry.reason = "lifting, to be shaken: " + lifting.reason;
    return carry;
  }
  if (shake_cost(lifting.q.back()) == kInfinity) {
    carry.reason = "the lifted arm cannot be shaken as far as asked";
    return carry;
  }
  carry.lift = lifting.q;
  const std::vector<double> course = ShakeCourse(request);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double s : course) carry.shake[axis].push_back(shakes[axis].At(s));
  }
  carry.complete = true;
  return carry;
}

}  // namespace springgrasp
