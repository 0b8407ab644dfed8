#include "experiment/demonstrator_grasp.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/error.h"
#include "grasp/object_contacts.h"
#include "kinematics/levenberg_marquardt.h"

namespace springgrasp {
namespace {

// The natural posture and direction of a type.
struct TypePrior {
  Eigen::VectorXd q;
  Eigen::Matrix3d R_OH;
  Eigen::Vector3d p_HO;  // where in the hand the object is held, m
  double hold = 1;       // weight of p_HO, 1/m
};

Eigen::Matrix3d HandAxes(const Eigen::Vector3d& x, const Eigen::Vector3d& z) {
  Eigen::Matrix3d R;
  R << x, z.cross(x), z;
  return R;
}

TypePrior PriorOf(const DemonstratorHand& hand, const std::string& type, const Shape& shape,
                  bool from_above) {
  const FingerAngles curled{0, 0.75, 1.0, 0.5};
  const Eigen::Vector3d X = Eigen::Vector3d::UnitX(), Y = Eigen::Vector3d::UnitY(),
                        Z = Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d down = from_above ? -Z : -X;  // where the fingers point
  const double s = hand.scale();
  TypePrior prior;
  if (type == "pinch") {
    prior.q =
        PostureOf(hand.tree, {1.1, 0.0, 0.3, 0.3}, {{{0, 0.8, 0.6, 0.3}, curled, curled, curled}});
    prior.R_OH = HandAxes(down, Y);
    prior.p_HO = s * Eigen::Vector3d(0.10, 0.03, -0.06);
  } else if (type == "tripod") {
    prior.q = PostureOf(hand.tree, {1.2, 0.0, 0.3, 0.3},
                        {{{0.05, 0.8, 0.6, 0.3}, {-0.05, 0.8, 0.6, 0.3}, curled, curled}});
    // Turned so that a face of a box lies between thumb and fingers.
    prior.R_OH = Eigen::AngleAxisd(0.2, Z) * HandAxes(down, Y);
    prior.p_HO = s * Eigen::Vector3d(0.10, 0.02, -0.06);
  } else if (type == "power") {
    const FingerAngles wrapped{0, 0.8, 0.9, 0.5};
    prior.q = PostureOf(hand.tree, {1.1, 0.1, 0.4, 0.4}, {{wrapped, wrapped, wrapped, wrapped}});
    prior.R_OH = HandAxes(-X, Y);
    prior.p_HO = {s * 0.08, 0.0, -s * 0.024 - shape.size.x() / 2};
    prior.hold = 4;
  } else {
    const FingerAngles fist{0, 0.8, 1.3, 0.6};
    prior.q =
        PostureOf(hand.tree, {0.5, 0.1, 0.3, 0.3}, {{{0.1, 0.7, 0.9, 0.5}, fist, fist, fist}});
    prior.R_OH = HandAxes(down, Y);
    prior.p_HO = s * Eigen::Vector3d(0.10, 0.045, -0.05);
  }
  return prior;
}

// The residuals of SolveHeldPosture; x = (p_OH, rotation from the prior, q).
class HeldProblem {
 public:
  HeldProblem(const DemonstratorHand& hand, const std::string& type, const Shape& shape,
              const GraspStyle& style)
      : hand_(hand),
        type_(type),
        shape_(shape),
        style_(style),
        prior_(PriorOf(hand, type, shape, ComesFromAbove(type, style.approach))),
        involved_(InvolvedFingers(type)) {
    prior_.R_OH = prior_.R_OH * Eigen::AngleAxisd(style.pitch, Eigen::Vector3d::UnitY()) *
                  Eigen::AngleAxisd(style.roll, Eigen::Vector3d::UnitX());
    start_.resize(6 + hand.tree.num_joints());
    start_ << -(prior_.R_OH * prior_.p_HO), Eigen::Vector3d::Zero(), prior_.q;
    Evaluate(start_, nullptr);
  }

  const Eigen::VectorXd& start() const { return start_; }
  int num_residuals() const { return count_; }
  Pose HandPose(const Eigen::VectorXd& x) const {
    return MakePose(x.head<3>(), Eigen::Quaterniond(prior_.R_OH) * ExpRotation(x.segment<3>(3)));
  }

