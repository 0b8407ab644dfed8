// Contact requests as the chain makes them, for tests.
#pragma once

#include <string>

#include "kinematics/contact_posture.h"
#include "kinematics/shape_distance.h"
#include "real_models.h"

namespace springgrasp {

// A contact of a ray from `p_O` along `direction` with the shape, tip centre `radius` outside.
inline void PlaceContact(const Shape& shape, const Eigen::Vector3d& p_O,
                         const Eigen::Vector3d& direction, double radius, Eigen::Vector3d& p_OC,
                         Eigen::Vector3d& n_OC) {
  double inside = 0, outside = 1;
  for (int i = 0; i < 60; ++i) {
    const double s = 0.5 * (inside + outside);
    (SignedDistance(shape, p_O + s * direction.normalized()) < radius ? inside : outside) = s;
  }
  p_OC = p_O + outside * direction.normalized();
  SignedDistance(shape, p_OC, &n_OC);
}

// A grasp of an upright object: thumb from -x of O, fingers from +x, wrist towards `wrist_O`
// (power: the palm looks along -wrist_O, the thumb side is up).
inline ContactRequest MakeRequest(const std::string& type, const Shape& shape,
                                  const Eigen::Vector3d& wrist_O, double skew = 0) {
  ContactRequest request;
  request.type = type;
  request.shape = shape;
  request.involved[kThumb] = request.involved[kIndex] = true;
  if (type == "tripod" || type == "power") request.involved[kMiddle] = true;
  if (type == "power") request.involved[kRing] = request.involved[kPinkie] = true;
  const RobotHand& hand = TestRobotHand();
  for (int f = 0; f < kNumFingers; ++f) {
    const double side = f == kThumb ? -1 : 1;
    const Eigen::Vector3d along = Eigen::Vector3d(wrist_O.cross(Eigen::Vector3d::UnitX()));
    const double offset = !request.involved[f] || f == kThumb ? 0
                          : type == "tripod"                  ? (f == kIndex ? 0.012 : -0.012)
                          : type == "power"                   ? 0.02 * (2.5 - f)
                                                              : 0;
    PlaceContact(shape, offset * along + Eigen::Vector3d(0, 0, skew * side),
                 Eigen::Vector3d(side, 0, 0), hand.tip_radius, request.p_OC[f], request.n_OC[f]);
  }
  request.X_OG.linear() = FrameFromXZ(Eigen::Vector3d::UnitX(), wrist_O);
  request.X_OH_human = request.X_OG;
  if (type == "power") {
    // Palm over the object: H's z looks away from it, the fingers point to +x and wrap.
    request.X_OH_human.linear() = FrameFromXZ(Eigen::Vector3d::UnitX(), wrist_O);
  }
  request.X_OH_human.translation() = 0.12 * wrist_O;
  const HumanHand& human = TestHumanHand();
  request.human = TargetFromHuman(human, human.rest, hand);
  return request;
}

// A pinch of a box that stood turned by `angle` (rad) about z when it was demonstrated: the frame
// that was learned does not lie along the contacts.
inline ContactRequest MakeTurnedPinch(const Shape& shape, double angle) {
  ContactRequest request = MakeRequest("pinch", shape, {0, -0.5, 0.8});
  request.X_OG.linear() =
      Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix() * request.X_OG.linear();
  return request;
}

}  // namespace springgrasp
