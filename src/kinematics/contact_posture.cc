#include "kinematics/contact_posture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "base/error.h"
#include "kinematics/levenberg_marquardt.h"
#include "kinematics/power_posture.h"
#include "kinematics/shape_distance.h"

namespace springgrasp {
namespace {

// Deviations that cost 1 each (rows of FingertipRows below).
constexpr double kTouch = 0.0001;  // m, pad off the surface
constexpr double kSlide = 0.003;   // m, contact along the surface
constexpr double kOppose = 0.05;   // rad, thumb's normal against the others'
constexpr double kLine = 0.05;     // rad, line of the contacts against the thumb's normal
constexpr double kWrist = 0.1;     // rad, wrist out of the demonstrated half plane
// rad, that three pads and more press towards the wrist: what lies farther out in the hand than
// believed is lost before what lies farther in (tuned with experiments/pose_error, seed 63).
constexpr double kDeep = 0.1;
constexpr double kPenetration = 0.0005;  // m
constexpr double kPalmJoint = 0.5;       // rad
constexpr double kOpposition = 1;        // rad, of the thumb's turn from the human one
constexpr double kOneValve = 0.2;        // rad, between a finger's joints on one valve
constexpr double kLikeHuman = 4;         // rad, involved fingers
constexpr double kOpen = 0.5;            // rad, fingers that should be out of the way
constexpr double kLever = 0.01;          // m, of a joint that could not press
constexpr double kMinProximalLever = 0.035, kMinDistalLever = 0.018;  // m
constexpr double kPad = 0.2;  // contact away from the pad's palmar side
// Of lateral grasps: the index's push off its radial axis (rad), the thumb's about its turning
// joint (m), a fist's joints, the index's last joint, where the search for the thumb's turn begins
// (rad).
constexpr double kRadial = 0.1, kMaxTurningLever = 0.005, kTurningLever = 0.002;
constexpr double kFist = 1.4, kAcross = 1.5, kTurned = 1.2;
constexpr int kStarts = 5;
// What presses in a power grasp, m.
constexpr double kTouching = 0.0025, kPalmTouching = 0.005;

Eigen::Vector3d TipOf(const RobotHand& hand, const std::vector<Pose>& X_HB, int finger) {
  return FramePose(hand.tree, X_HB, hand.fingers[finger].tip).translation();
}

// Where the side of a finger meets the thumb: the point on the axis of its last phalanx that is
// nearest to the thumb's tip across the hand, in H.
Eigen::Vector3d SideContact(const RobotHand& hand, const std::vector<Pose>& X_HB, int finger) {
  Eigen::Vector3d a = Eigen::Vector3d::Zero(), b = a;
  for (const LinkCapsule& c : hand.capsules) {
    if (c.finger != finger || !c.distal) continue;
    a = X_HB[c.node] * c.a;
    b = X_HB[c.node] * c.b;
  }
  const Eigen::Vector3d radial = hand.R_HA.col(1);
  const auto across = [&](const Eigen::Vector3d& v) { return (v - radial * radial.dot(v)).eval(); };
  const Eigen::Vector3d along = across(b - a);
  const double length = std::max(1e-9, along.squaredNorm());
  const double s = across(TipOf(hand, X_HB, kThumb) - a).dot(along) / length;
  return a + std::clamp(s, 0.0, 1.0) * (b - a);
}

// Everything that is known about one try: object in the hand and joints.
class FingertipRows {
 public:
  FingertipRows(const RobotHand& hand, const ContactRequest& request,
                const ContactPostureOptions& options, const Pose& X_HO_seed)
      : hand_(hand),
        request_(request),
        options_(options),
        X_HO_seed_(X_HO_seed),
        lateral_(request.type == "lateral"),
        J_(6, hand.tree.num_joints()) {}

  int num_unknowns() const { return 6 + hand_.tree.num_joints(); }
  int num_rows() const {
    int involved = 0;
    for (const bool i : request_.involved) involved += i ? 1 : 0;
    return 7 * involved + 7 + 2 * kNumFingers + 1 + (hand_.opposition >= 0 ? 3 : 0) +
           static_cast<int>(hand_.capsules.size());
  }

  Pose ObjectPose(const Eigen::VectorXd& x) const {
    return MakePose(X_HO_seed_.translation() + x.head<3>(),
                    Eigen::Quaterniond(X_HO_seed_.linear()) * ExpRotation(x.segment<3>(3)));
  }

