#include "control/contact_sense.h"

#include <Eigen/LU>
#include <algorithm>

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

PerFinger<double> PadForcesAlong(const HandLayout& layout, const KinematicTree& hand,
                                 const PerFinger<int>& tip_frames, const std::vector<Pose>& X_HB,
                                 const ValveVector& torque, const Eigen::Vector3d& axis_H) {
  constexpr double kSingular = 3e-5;  // m^2: a straight finger feels nothing along itself
  Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, kMaxHandJoints> J(6, hand.num_joints());
  PerFinger<double> force;
  for (int f = 0; f < kNumFingers; ++f) {
    FrameJacobian(hand, X_HB, tip_frames[f], J);
    const int j = 1 + 2 * f;
    const Eigen::Matrix<double, 3, 2> Jf = J.block<3, 2>(0, j);
    const Eigen::Matrix2d JtJ = Jf.transpose() * Jf + kSingular * Eigen::Matrix2d::Identity();
    const Eigen::Vector2d along = Jf.transpose() * axis_H;
    const Eigen::Vector2d w = JtJ.inverse() * along;
    const Eigen::Vector2d both(torque[layout.valve_of_joint[j]],
                               torque[layout.valve_of_joint[j + 1]]);
    const double felt = w.dot(along);
    force[f] = felt > 1e-6 ? w.dot(both) / felt : 0;
  }
  return force;
}

}  // namespace springgrasp
