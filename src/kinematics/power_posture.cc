#include "kinematics/power_posture.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include "kinematics/shape_distance.h"

namespace springgrasp {
namespace {

constexpr double kTouch = 0.0002;      // m
constexpr double kCoarse = 0.06;       // rad, step of closing
constexpr int kBends = 14;             // tried angles of the distal joint ...
constexpr double kMaxBend = 1.3;       // ... up to this, rad: a full hook would cross the thumb
constexpr double kMaxThumbBend = 0.6;  // rad: the thumb presses rather than hooks
constexpr double kPassing = 0.02;      // m, a phalanx farther than this takes no part
constexpr double kNear = 0.0025;       // m, touches once the hand presses
constexpr double kPalmNear = 0.005;    // m, the palm carries once the fingers pull
constexpr double kHandWidth = 0.09;    // m, an object longer than this lies under all fingers
constexpr double kThumbRoom = 0.004;   // m
constexpr double kLastPhalanx = 2;     // cost of one that is kPassing off
constexpr int kPalm = -1;              // instead of a finger
constexpr int kSamples = 6;            // along a phalanx

// Of the palm and the open fingers, which an object seats against; the thumb stands aside.
double SeatDistance(const RobotHand& hand, const std::vector<Pose>& X_HB, const Pose& X_OH,
                    const Shape& shape) {
  return HandDistance(hand, X_HB, X_OH, shape, {false, true, true, true, true}, true);
}

// Object orientations in A that suit parallel fingers: the demonstrated one, with the axis nearest
// to the common finger axis turned onto it (cylinders: O's z; boxes: any).
Eigen::Matrix3d Aligned(const Shape& shape, const Eigen::Matrix3d& R_AO) {
  if (shape.kind == Shape::Kind::kSphere) return R_AO;
  int axis = 2;
  if (shape.kind == Shape::Kind::kBox) R_AO.row(1).cwiseAbs().maxCoeff(&axis);
  const double along = R_AO(1, axis);
  if (std::abs(along) < std::cos(0.8)) return R_AO;
  const Eigen::Vector3d wanted(0, along > 0 ? 1 : -1, 0);
  return Eigen::Quaterniond::FromTwoVectors(R_AO.col(axis), wanted).toRotationMatrix() * R_AO;
}

// Inward normals of what touches, in A's x-z plane: their largest angular gap tells how well the
// object is enclosed (below pi: held in the plane).
double LargestGap(std::vector<double>& angles) {
  if (angles.size() < 2) return 2 * std::numbers::pi;
  std::sort(angles.begin(), angles.end());
  double gap = angles.front() + 2 * std::numbers::pi - angles.back();
  for (std::size_t i = 1; i < angles.size(); ++i) gap = std::max(gap, angles[i] - angles[i - 1]);
  return gap;
}

struct Candidate {
  Pose X_HO = Pose::Identity();
  Eigen::VectorXd q;
  double cost = std::numeric_limits<double>::infinity();
};

}  // namespace

FingerTouch TouchOf(const RobotHand& hand, int finger, const Pose& X_OH, const Shape& shape,
                    const std::vector<Pose>& X_HB) {
  FingerTouch touch;
  touch.proximal = touch.distal = std::numeric_limits<double>::infinity();
  for (const LinkCapsule& c : hand.capsules) {
    if (c.finger != finger) continue;
    const Pose X_OB = X_OH * X_HB[c.node];
    const Eigen::Vector3d p_OA = X_OB * c.a, p_OB = X_OB * c.b;
    double& gap = c.distal ? touch.distal : touch.proximal;
    for (int i = 0; i <= kSamples; ++i) {
      Eigen::Vector3d n;
      const double s = static_cast<double>(i) / kSamples;
      const double d = SignedDistance(shape, p_OA + s * (p_OB - p_OA), &n) - c.radius;
      if (d >= gap) continue;
      gap = d;
      (c.distal ? touch.n_distal : touch.n_proximal) = n;
    }
  }
  return touch;
}

Eigen::Vector3d PressNormal(const FingerTouch& touch, double near) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  if (touch.proximal < near) sum += touch.n_proximal;
  if (touch.distal < near) sum += touch.n_distal;
  return sum;
}

namespace {

// The angle in (from, to] to which `set` can bring the finger before `gap` falls below kTouch; `to`
// if it never does.
double CloseUntil(double from, double to, const std::function<void(double)>& set,
                  const std::function<double()>& gap) {
  double open = from, closed = from;
  bool touched = false;
  while (!touched && open < to) {
    closed = std::min(to, open + kCoarse);
    set(closed);
    touched = gap() < kTouch;
    if (!touched) open = closed;
  }
  for (int i = 0; touched && i < 12; ++i) {
    const double middle = 0.5 * (open + closed);
    set(middle);
    (gap() < kTouch ? closed : open) = middle;
  }
  set(open);
  return open;
}

}  // namespace

