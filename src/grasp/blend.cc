#include "grasp/blend.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "grasp/generate.h"
#include "grasp/transfer.h"

namespace springgrasp {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

template <typename T>
T Mix(const T& a, const T& b, double s) {
  return (1 - s) * a + s * b;
}

// By logarithms where both are positive.
double MixGain(double a, double b, double s) {
  return a > 0 && b > 0 ? std::exp(Mix(std::log(a), std::log(b), s)) : Mix(a, b, s);
}

// Between two places seen from the object's centre: about it, not through it.
Vector3d MixAround(const Vector3d& a, const Vector3d& b, double s) {
  if (a.norm() < 1e-6 || b.norm() < 1e-6) return Mix(a, b, s);
  const Quaterniond turn = Quaterniond::FromTwoVectors(a, b);
  const Vector3d direction = Quaterniond::Identity().slerp(s, turn) * a.normalized();
  return Mix(a.norm(), b.norm(), s) * direction;
}

// Where a finger starts in H, and its contact there.
struct PlacesInHand {
  Vector3d p_HF, p_HC;
};
PlacesInHand FingerInHand(const Grasp& grasp, const PerFinger<Contact>& contacts, int i) {
  if (!grasp.involved[i]) return {grasp.offset[i], grasp.offset[i]};
  const Vector3d p_HC = grasp.X_OH.inverse() * contacts[i].p_OC;
  return {p_HC + grasp.offset[i], p_HC};
}

// Every edge of either; one that a grasp does not have is a spring without force there.
std::vector<GraspEdge> MixEdges(const Grasp& from, const Grasp& to, double s) {
  std::vector<GraspEdge> edges;
  const auto find = [](const Grasp& grasp, const GraspEdge& edge) -> const GraspEdge* {
    for (const GraspEdge& other : grasp.edges) {
      if (std::minmax(other.i, other.j) == std::minmax(edge.i, edge.j)) return &other;
    }
    return nullptr;
  };
  const auto mix = [&](const GraspEdge& any, const GraspEdge* a, const GraspEdge* b) {
    GraspEdge edge = any;
    // By logarithms too, of what is more than a spring that does nothing: a stiff one fades at
    // once.
    const double nothing = 0.01 * MixGain(from.kc, to.kc, s);
    edge.k = MixGain((a ? a->k : 0) + nothing, (b ? b->k : 0) + nothing, s) - nothing;
    edge.k = std::max(0.0, edge.k);
    edge.damping = Mix(a ? a->damping : 0.0, b ? b->damping : 0.0, s);
    edge.rest_length = Mix((a ? a : b)->rest_length, (b ? b : a)->rest_length, s);
    edge.standard_error = 0;
    edges.push_back(edge);
  };
  for (const GraspEdge& edge : from.edges) mix(edge, &edge, find(to, edge));
  for (const GraspEdge& edge : to.edges) {
    if (!find(from, edge)) mix(edge, nullptr, &edge);
  }
  return edges;
}

// Seen from its own goal, where the hand meets the object; `X_OG` is the goal in between.
PoseDmp MixReach(const PoseDmp& from, const PoseDmp& to, const Pose& X_OG, double s) {
  const Dmp &a = from.motion, &b = to.motion;
  ThrowUnless(a.centers.size() == b.centers.size() && a.centers.isApprox(b.centers, 1e-9) &&
                  a.widths.isApprox(b.widths, 1e-9) && a.K == b.K && a.alpha == b.alpha,
              "the reaches of the two grasps have different bases and cannot be blended");
  const Pose goal_a = GoalPose(from), goal_b = GoalPose(to);
  PoseDmp reach = from;
  reach.motion.tau = MixGain(a.tau, b.tau, s);
  reach.motion.weights = Mix(a.weights, b.weights, s);
  const Eigen::MatrixXd way = Mix(Eigen::MatrixXd(a.weights.leftCols<3>() * goal_a.linear()),
                                  Eigen::MatrixXd(b.weights.leftCols<3>() * goal_b.linear()), s);
  reach.motion.weights.leftCols<3>() = way * X_OG.linear().transpose();
  reach.R_ref = Quaterniond(X_OG.linear());
  reach.motion.g.setZero();
  const Pose X_GStart =
      Interpolate(goal_a.inverse() * StartPose(from), goal_b.inverse() * StartPose(to), s);
  return WithEndpoints(reach, X_OG * X_GStart, X_OG);
}

// With the holding force that the grasp lands with on its object, instead of one to start the
// search from: in between it must not be searched for, but runs from one end to the other.
Grasp WithLanding(const Grasp& given) {
  GenerateOptions options;
  options.shape = given.shape;
  options.tip_radius = given.tip_radius;
  const FingertipMotion motion = GenerateMotion(given, options);
  Grasp grasp = given;
  grasp.holding =
      std::max(given.holding, motion.samples.back().f_cen / (given.kc * given.scales.x0));
  return grasp;
}

Pose Moved(const Pose& X, const Vector3d& shift) {
  Pose moved = X;
  moved.translation() += shift;
  return moved;
}

}  // namespace

Grasp CarriedTo(const Grasp& given, const Shape& shape, double tip_radius) {
  Grasp grasp = EncloseAlongAxis(given, shape);
  const Vector3d shift =
      MiddleOfContacts(ContactsOn(grasp, shape, tip_radius), grasp.involved) -
      MiddleOfContacts(ContactsOn(grasp, grasp.shape, grasp.tip_radius), grasp.involved);
  grasp.object_given = true;
  grasp.shape = shape;
  grasp.tip_radius = tip_radius;
  grasp.X_OH = Moved(grasp.X_OH, shift);
  grasp.reach.motion.x0.head<3>() += shift;
  grasp.reach.motion.g.head<3>() += shift;
  return grasp;
}

