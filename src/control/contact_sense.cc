#include "control/contact_sense.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace springgrasp {

void SenseContacts(const PneumaticHandModel& model, const ContactSettings& settings,
                   const RobotState& state, bool free, double dt, ContactSense& sense) {
  const HandLayout& layout = model.layout;
  const ValveVector q = MeanOfValves(layout, state.hand_q);
  const ValveVector qd = MeanOfValves(layout, state.hand_qd);
  ValveVector unexplained = model.torque_per_bar.cwiseProduct(state.pressure) -
                            model.return_stiffness.cwiseProduct(q - model.return_rest) -
                            model.damping.cwiseProduct(qd);
  if (state.hand_bias.size() > 0) {
    unexplained -= model.gravity * MeanOfValves(layout, state.hand_bias);
  }
  sense.torque += dt / (settings.filter + dt) * (unexplained - sense.offset - sense.torque);
  if (free) {
    const ValveVector step = dt / (settings.zero_filter + dt) * sense.torque;
    sense.offset += step;
    sense.torque -= step;
  }
  for (int f = 0; f < kNumFingers; ++f) {
    double most = 0;
    for (const int j : {1 + 2 * f, 2 + 2 * f}) {
      most = std::max(most, sense.torque[layout.valve_of_joint[j]]);
    }
    sense.pressed_for[f] = !free && most > settings.torque ? sense.pressed_for[f] + dt : 0;
    if (sense.pressed_for[f] >= settings.hold) sense.touching[f] = true;
  }
}

PerFinger<double> PadForcesAlong(const PneumaticHandModel& model, const KinematicTree& hand,
                                 const PerFinger<int>& tip_frames, const std::vector<Pose>& X_HB,
                                 const HandVector& q, const ValveVector& torque,
                                 const PerFinger<Eigen::Vector3d>& direction_H) {
  constexpr double kSingular = 3e-5;  // m^2: a straight finger feels nothing along itself
  constexpr double kAtStop = 0.03;    // rad
  constexpr double kFelt = 0.06;      // of a finger's torque, squared, that a lone joint must feel
  const HandLayout& layout = model.layout;
  Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, kMaxHandJoints> J(6, hand.num_joints());
  PerFinger<double> force;
  for (int f = 0; f < kNumFingers; ++f) {
    FrameJacobian(hand, X_HB, tip_frames[f], J);
    const int j = 1 + 2 * f;
    Eigen::Matrix<double, 3, 2> Jf = J.block<3, 2>(0, j);
    bool stopped = false;
    for (int k = 0; k < 2; ++k) {
      const int v = layout.valve_of_joint[j + k];
      if (q[j + k] > model.lower[v] + kAtStop && q[j + k] < model.upper[v] - kAtStop) continue;
      Jf.col(k).setZero();
      stopped = true;
    }
    const Eigen::Vector2d along = Jf.transpose() * direction_H[f];
    if (stopped && along.squaredNorm() <= kFelt * Jf.squaredNorm()) {
      force[f] = std::numeric_limits<double>::quiet_NaN();
      continue;
    }
    const Eigen::Matrix2d JtJ = Jf.transpose() * Jf + kSingular * Eigen::Matrix2d::Identity();
    const Eigen::Vector2d w = JtJ.inverse() * along;
    const Eigen::Vector2d both(torque[layout.valve_of_joint[j]],
                               torque[layout.valve_of_joint[j + 1]]);
    const double felt = w.dot(along);
    force[f] = felt > 1e-6 ? w.dot(both) / felt : 0;
  }
  return force;
}

PerFinger<double> BalancedForces(PerFinger<double> force, const PerFinger<bool>& involved,
                                 const PerFinger<double>& fallback) {
  double opposed = 0;
  int unknown = 0;
  for (int f = kIndex; f < kNumFingers; ++f) {
    if (!involved[f]) continue;
    if (std::isnan(force[f])) {
      ++unknown;
    } else {
      opposed += force[f];
    }
  }
  const bool thumb = !std::isnan(force[kThumb]);
  for (int f = kIndex; f < kNumFingers; ++f) {
    if (!std::isnan(force[f])) continue;
    force[f] = thumb && involved[f] ? (force[kThumb] - opposed) / unknown : fallback[f];
  }
  if (!thumb) force[kThumb] = unknown == 0 ? opposed : fallback[kThumb];
  return force;
}

}  // namespace springgrasp