bool OnOneValve(const RobotHand& hand, int finger) {
  const RobotHand::Finger& f = hand.fingers[finger];
  return hand.valve_of[f.j0] == hand.valve_of[f.j1];
}

FingerTouch CloseFinger(const RobotHand& hand, int finger, const Pose& X_OH, const Shape& shape,
                        Eigen::VectorXd& q, const Eigen::Vector3d* wanted_n_O) {
  const RobotHand::Finger& f = hand.fingers[finger];
  std::vector<Pose> X_HB;
  const auto touch_at = [&](const Eigen::VectorXd& posture) {
    ForwardKinematics(hand.tree, posture, X_HB);
    return TouchOf(hand, finger, X_OH, shape, X_HB);
  };
  const auto nearest = [](const FingerTouch& touch) {
    return std::min(touch.proximal, touch.distal);
  };
  const double low = hand.tree.lower[f.j0], high = hand.tree.upper[f.j0];
  if (OnOneValve(hand, finger)) {
    // Both joints turn alike until a phalanx is stopped; the last one goes on if it was the first.
    const double from = std::max(low, hand.tree.lower[f.j1]);
    const double to = std::min(high, hand.tree.upper[f.j1]);
    const double both = CloseUntil(
        from, to, [&](double angle) { q[f.j0] = q[f.j1] = angle; },
        [&] { return nearest(touch_at(q)); });
    if (touch_at(q).distal > 2 * kTouch) {
      CloseUntil(
          both, hand.tree.upper[f.j1], [&](double angle) { q[f.j1] = angle; },
          [&] { return touch_at(q).distal; });
    }
    return touch_at(q);
  }
  Eigen::VectorXd trial = q, best = q;
  FingerTouch best_touch = touch_at(q);
  double best_score = std::numeric_limits<double>::infinity();
  for (int b = 0; b < kBends; ++b) {
    const double bend =
        std::min(hand.tree.upper[f.j1], finger == kThumb ? kMaxThumbBend : kMaxBend);
    trial[f.j1] = hand.tree.lower[f.j1] + (bend - hand.tree.lower[f.j1]) * b / (kBends - 1);
    trial[f.j0] = low;
    if (nearest(touch_at(trial)) < kTouch) continue;
    CloseUntil(
        low, high, [&](double angle) { trial[f.j0] = angle; },
        [&] { return nearest(touch_at(trial)); });
    const FingerTouch touch = touch_at(trial);
    double score = std::min(touch.distal, kPassing) / kPassing;
    if (wanted_n_O != nullptr) {
      score += 0.5 * (1 - wanted_n_O->dot(touch.n_distal));
    } else {
      score += 0.3 * std::min(touch.proximal, kPassing) / kPassing;
    }
    if (score < best_score) {
      best_score = score;
      best_touch = touch;
      best = trial;
    }
  }
  q = best;
  return best_touch;
}

namespace {

// One try: the object at p_AO in the orientation R_HO. Fingers close, then the thumb opposes.
Candidate TrySeat(const RobotHand& hand, const ContactRequest& request,
                  const ContactPostureOptions& options, const Pose& X_HO,
                  const Eigen::VectorXd& q_open) {
  const Shape& shape = request.shape;
  const Pose X_OH = X_HO.inverse();
  const Eigen::Matrix3d R_AO = hand.R_HA.transpose() * X_HO.linear();
  Candidate candidate;
  candidate.X_HO = X_HO;
  candidate.q = q_open;
  candidate.cost = 0;
  std::vector<double> angles;
  const auto add = [&](const Eigen::Vector3d& n_O) {
    const Eigen::Vector3d n_A = R_AO * n_O;
    angles.push_back(std::atan2(n_A.z(), n_A.x()));
  };
  std::vector<Pose> X_HB;
  ForwardKinematics(hand.tree, q_open, X_HB);
  Eigen::Vector3d others = Eigen::Vector3d::Zero();
  // On its way in the object passes the open thumb.
  const FingerTouch passing = TouchOf(hand, kThumb, X_OH, shape, X_HB);
  candidate.cost += 80 * std::max(0.0, kThumbRoom - std::min(passing.proximal, passing.distal));
  // The palm must carry, best by its middle.
  const FingerTouch palm = TouchOf(hand, kPalm, X_OH, shape, X_HB);
  const double middle_gap = SignedDistance(shape, X_OH * hand.p_HPalm);
  candidate.cost += 100 * std::max(0.0, palm.proximal - options.palm_gap - 0.0005);
  candidate.cost += 10 * std::max(0.0, middle_gap - options.palm_gap);
  if (palm.proximal < kPalmNear) {
    others += palm.n_proximal;
    add(palm.n_proximal);
  }
  const auto account = [&](int f, const FingerTouch& touch) {
    const double gap = std::min(touch.proximal, touch.distal);
    candidate.cost += std::clamp(gap, 0.0, kPassing) / kPassing * (f == kThumb ? 4 : 1);
    if (gap < -0.0005) candidate.cost += 20;  // cannot open far enough
    // Fingers hold with their last phalanx; on one valve both must lie on, as both are pressed.
    candidate.cost += kLastPhalanx * std::clamp(touch.distal, 0.0, kPassing) / kPassing;
    if (OnOneValve(hand, f)) {
      candidate.cost += std::clamp(touch.proximal, 0.0, kPassing) / kPassing;
    }
    if (touch.proximal < kNear) add(touch.n_proximal);
    if (touch.distal < kNear) add(touch.n_distal);
  };
  for (int f = kIndex; f < kNumFingers; ++f) {
    if (!request.involved[f]) continue;
    const FingerTouch touch = CloseFinger(hand, f, X_OH, shape, candidate.q);
    account(f, touch);
    others += PressNormal(touch, kNear);
  }
  const Eigen::Vector3d wanted = -others.normalized();
  const FingerTouch thumb = CloseFinger(hand, kThumb, X_OH, shape, candidate.q, &wanted);
  account(kThumb, thumb);
  candidate.cost += 6 * (1 - wanted.dot(PressNormal(thumb, kNear).normalized()));
  candidate.cost += LargestGap(angles);
  return candidate;
}

}  // namespace