Grasp BlendGrasps(const Grasp& from, const Grasp& to, double s, const Shape& shape,
                  double tip_radius) {
  ThrowUnless(s >= 0 && s <= 1, "blend: {} is not between 0 and 1", s);
  ThrowUnless(from.dim == to.dim && from.ratio == to.ratio && from.profile == to.profile,
              "{} and {} differ in dim, ratio or profile and cannot be blended", from.name,
              to.name);
  const Grasp a = WithLanding(CarriedTo(from, shape, tip_radius));
  const Grasp b = WithLanding(CarriedTo(to, shape, tip_radius));
  if (s == 0) return a;
  if (s == 1) return b;
  const PerFinger<Contact> contacts_a = ContactsOn(a, shape, tip_radius);
  const PerFinger<Contact> contacts_b = ContactsOn(b, shape, tip_radius);

  Grasp grasp = s < 0.5 ? a : b;
  grasp.name = fmt::format("{}-{} {}", from.name, to.name, s);
  grasp.source = fmt::format("between {} and {}", from.source, to.source);
  grasp.quality = {};
  grasp.hand_length = Mix(a.hand_length, b.hand_length, s);
  // In the hand, whose fingers stay about it.
  grasp.X_OH = Interpolate(a.X_OH.inverse(), b.X_OH.inverse(), s).inverse();
  grasp.X_HG = Interpolate(a.X_HG, b.X_HG, s);
  grasp.X_HP = Interpolate(a.X_HP, b.X_HP, s);
  grasp.scales = {MixGain(a.scales.T, b.scales.T, s), MixGain(a.scales.A, b.scales.A, s),
                  MixGain(a.scales.x0, b.scales.x0, s)};
  grasp.mass = MixGain(a.mass, b.mass, s);
  grasp.kc = MixGain(a.kc, b.kc, s);
  grasp.dc = MixGain(a.dc, b.dc, s);
  grasp.ambient_damping = MixGain(a.ambient_damping, b.ambient_damping, s);
  grasp.reach_gain = MixGain(a.reach_gain, b.reach_gain, s);
  grasp.delay = Mix(a.delay, b.delay, s);
  grasp.closing = MixGain(a.closing, b.closing, s);
  grasp.holding = MixGain(a.holding, b.holding, s);
  grasp.max_ratio = MixGain(a.max_ratio, b.max_ratio, s);
  grasp.t_switch = Mix(a.t_switch, b.t_switch, s);
  if (a.switch_rule != b.switch_rule) grasp.switch_rule = "fitted";
  grasp.edges = MixEdges(a, b, s);
  grasp.reach = MixReach(a.reach, b.reach, grasp.X_OH * grasp.X_HG, s);
  for (int i = 0; i < kNumFingers; ++i) {
    grasp.observed[i] = a.observed[i] || b.observed[i];
    grasp.involved[i] = a.involved[i] || b.involved[i];
    if (grasp.involved[i]) {
      // A small share moves a finger that nothing else holds as far as a large one, given time: it
      // comes and goes without a slope.
      const double grown = s * s * (3 - 2 * s);
      grasp.share[i] =
          Mix(a.involved[i] ? a.share[i] : 0.0, b.involved[i] ? b.share[i] : 0.0, grown);
    }
    if (a.involved[i] && b.involved[i]) {
      grasp.opening[i] = Mix(a.opening[i], b.opening[i], s);
      grasp.opening_bend[i] = Mix(a.opening_bend[i], b.opening_bend[i], s);
      grasp.bend[i] = Mix(a.bend[i], b.bend[i], s);
      grasp.lag[i] = Mix(a.lag[i], b.lag[i], s);
    } else if (grasp.involved[i]) {
      // Its share of the force, not its way, grows from nothing.
      const Grasp& taken = a.involved[i] ? a : b;
      grasp.opening[i] = taken.opening[i];
      grasp.opening_bend[i] = taken.opening_bend[i];
      grasp.bend[i] = taken.bend[i];
      grasp.lag[i] = taken.lag[i];
    }
    grasp.velocity[i] = Mix(a.velocity[i], b.velocity[i], s);
  }
  const Vector3d p_HO_a = a.X_OH.inverse().translation(), p_HO_b = b.X_OH.inverse().translation();
  const Vector3d p_HO = grasp.X_OH.inverse().translation();
  for (int i = 0; i < kNumFingers; ++i) {
    const PlacesInHand at_a = FingerInHand(a, contacts_a, i), at_b = FingerInHand(b, contacts_b, i);
    grasp.offset[i] = p_HO + MixAround(at_a.p_HF - p_HO_a, at_b.p_HF - p_HO_b, s);
    if (!grasp.involved[i]) continue;
    const Vector3d p_HC = p_HO + MixAround(at_a.p_HC - p_HO_a, at_b.p_HC - p_HO_b, s);
    const Vector3d p_OC = grasp.X_OH * p_HC;
    grasp.rays[i] = RayOfContact(shape, p_OC);
    // A finger on its way into the grasp hovers between its place at rest and the surface.
    if (grasp.share[i] < 1) {
      grasp.clearance[i] = std::max(0.0, SignedDistance(shape, p_OC) - tip_radius);
    }
  }
  const PerFinger<Contact> contacts = ContactsOn(grasp, shape, tip_radius);
  for (int i = 0; i < kNumFingers; ++i) {
    if (grasp.involved[i]) grasp.offset[i] -= grasp.X_OH.inverse() * contacts[i].p_OC;
  }
  return grasp;
}

}  // namespace springgrasp
