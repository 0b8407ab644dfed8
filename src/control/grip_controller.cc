#include "control/grip_controller.h"

#include <algorithm>

namespace springgrasp {

GripController::GripController(const PneumaticHandModel& model, const KinematicTree& hand,
                               const PerFinger<int>& tip_frames, const GripTask& task,
                               const GripSettings& settings)
    : model_(model), hand_(hand), tip_frames_(tip_frames), task_(task), settings_(settings) {}

ValveVector GripController::Control(const RobotState& state, const HandTarget& reference,
                                    GripStage stage, double dt) {
  const PerFinger<bool> touched = sense_.touching;
  SenseContacts(model_, settings_.contact, state, stage == GripStage::kFree, dt, sense_);
  HandTarget target = reference;
  if (target.qd.size() == 0) target.qd = HandVector::Zero(target.q.size());
  if (target.qdd.size() == 0) target.qdd = HandVector::Zero(target.q.size());
  if (touched_.size() == 0) touched_ = state.hand_q;
  if (stage == GripStage::kPressing && !pressing_) {
    bool all = true;
    for (int f = 0; f < kNumFingers; ++f) all = all && (!Presses(f) || sense_.touching[f]);
    waited_ += dt;
    if (all || waited_ > settings_.patience) {
      pressing_ = true;
      reference_ = state.hand_q;
      // What wound up on the way is not wanted.
      for (int f = 0; f < kNumFingers; ++f) {
        if (!Presses(f)) continue;
        for (const int j : {1 + 2 * f, 2 + 2 * f}) {
          memory_.integral[model_.layout.valve_of_joint[j]] = 0;
        }
      }
    } else {
      closing_ = std::min(settings_.max_closing, closing_ + settings_.closing_rate * dt);
    }
  }
  if (pressing_) {
    Press(state, dt, target);
  } else {
    for (int f = 0; f < kNumFingers; ++f) {
      if (!Presses(f)) continue;
      for (const int j : {1 + 2 * f, 2 + 2 * f}) {
        if (sense_.touching[f]) {
          if (!touched[f]) touched_[j] = state.hand_q[j];
          target.q[j] = touched_[j];
          target.qd[j] = target.qdd[j] = 0;
        } else {
          target.q[j] += closing_;
        }
      }
    }
  }
  return ControlHand(model_, held_ ? settings_.holding : settings_.moving, target, state, dt,
                     memory_);
}

void GripController::Press(const RobotState& state, double dt, HandTarget& target) {
  pressed_ += dt;
  const double ramp = std::min(1.0, pressed_ / settings_.ramp);
  const double force = ramp * std::min(task_.max_force, force_scale_ * task_.force);
  if (!held_ && pressed_ > settings_.ramp + settings_.settle) {
    held_ = true;
    reference_ = state.hand_q;
    aperture_ = Aperture(state.hand_q);
  }
  if (held_) WatchSlip(state, dt);

  HandVector posture = reference_ - state.hand_q;
  GripTorque grip;
  if (task_.enclosing) {
    grip = EnclosingGripTorque(hand_, tip_frames_, state.hand_q, {task_.involved, force});
  } else {
    const PerFinger<double> sensed = SensedForce(state);
    double both = 0;
    for (const double n : sensed) both += n / 2;
    if (task_.push_H) both = sensed[kThumb];
    const double limit = settings_.max_correction * force;
    correction_ =
        std::clamp(correction_ + settings_.force_integral * (force - both) * dt, -limit, limit);
    int opposed = 0;
    for (int f = kIndex; f < kNumFingers; ++f) opposed += task_.involved[f];
    const double even = (2 * both - sensed[kThumb]) / std::max(1, opposed);
    for (int f = kIndex; f < kNumFingers && held_ && !task_.push_H; ++f) {
      if (!task_.involved[f]) continue;
      share_[f] = std::clamp(
          share_[f] + settings_.force_integral * (even - sensed[f]) / force * opposed * dt,
          1 - settings_.max_correction, 1 + settings_.max_correction);
    }
    grip = task_.push_H
               ? KeyGripTorque(hand_, tip_frames_, state.hand_q, *task_.push_H, force + correction_)
               : FingertipGripTorque(hand_, tip_frames_, state.hand_q,
                                     {task_.involved, force + correction_, share_});
    for (double& n : grip.force) n *= force / (force + correction_);
    // Along these the force decides, the posture in all others.
    const Eigen::MatrixXd closing =
        ClosingDirections(hand_, tip_frames_, state.hand_q, task_.involved);
    posture -= closing * (closing.transpose() * posture);
    if (task_.push_H) posture.setZero();
  }
  target_force_ = grip.force;
  target.torque = grip.torque;
  target.offset = sense_.offset;  // what the model errs by, known from the free hand
  target.integrate = held_;
  for (int f = 0; f < kNumFingers; ++f) {
    if (!Presses(f)) continue;
    for (const int j : {1 + 2 * f, 2 + 2 * f}) {
      target.pressing[model_.layout.valve_of_joint[j]] = true;
      // Enclosing fingers yield to the object's shape: no stiffness about any posture.
      target.q[j] = state.hand_q[j] + (task_.enclosing ? 0 : posture[j]);
    }
  }
  if (task_.enclosing) {
    target.pressing[model_.layout.valve_of_joint[0]] = true;
    target.q[0] = reference_[0];
  }
}

void GripController::WatchSlip(const RobotState& state, double dt) {
  since_regrip_ += dt;
  const double aperture = Aperture(state.hand_q);
  // Fingers that enclose an object come closer while they settle.
  const double distance = (task_.enclosing ? 6 : 1) * settings_.regrip_distance;
  if (aperture_ - aperture < distance || since_regrip_ < settings_.regrip_pause) {
    return;
  }
  force_scale_ *= settings_.regrip_factor;
  aperture_ = aperture;
  reference_ = state.hand_q;
  since_regrip_ = 0;
  ++regrips_;
}

double GripController::Aperture(const HandVector& q) const {
  std::vector<Pose> X_HB;
  ForwardKinematics(hand_, q, X_HB);
  Eigen::Vector3d others = Eigen::Vector3d::Zero();
  int count = 0;
  for (int f = kIndex; f < kNumFingers; ++f) {
    if (!task_.involved[f]) continue;
    others += FramePose(hand_, X_HB, tip_frames_[f]).translation();
    ++count;
  }
  return (others / std::max(1, count) - FramePose(hand_, X_HB, tip_frames_[kThumb]).translation())
      .norm();
}

PerFinger<double> GripController::SensedForce(const RobotState& state) const {
  std::vector<Pose> X_HB;
  ForwardKinematics(hand_, state.hand_q, X_HB);
  PerFinger<Eigen::Vector3d> p;
  Eigen::Vector3d others = Eigen::Vector3d::Zero();
  int count = 0;
  for (int f = 0; f < kNumFingers; ++f) {
    p[f] = FramePose(hand_, X_HB, tip_frames_[f]).translation();
    if (f == kThumb || !task_.involved[f]) continue;
    others += p[f];
    ++count;
  }
  Eigen::Vector3d axis = (others / std::max(1, count) - p[kThumb]).normalized();
  if (task_.push_H) axis = *task_.push_H;
  PerFinger<double> sensed =
      PadForcesAlong(model_.layout, hand_, tip_frames_, state.hand_q, sense_.torque, axis);
  for (int f = 0; f < kNumFingers; ++f) {
    if (!Presses(f)) sensed[f] = 0;
    if (f != kThumb) sensed[f] = -sensed[f];
  }
  return sensed;
}

}  // namespace springgrasp
