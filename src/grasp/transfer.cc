#include "grasp/transfer.h"

#include <algorithm>

#include "base/error.h"
#include "grasp/generate.h"

namespace springgrasp {

Grasp EncloseAlongAxis(const Grasp& grasp, const Shape& shape) {
  if (grasp.object_given || grasp.type != "power" || shape.kind != Shape::Kind::kCylinder) {
    return grasp;
  }
  const Pose X_OG = grasp.X_OH * grasp.X_HG;
  const bool thumb_up = X_OG.linear().col(1).dot(grasp.X_OH.linear().col(1)) > 0;
  const Eigen::Vector3d axis = (thumb_up ? 1 : -1) * X_OG.linear().col(1);
  Pose X_NO = Pose::Identity();  // N: O turned about its origin, z along the axis
  X_NO.linear() = FrameFromXZ(X_OG.linear().col(0), axis).transpose();

  Grasp turned = grasp;
  turned.X_OH = X_NO * grasp.X_OH;
  turned.shape = {Shape::Kind::kCylinder,
                  {grasp.shape.size.x(), grasp.shape.size.x(), shape.size.z()}};
  const PerFinger<Contact> contacts = ContactsOn(grasp, grasp.shape, grasp.tip_radius);
  for (int i = 0; i < kNumFingers; ++i) {
    if (!grasp.involved[i]) continue;
    const Eigen::Vector3d p_N = X_NO * contacts[i].p_OC;
    turned.rays[i].height = p_N.z() / shape.size.z();
    turned.rays[i].direction = Eigen::Vector3d(p_N.x(), p_N.y(), 0).normalized();
  }
  turned.reach =
      WithEndpoints(grasp.reach, X_NO * StartPose(grasp.reach), X_NO * GoalPose(grasp.reach));
  turned.reach.motion.weights.leftCols<3>() =
      (grasp.reach.motion.weights.leftCols<3>() * X_NO.linear().transpose()).eval();
  return turned;
}

void TakeContacts(const Grasp& from, Grasp& to) {
  to.rays = from.rays;
  to.clearance = from.clearance;
  to.X_OH = from.X_OH;
  to.X_HG = from.X_HG;
  to.X_HP = from.X_HP;
}

void TakeSprings(const Grasp& from, Grasp& to) {
  to.mass = from.mass;
  to.kc = from.kc;
  to.dc = from.dc;
  to.edges = from.edges;
  to.ambient_damping = from.ambient_damping;
  to.reach_gain = from.reach_gain;
  to.delay = from.delay;
  to.closing = from.closing;
  to.holding = from.holding;
  to.ratio = from.ratio;
  to.max_ratio = from.max_ratio;
  to.switch_rule = from.switch_rule;
  to.t_switch = from.t_switch;
  to.offset = from.offset;
  to.velocity = from.velocity;
  to.opening = from.opening;
  to.opening_bend = from.opening_bend;
  to.bend = from.bend;
  to.lag = from.lag;
  to.scales.x0 = from.scales.x0;
}

PerFinger<Contact> PlateContacts(const Grasp& grasp, const Shape& shape, double tip_radius,
                                 double inset) {
  ThrowUnless(shape.kind == Shape::Kind::kBox && grasp.shape.kind == Shape::Kind::kBox,
              "{}: contacts of a plate on {} instead of a box", grasp.name,
              FormatShape(shape.kind == Shape::Kind::kBox ? grasp.shape : shape));
  Eigen::Index thin = 0, longest = 0;
  shape.size.minCoeff(&thin);
  shape.size.maxCoeff(&longest);
  const PerFinger<Contact> learned = ContactsOn(grasp, grasp.shape, grasp.tip_radius);
  Eigen::Vector3d others = Eigen::Vector3d::Zero();
  double count = 0;
  for (int i = kIndex; i < kNumFingers; ++i) {
    if (!grasp.involved[i]) continue;
    others += learned[i].p_OC;
    ++count;
  }
  others /= std::max(1.0, count);
  const double side = learned[kThumb].p_OC[thin] >= others[thin] ? 1 : -1;
  // Opposite each other.
  Eigen::Vector3d middle = 0.5 * (learned[kThumb].p_OC + others);
  middle = middle.cwiseProduct(shape.size.cwiseQuotient(grasp.shape.size));
  for (int k = 0; k < 3; ++k) {
    const double room = std::max(0.0, shape.size[k] / 2 - inset);
    middle[k] = std::clamp(middle[k], -room, room);
    if (k == longest) middle[k] = grasp.X_OH.translation()[k] < 0 ? -room : room;
  }
  PerFinger<Contact> contacts;
  for (int i = 0; i < kNumFingers; ++i) {
    if (!grasp.involved[i]) continue;
    contacts[i].n_O = (i == kThumb ? side : -side) * Eigen::Vector3d::Unit(thin);
    contacts[i].p_OC = middle;
    contacts[i].p_OC[thin] = contacts[i].n_O[thin] * (shape.size[thin] / 2 + tip_radius);
  }
  return contacts;
}

}  // namespace springgrasp
