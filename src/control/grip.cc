#include "control/grip.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace springgrasp {
namespace {

struct Pads {
  PerFinger<Eigen::Vector3d> p_HF;
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();  // thumb to virtual finger, unit
  int opposed = 0;                                 // fingers
};

Pads PadsAt(const KinematicTree& hand, const PerFinger<int>& tip_frames,
            const std::vector<Pose>& X_HB, const PerFinger<bool>& involved) {
  Pads pads;
  Eigen::Vector3d virtual_finger = Eigen::Vector3d::Zero();
  for (int f = 0; f < kNumFingers; ++f) {
    pads.p_HF[f] = FramePose(hand, X_HB, tip_frames[f]).translation();
    if (f == kThumb || !involved[f]) continue;
    virtual_finger += pads.p_HF[f];
    ++pads.opposed;
  }
  if (pads.opposed > 0) {
    pads.axis = (virtual_finger / pads.opposed - pads.p_HF[kThumb]).normalized();
  }
  return pads;
}

}  // namespace

GripTorque FingertipGripTorque(const KinematicTree& hand, const PerFinger<int>& tip_frames,
                               const std::vector<Pose>& X_HB, const FingertipGrip& grip) {
  GripTorque result;
  result.torque = HandVector::Zero(hand.num_joints());
  const Pads pads = PadsAt(hand, tip_frames, X_HB, grip.involved);
  if (pads.opposed == 0) return result;
  double shares = 0;
  for (int f = kIndex; f < kNumFingers; ++f) shares += grip.involved[f] ? grip.share[f] : 0;
  HandJacobian J(6, hand.num_joints());
  for (int f = 0; f < kNumFingers; ++f) {
    if (!grip.involved[f]) continue;
    const bool thumb = f == kThumb;
    result.force[f] = thumb ? grip.force : grip.force / pads.opposed;
    const double pressed = thumb ? grip.force : -grip.force * grip.share[f] / shares;
    FrameJacobian(hand, X_HB, tip_frames[f], J);
    result.torque += J.topRows<3>().transpose() * (pressed * pads.axis);
  }
  return result;
}

GripTorque KeyGripTorque(const KinematicTree& hand, const PerFinger<int>& tip_frames,
                         const std::vector<Pose>& X_HB, const Eigen::Vector3d& push_H,
                         double force) {
  HandJacobian J(6, hand.num_joints());
  FrameJacobian(hand, X_HB, tip_frames[kThumb], J);
  GripTorque result;
  result.torque.noalias() = J.topRows<3>().transpose() * (force * push_H);
  result.force[kThumb] = force;
  return result;
}

HandDirections ClosingDirections(const KinematicTree& hand, const PerFinger<int>& tip_frames,
                                 const std::vector<Pose>& X_HB, const PerFinger<bool>& involved) {
  const Pads pads = PadsAt(hand, tip_frames, X_HB, involved);
  HandDirections directions(hand.num_joints(), 0);
  HandJacobian thumb(6, hand.num_joints()), finger(6, hand.num_joints());
  FrameJacobian(hand, X_HB, tip_frames[kThumb], thumb);
  for (int f = kIndex; f < kNumFingers; ++f) {
    if (!involved[f]) continue;
    FrameJacobian(hand, X_HB, tip_frames[f], finger);
    HandVector d = (thumb - finger).topRows<3>().transpose() * pads.axis;
    for (int k = 0; k < directions.cols(); ++k) {
      d -= directions.col(k).dot(d) * directions.col(k);
    }
    const double norm = d.norm();
    if (norm < 1e-9) continue;
    directions.conservativeResize(Eigen::NoChange, directions.cols() + 1);
    directions.rightCols<1>() = d / norm;
  }
  return directions;
}

GripTorque EnclosingGripTorque(const KinematicTree& hand, const PerFinger<int>& tip_frames,
                               const std::vector<Pose>& X_HB, const EnclosingGrip& grip) {
  GripTorque result;
  result.torque = HandVector::Zero(hand.num_joints());
  HandJacobian J(6, hand.num_joints());
  // Force per torque of each finger's last joint: one over the pad's distance from its axis.
  PerFinger<double> force_per_torque = {};
  double sum = 0;
  for (int f = kIndex; f < kNumFingers; ++f) {
    if (!grip.involved[f]) continue;
    FrameJacobian(hand, X_HB, tip_frames[f], J);
    force_per_torque[f] = 1 / J.block<3, 1>(0, 2 + 2 * f).norm();
    sum += force_per_torque[f];
  }
  if (sum == 0) return result;
  const double distal = grip.force / sum;
  result.torque[0] = grip.palm * distal;
  for (int f = 0; f < kNumFingers; ++f) {
    if (!grip.involved[f]) continue;
    const bool thumb = f == kThumb;
    result.torque[1 + 2 * f] = (thumb ? grip.thumb_proximal : grip.proximal) * distal;
    result.torque[2 + 2 * f] = (thumb ? grip.thumb_distal : 1) * distal;
    result.force[f] = thumb ? grip.force : force_per_torque[f] * distal;
  }
  return result;
}

double GripForceFor(double mass, double friction, double acceleration, double safety,
                    double max_force) {
  constexpr double kGravity = 9.81;
  return std::min(max_force, safety * mass * (kGravity + acceleration) / (2 * friction));
}

}  // namespace springgrasp