  // Writes the residuals unless `r` is null; counts them always.
  void Evaluate(const Eigen::VectorXd& x, Eigen::VectorXd* r) {
    r_ = r;
    count_ = 0;
    const Pose X_OH = HandPose(x);
    ComputeHandShape(hand_, x.tail(hand_.tree.num_joints()), bodies_, parts_);
    PerFinger<Eigen::Vector3d> tips;
    for (int f = 0; f < kNumFingers; ++f) tips[f] = X_OH * parts_.tips[f];
    AddContacts(tips);
    AddClearances(X_OH);
    AddSeparations();
    // Naturalness: joints, direction of the hand, place of the object in the hand.
    const auto q = x.tail(hand_.tree.num_joints());
    for (int j = 0; j < q.size(); ++j) Add((q[j] - prior_.q[j]) * 0.12);
    for (int i = 0; i < 3; ++i) Add(x[3 + i] * 0.25);
    const Eigen::Vector3d p_HO = X_OH.inverse().translation();
    for (int i = 0; i < 3; ++i) Add((p_HO[i] - prior_.p_HO[i]) * prior_.hold);
  }

  HeldPosture Result(const Eigen::VectorXd& x) {
    HeldPosture held;
    held.X_OH = HandPose(x);
    held.q = x.tail(hand_.tree.num_joints());
    held.involved = involved_;
    const HandShape parts = ComputeHandShape(hand_, held.q);
    Eigen::Vector3d others = Eigen::Vector3d::Zero(), thumb = Eigen::Vector3d::Zero();
    for (int f = 0; f < kNumFingers; ++f) {
      const Eigen::Vector3d tip = held.X_OH * parts.tips[f];
      if (involved_[f]) {
        const double gap = std::abs(SignedDistance(shape_, tip) - hand_.tip_radius);
        held.worst_gap = std::max(held.worst_gap, gap);
        (f == kThumb ? thumb : others) += OutwardNormal(shape_, tip);
      }
      for (const Eigen::Vector3d& p_H : parts.chains[f]) {
        held.worst_penetration = std::max(
            held.worst_penetration, hand_.tip_radius - SignedDistance(shape_, held.X_OH * p_H));
      }
    }
    const double cosine = thumb.normalized().dot(others.normalized());
    held.opposition_deg = std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / M_PI;
    return held;
  }

 private:
  void Add(double value) {
    if (r_ != nullptr) (*r_)[count_] = value;
    ++count_;
  }

  void AddContacts(const PerFinger<Eigen::Vector3d>& tips) {
    constexpr double kGap = 100, kOpposed = 0.3, kHeight = 12;
    for (int f = 0; f < kNumFingers; ++f) {
      if (!involved_[f]) continue;
      if (shape_.kind == Shape::Kind::kBox && type_ != "lateral") {
        AddFaceContact(tips[f], f == kThumb ? -1.0 : 1.0, kGap);
      } else {
        Add((SignedDistance(shape_, tips[f]) - hand_.tip_radius) * kGap);
      }
    }
    const Eigen::Vector3d thumb = OutwardNormal(shape_, tips[kThumb]);
    for (int f = kIndex; f < kNumFingers; ++f) {
      if (!involved_[f]) continue;
      const Eigen::Vector3d sum = thumb + OutwardNormal(shape_, tips[f]);
      for (int i = 0; i < 3; ++i) Add(sum[i] * kOpposed);
    }
    // Contacts at the wanted height; lateral: on the plate's middle, thumb over index.
    if (type_ == "lateral") {
      const Eigen::Vector3d between = tips[kThumb] - tips[kIndex];
      Eigen::Index thin = 0;
      shape_.size.minCoeff(&thin);
      for (int i = 0; i < 3; ++i) {
        Add(i == thin ? 0.0 : between[i] * kHeight);
        Add(i == thin ? 0.0 : (tips[kThumb][i] + tips[kIndex][i]) / 2 * 0.2 * kHeight);
      }
    } else {
      // Fingers that come from the side lie above each other, others beside each other.
      const double fingers = ComesFromAbove(type_, style_.approach) ? kHeight : 0.1 * kHeight;
      for (int f = 0; f < kNumFingers; ++f) {
        if (involved_[f]) Add((tips[f].z() - style_.height) * (f == kThumb ? kHeight : fingers));
      }
    }
  }