  void Evaluate(const Eigen::VectorXd& x, Eigen::VectorXd& r) {
    const Pose X_OH = ObjectPose(x).inverse();
    const auto q = x.tail(hand_.tree.num_joints());
    ForwardKinematics(hand_.tree, q, X_HB_);
    int row = 0;
    Eigen::Vector3d n_others = Eigen::Vector3d::Zero(), p_others = Eigen::Vector3d::Zero();
    Eigen::Vector3d n_thumb = Eigen::Vector3d::UnitX(), p_thumb = Eigen::Vector3d::Zero();
    double others = 0, turning = 0;
    for (int f = 0; f < kNumFingers; ++f) {
      if (!request_.involved[f]) continue;
      const RobotHand::Finger& finger = hand_.fingers[f];
      const bool side = lateral_ && f != kThumb;
      const Eigen::Vector3d p_HC = side ? SideContact(hand_, X_HB_, f) : TipOf(hand_, X_HB_, f);
      const Eigen::Vector3d p = X_OH * p_HC;
      Eigen::Vector3d n;
      const double gap = SignedDistance(request_.shape, p, &n) - hand_.tip_radius;
      const Eigen::Vector3d slide = p - request_.p_OC[f];
      r[row++] = (gap + options_.squeeze) / kTouch;
      r.segment<3>(row) = (slide - n * n.dot(slide)) / kSlide;
      row += 3;
      const Eigen::Vector3d push_H = X_OH.linear().transpose() * -n;
      if (side) {
        // It only withstands the thumb, along the axes of its joints.
        r.segment<3>(row) = (push_H - hand_.R_HA.col(1)) / kRadial;
      } else {
        // The joints must be able to press: levers of the push -n about both joints.
        FrameJacobian(hand_.tree, X_HB_, finger.tip, J_);
        const double lever0 = J_.col(finger.j0).head<3>().dot(push_H);
        const double lever1 = J_.col(finger.j1).head<3>().dot(push_H);
        r[row] = std::max(0.0, kMinProximalLever - lever0) / kLever;
        r[row + 1] = std::max(0.0, kMinDistalLever - lever1) / kLever;
        // ... and do so with the palmar side: where flexion moves the straight link.
        const int node = hand_.tree.frames[finger.tip].node;
        const Eigen::Vector3d along = hand_.tree.frames[finger.tip].X_BF.translation().normalized();
        const Eigen::Vector3d palmar_H =
            X_HB_[node].linear() * hand_.tree.nodes[node].axis.cross(along).normalized();
        r[row + 2] = std::max(0.0, 0.35 - palmar_H.dot(push_H)) / kPad;
        // The spring that turns the thumb back presses little.
        if (lateral_ && hand_.opposition >= 0) {
          const double lever = J_.col(hand_.opposition).head<3>().dot(push_H);
          turning = std::max(0.0, -lever - kMaxTurningLever) / kTurningLever;
        }
      }
      row += 3;
      if (f == kThumb) {
        n_thumb = n;
        p_thumb = p;
      } else {
        n_others += n;
        p_others += p;
        others += 1;
      }
    }
    p_others /= others;
    const Eigen::Vector3d line = (p_others - p_thumb).normalized();
    const Eigen::Vector3d towards_wrist = X_OH.translation() - 0.5 * (p_thumb + p_others);
    const Eigen::Vector3d wrist = towards_wrist - line * line.dot(towards_wrist);
    const Eigen::Vector3d deep = (others > 1 ? kDeep : 0) * wrist.normalized();
    r.segment<3>(row) = (n_thumb + n_others / others + 2 * deep) / kOppose;
    r.segment<3>(row + 3) = (line + n_thumb + deep) / kLine;
    row += 6;
    // Angle of the wrist about the contact line, from the demonstrated half plane.
    const Eigen::Vector3d z = request_.X_OG.linear().col(2);
    r[row++] = std::atan2(line.dot(z.cross(wrist)), z.dot(wrist)) / kWrist;
    for (int f = 0; f < kNumFingers; ++f) {
      for (int k = 0; k < 2; ++k) {
        const int j = k == 0 ? hand_.fingers[f].j0 : hand_.fingers[f].j1;
        if (lateral_ && f != kThumb) {
          // A fist, of which the index lays its last phalanx along the plate.
          const double bent = request_.involved[f] ? (k == 0 ? 0 : kAcross) : kFist;
          r[row++] = (q[j] - bent) / kOpen;
        } else {
          r[row++] = request_.involved[f] ? (q[j] - request_.human.sigma[f][k]) / kLikeHuman
                                          : (q[j] - hand_.open[j]) / kOpen;
        }
      }
    }
    r[row++] = hand_.palm >= 0 ? q[hand_.palm] / kPalmJoint : 0;
    if (hand_.opposition >= 0) {
      const RobotHand::Finger& thumb = hand_.fingers[kThumb];
      r[row++] = (q[hand_.opposition] - request_.human.opposition) / kOpposition;
      r[row++] = (q[thumb.j0] - q[thumb.j1]) / kOneValve;
      r[row++] = turning;
    }
    for (const LinkCapsule& c : hand_.capsules) {
      const Pose X_OB = X_OH * X_HB_[c.node];
      const double distance = CapsuleDistance(request_.shape, X_OB * c.a, X_OB * c.b, c.radius);
      const bool touching = c.finger >= 0 && request_.involved[c.finger];
      const double wanted = touching       ? -options_.squeeze
                            : c.finger < 0 ? 0.003
                                           : options_.clearance;
      // A link may come near more softly than it may penetrate.
      const double weight = touching || c.finger < 0 ? kPenetration : 4 * kPenetration;
      r[row++] = std::max(0.0, wanted - distance) / weight;
    }
  }

