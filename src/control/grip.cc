#include "control/grip.h"

#include <algorithm>

namespace springgrasp {

HandVector FingertipGripTorque(const KinematicTree& hand, const PerFinger<int>& tip_frames,
                               const HandVector& q, const FingertipGrip& grip) {
  std::vector<Pose> X_HB;
  ForwardKinematics(hand, q, X_HB);
  PerFinger<Eigen::Vector3d> p_HF;
  Eigen::Vector3d virtual_finger = Eigen::Vector3d::Zero();
  int count = 0;
  for (int f = 0; f < kNumFingers; ++f) {
    p_HF[f] = FramePose(hand, X_HB, tip_frames[f]).translation();
    if (f == kThumb || !grip.involved[f]) continue;
    virtual_finger += p_HF[f];
    ++count;
  }
  HandVector torque = HandVector::Zero(q.size());
  if (count == 0) return torque;
  virtual_finger /= count;
  const Eigen::Vector3d axis = (virtual_finger - p_HF[kThumb]).normalized();
  Eigen::MatrixXd J(6, hand.num_joints());
  for (int f = 0; f < kNumFingers; ++f) {
    if (!grip.involved[f]) continue;
    const Eigen::Vector3d force = f == kThumb ? Eigen::Vector3d(grip.force * axis)
                                              : Eigen::Vector3d(-grip.force / count * axis);
    FrameJacobian(hand, X_HB, tip_frames[f], J);
    torque += J.topRows<3>().transpose() * force;
  }
  return torque;
}

HandVector EnclosingGripTorque(const EnclosingGrip& grip, int num_joints) {
  HandVector torque = HandVector::Zero(num_joints);
  torque[0] = grip.palm;
  for (int f = 0; f < kNumFingers; ++f) {
    if (!grip.involved[f]) continue;
    torque[1 + 2 * f] = grip.proximal;
    torque[2 + 2 * f] = f == kThumb ? grip.thumb_distal : grip.distal;
  }
  return torque;
}

double GripForceFor(double mass, double friction, double acceleration, double safety,
                    double max_force) {
  constexpr double kGravity = 9.81;
  return std::min(max_force, safety * mass * (kGravity + acceleration) / (2 * friction));
}

}  // namespace springgrasp