  // On a box the thumb takes the face at -x, the fingers that at +x; tips stay off the edges.
  void AddFaceContact(const Eigen::Vector3d& tip, double side, double weight) {
    constexpr double kEdge = 0.004;
    Add((side * tip.x() - shape_.size.x() / 2 - hand_.tip_radius) * weight);
    for (int i = 1; i < 3; ++i) {
      Add(std::max(0.0, std::abs(tip[i]) - std::max(0.0, shape_.size[i] / 2 - kEdge)) * weight);
    }
  }

  // Segments stay outside the object, and so does the palm.
  void AddClearances(const Pose& X_OH) {
    constexpr double kPush = 60, kPalmThickness = 0.014, kSlack = 0.0005;
    const auto hinge = [&](const Eigen::Vector3d& p_H, double radius) {
      Add(std::max(0.0, radius + kSlack - SignedDistance(shape_, X_OH * p_H)) * kPush);
    };
    for (int f = 0; f < kNumFingers; ++f) {
      const auto& chain = parts_.chains[f];
      for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
        hinge(chain[i], hand_.finger_radius);
        hinge((chain[i] + chain[i + 1]) / 2, hand_.finger_radius);
      }
      if (!involved_[f]) hinge(chain.back(), hand_.tip_radius);
    }
    const double s = hand_.scale();
    for (const double x : {0.03, 0.055, 0.08}) {
      for (const double y : {-0.025, 0.0, 0.02}) hinge({s * x, s * y, 0}, s * kPalmThickness);
    }
  }

  // Neighbouring fingers lie beside each other in their order, fanned out so far that their caps
  // do not touch: people are asked to, so that the cameras can tell them apart.
  void AddSeparations() {
    constexpr double kPush = 60;
    const double apart = 2 * hand_.tip_radius + 0.002;
    const double caps_apart = 2 * hand_.size.cap_radius + 0.003;
    for (int f = kIndex; f + 1 < kNumFingers; ++f) {
      const auto& a = parts_.chains[f];
      const auto& b = parts_.chains[f + 1];
      for (std::size_t k = 1; k < std::min(a.size(), b.size()); ++k) {
        const bool tips = k + 1 == a.size();
        Add(std::max(0.0, (tips ? caps_apart : apart) - (a[k].y() - b[k].y())) * kPush);
      }
    }
  }

  const DemonstratorHand& hand_;
  std::string type_;
  Shape shape_;
  GraspStyle style_;
  TypePrior prior_;
  PerFinger<bool> involved_;
  Eigen::VectorXd start_;
  Eigen::VectorXd* r_ = nullptr;
  int count_ = 0;
  std::vector<Pose> bodies_;
  HandShape parts_;
};

}  // namespace

bool ComesFromAbove(const std::string& type, const std::string& approach) {
  ThrowUnless(approach == "usual" || approach == "above" || approach == "side",
              "there is no approach '{}'; expected usual, above or side", approach);
  ThrowUnless(type != "power" || approach != "above",
              "a power grasp is shown from the side only, not from above");
  return approach == "above" || (approach == "usual" && (type == "pinch" || type == "tripod"));
}

HeldPosture SolveHeldPosture(const DemonstratorHand& hand, const std::string& type,
                             const Shape& shape, const GraspStyle& style) {
  HeldProblem held(hand, type, shape, style);
  LeastSquaresProblem problem;
  problem.num_residuals = held.num_residuals();
  const int n = static_cast<int>(held.start().size());
  problem.lower = Eigen::VectorXd::Constant(n, -1);
  problem.upper = Eigen::VectorXd::Constant(n, 1);
  problem.lower.tail(hand.tree.num_joints()) = hand.tree.lower;
  problem.upper.tail(hand.tree.num_joints()) = hand.tree.upper;
  problem.evaluate = [&](const Eigen::VectorXd& x, Eigen::VectorXd& r, Eigen::MatrixXd* J) {
    held.Evaluate(x, &r);
    if (J != nullptr) NumericalJacobian(problem, x, 1e-6, *J);
  };
  LevenbergMarquardtOptions options;
  options.max_iterations = 150;
  options.step_tolerance = 1e-9;
  return held.Result(MinimizeLeastSquares(problem, held.start(), options).x);
}

}  // namespace springgrasp