 private:
  const RobotHand& hand_;
  const ContactRequest& request_;
  const ContactPostureOptions& options_;
  const Pose X_HO_seed_;
  const bool lateral_;
  std::vector<Pose> X_HB_;
  Eigen::MatrixXd J_;
};

// Object pose that puts thumb and mean other contact on the line of the tips, wrist side right.
Pose SeedObject(const RobotHand& hand, const ContactRequest& request, const Eigen::VectorXd& q) {
  PerFinger<Eigen::Vector3d> tips = TipPositions(hand, q);
  if (request.type == "lateral") {
    std::vector<Pose> X_HB;
    ForwardKinematics(hand.tree, q, X_HB);
    tips[kIndex] = SideContact(hand, X_HB, kIndex);
  }
  Eigen::Vector3d p_HOthers = Eigen::Vector3d::Zero(), p_OOthers = Eigen::Vector3d::Zero();
  double others = 0;
  for (int f = kIndex; f < kNumFingers; ++f) {
    if (!request.involved[f]) continue;
    p_HOthers += tips[f];
    p_OOthers += request.p_OC[f];
    others += 1;
  }
  p_HOthers /= others;
  p_OOthers /= others;
  const Eigen::Vector3d middle_H = 0.5 * (tips[kThumb] + p_HOthers);
  const Eigen::Vector3d middle_O = 0.5 * (request.p_OC[kThumb] + p_OOthers);
  const Eigen::Matrix3d R_HG = FrameFromXZ(p_HOthers - tips[kThumb], -middle_H);
  const Eigen::Matrix3d R_OG =
      FrameFromXZ(p_OOthers - request.p_OC[kThumb], request.X_OG.linear().col(2));
  Pose X_HO = Pose::Identity();
  X_HO.linear() = R_HG * R_OG.transpose();
  X_HO.translation() = middle_H - X_HO.linear() * middle_O;
  return X_HO;
}

struct Start {
  double cost = 0;
  Pose X_HO = Pose::Identity();
  Eigen::VectorXd q;
};

std::vector<Start> Starts(const RobotHand& hand, const ContactRequest& request,
                          const ContactPostureOptions& options) {
  std::vector<Start> starts;
  for (const double thumb0 : {0.15, 0.5, 0.9}) {
    for (const double thumb1 : {0.1, 0.5}) {
      for (const double finger0 : {0.5, 0.85, 1.2}) {
        for (const double finger1 : {0.2, 0.6, 1.0}) {
          Start start;
          start.q = hand.open;
          for (int f = 0; f < kNumFingers; ++f) {
            if (!request.involved[f]) continue;
            start.q[hand.fingers[f].j0] = f == kThumb ? thumb0 : finger0;
            start.q[hand.fingers[f].j1] = f == kThumb ? thumb1 : finger1;
          }
          if (request.type == "lateral") {
            start.q[hand.fingers[kIndex].j1] = kAcross;
            if (hand.opposition >= 0) start.q[hand.opposition] = kTurned;
          }
          start.q = start.q.cwiseMax(hand.tree.lower).cwiseMin(hand.tree.upper);
          start.X_HO = SeedObject(hand, request, start.q);
          FingertipRows rows(hand, request, options, start.X_HO);
          Eigen::VectorXd x = Eigen::VectorXd::Zero(rows.num_unknowns()), r(rows.num_rows());
          x.tail(hand.tree.num_joints()) = start.q;
          rows.Evaluate(x, r);
          start.cost = r.squaredNorm();
          starts.push_back(std::move(start));
        }
      }
    }
  }
  std::stable_sort(starts.begin(), starts.end(),
                   [](const Start& a, const Start& b) { return a.cost < b.cost; });
  starts.resize(kStarts);
  return starts;
}

ContactPosture SolveFingertips(const RobotHand& hand, const ContactRequest& request,
                               const ContactPostureOptions& options) {
  ContactPosture best;
  best.cost = std::numeric_limits<double>::infinity();
  for (const Start& start : Starts(hand, request, options)) {
    FingertipRows rows(hand, request, options, start.X_HO);
    LeastSquaresProblem problem;
    const int n = rows.num_unknowns();
    problem.num_residuals = rows.num_rows();
    problem.lower = Eigen::VectorXd::Constant(n, -1);
    problem.upper = Eigen::VectorXd::Constant(n, 1);
    problem.lower.tail(hand.tree.num_joints()) = hand.tree.lower;
    problem.upper.tail(hand.tree.num_joints()) = hand.tree.upper;
    problem.evaluate = [&](const Eigen::VectorXd& x, Eigen::VectorXd& r, Eigen::MatrixXd* J) {
      rows.Evaluate(x, r);
      // Minima over samples and one-sided rows: differences are as good as any derivative here.
      if (J != nullptr) NumericalJacobian(problem, x, 1e-6, *J);
    };
    Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
    x.tail(hand.tree.num_joints()) = start.q;
    LevenbergMarquardtOptions solver;
    solver.max_iterations = 80;
    solver.gradient_tolerance = 1e-5;
    solver.step_tolerance = 1e-7;
    const LevenbergMarquardtResult solution = MinimizeLeastSquares(problem, x, solver);
    if (solution.cost < best.cost) {
      best.cost = solution.cost;
      best.X_HO = rows.ObjectPose(solution.x);
      best.q = solution.x.tail(hand.tree.num_joints());
    }
  }
  return best;
}

}  // namespace

void JudgePosture(const RobotHand& hand, const ContactRequest& request, ContactPosture& posture) {
  std::vector<Pose> X_HB;
  ForwardKinematics(hand.tree, posture.q, X_HB);
  const Pose X_OH = posture.X_HO.inverse();
  posture.X_HG = posture.X_HO * request.X_OG;
  const bool power = request.type == "power";
  Eigen::Vector3d n_thumb = Eigen::Vector3d::Zero(), n_others = Eigen::Vector3d::Zero();
  posture.slide = 0;
  posture.penetration = 0;
  posture.clearance = std::numeric_limits<double>::infinity();
  for (const LinkCapsule& c : hand.capsules) {
    const Pose X_OB = X_OH * X_HB[c.node];
    const double d = CapsuleDistance(request.shape, X_OB * c.a, X_OB * c.b, c.radius);
    posture.penetration = std::max(posture.penetration, -d);
    const bool spare = c.finger >= 0 && !request.involved[c.finger];
    if (spare) posture.clearance = std::min(posture.clearance, d);
  }
  for (int f = 0; f < kNumFingers; ++f) {
    Eigen::Vector3d p = X_OH * TipOf(hand, X_HB, f);
    posture.p_OC[f] = p;
    if (!request.involved[f]) continue;
    if (request.type == "lateral" && f != kThumb) p = X_OH * SideContact(hand, X_HB, f);
    Eigen::Vector3d n;
    posture.gap[f] = SignedDistance(request.shape, p, &n) - hand.tip_radius;
    if (power) {
      const FingerTouch touch = TouchOf(hand, f, X_OH, request.shape, X_HB);
      posture.gap[f] = std::min(touch.proximal, touch.distal);
      n = PressNormal(touch, kTouching);
    }
    posture.slide = std::max(posture.slide, (p - request.p_OC[f]).norm());
    (f == kThumb ? n_thumb : n_others) += n;
  }
  if (power) {
    const FingerTouch palm = TouchOf(hand, -1, X_OH, request.shape, X_HB);
    if (palm.proximal < kPalmTouching) n_others += palm.n_proximal;
  }
  const double cosine = n_thumb.normalized().dot(n_others.normalized());
  posture.opposition_deg = std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi;
}

Pose ContactFrame(const Shape& shape, const ContactPosture& posture) {
  const Pose X_OG = posture.X_HO.inverse() * posture.X_HG;
  Eigen::Vector3d n;
  SignedDistance(shape, posture.p_OC[kThumb], &n);
  Pose X_OC = Pose::Identity();
  X_OC.linear() = FrameFromXZ(-n, X_OG.linear().col(2));
  X_OC.translation() = posture.p_OC[kThumb];
  return posture.X_HO * X_OC;
}

ContactPosture SolveContactPosture(const RobotHand& hand, const ContactRequest& request,
                                   const ContactPostureOptions& options) {
  const bool known = request.type == "pinch" || request.type == "tripod" ||
                     request.type == "power" || request.type == "lateral";
  ThrowUnless(known, "grasp type '{}': expected pinch, tripod, power or lateral", request.type);
  bool finger = false;
  for (int f = kIndex; f < kNumFingers; ++f) finger = finger || request.involved[f];
  ThrowUnless(request.involved[kThumb] && finger,
              "a {} needs the thumb and at least one finger involved", request.type);
  ContactPosture posture = request.type == "power" ? SolvePowerPosture(hand, request, options)
                                                   : SolveFingertips(hand, request, options);
  JudgePosture(hand, request, posture);
  return posture;
}

}  // namespace springgrasp