ContactPosture SolvePowerPosture(const RobotHand& hand, const ContactRequest& request,
                                 const ContactPostureOptions& options) {
  const Shape& shape = request.shape;
  const Eigen::Matrix3d R_HA = hand.R_HA;
  const Eigen::Matrix3d R_AO = Aligned(shape, request.X_OH_human.linear().transpose());
  // Along the finger axes: a long object with its contacts' mean at the involved fingers' mean, a
  // short one where thumb and fingers both reach it.
  const PerFinger<Eigen::Vector3d> tips = TipPositions(hand, hand.open);
  double y_fingers = 0, y_contacts = 0, count = 0;
  for (int f = kIndex; f < kNumFingers; ++f) {
    if (!request.involved[f]) continue;
    y_fingers += (R_HA.transpose() * tips[f]).y();
    y_contacts += (R_AO * request.p_OC[f]).y();
    count += 1;
  }
  const double y_thumb = (R_HA.transpose() * tips[kThumb]).y();
  const double extent = R_AO.row(1).cwiseAbs().dot(shape.size);
  const bool is_long = shape.kind != Shape::Kind::kSphere && extent > kHandWidth;
  const double y = is_long ? (y_fingers - y_contacts) / count : 0.5 * (y_fingers / count + y_thumb);
  const Eigen::Vector3d p_APalm = R_HA.transpose() * hand.p_HPalm;
  const double reach = 0.5 * shape.size.norm();

  Candidate best;
  std::vector<Pose> X_HB;
  for (const double turn : {0.0, -0.35, 0.35, -0.7, 0.7}) {
    // Turning about the finger axes matters for boxes only.
    if (turn != 0 && shape.kind != Shape::Kind::kBox) continue;
    for (const double palm : {0.0, 0.2}) {
      if (palm != 0 && hand.palm < 0) continue;
      Eigen::VectorXd q_open = hand.open;
      if (hand.palm >= 0) q_open[hand.palm] = hand.tree.lower[hand.palm] + palm;
      ForwardKinematics(hand.tree, q_open, X_HB);
      for (int step = -2; step <= 10; ++step) {
        Pose X_HO = Pose::Identity();
        X_HO.linear() = R_HA * Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitY()) * R_AO;
        Eigen::Vector3d p_AO(p_APalm.x() + 0.005 * step, y, 0);
        // Seat: from far below the palm upwards until the gap is what was asked.
        double far = p_APalm.z() - 0.1 - reach, near = p_APalm.z() + 0.02;
        for (int i = 0; i < 20; ++i) {
          p_AO.z() = 0.5 * (far + near);
          X_HO.translation() = R_HA * p_AO;
          (SeatDistance(hand, X_HB, X_HO.inverse(), shape) > options.palm_gap ? far : near) =
              p_AO.z();
        }
        p_AO.z() = far;
        X_HO.translation() = R_HA * p_AO;
        Candidate candidate = TrySeat(hand, request, options, X_HO, q_open);
        candidate.cost += 2 * palm + 0.1 * std::abs(turn);
        if (candidate.cost < best.cost) best = candidate;
      }
    }
  }
  ContactPosture posture;
  posture.X_HO = best.X_HO;
  posture.q = best.q;
  posture.cost = best.cost;
  return posture;
}

}  // namespace springgrasp
