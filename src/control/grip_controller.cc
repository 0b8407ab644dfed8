#include "control/grip_controller.h"

#include <algorithm>
#include <cmath>

namespace springgrasp {
namespace {

constexpr double kLeastForce = 0.5;  // N, pressed with whatever the valves can give
constexpr double kFull = 0.99;       // of the supply's pressure

}  // namespace

GripController::GripController(const PneumaticHandModel& model, const KinematicTree& hand,
                               const PerFinger<int>& tip_frames, const GripTask& task,
                               const GripSettings& settings)
    : model_(model), hand_(hand), tip_frames_(tip_frames), task_(task), settings_(settings) {
  X_HB_.reserve(hand.nodes.size());
  for (int f = 0; f < kNumFingers; ++f) {
    for (std::size_t node = 0; node < hand.nodes.size(); ++node) {
      if (hand.nodes[node].joint == 1 + 2 * f) knuckles_[f] = static_cast<int>(node);
    }
  }
}

ValveVector GripController::Control(const RobotState& state, const HandTarget& reference,
                                    GripStage stage, double dt) {
  q_ = state.hand_q;
  ForwardKinematics(hand_, q_, X_HB_);
  const PerFinger<bool> touched = sense_.touching;
  SenseContacts(model_, settings_.contact, state, stage == GripStage::kFree, dt, sense_);
  HandTarget target = reference;
  if (target.qd.size() == 0) target.qd = HandVector::Zero(target.q.size());
  if (target.qdd.size() == 0) target.qdd = HandVector::Zero(target.q.size());
  if (touched_.size() == 0) touched_ = state.hand_q;
  if (stage == GripStage::kReleasing) eased_ += dt;
  if (stage == GripStage::kReleasing && eased_ > settings_.ease) {
    pressing_ = held_ = false;
    target_force_ = {};
    return ControlHand(model_, settings_.moving, target, state, dt, memory_);
  }
  if (stage == GripStage::kPressing && !pressing_) {
    bool all = true;
    for (int f = 0; f < kNumFingers; ++f) all = all && (!Presses(f) || sense_.touching[f]);
    waited_ += dt;
    if (all || waited_ > settings_.patience) {
      pressing_ = true;
      reference_ = state.hand_q;
      if (!task_.enclosing) bearable_ = BearableForce(state);
      // What wound up on the way is not wanted.
      for (int j = 0; j < model_.layout.num_joints(); ++j) {
        if (Grips(j)) memory_.integral[model_.layout.valve_of_joint[j]] = 0;
      }
    } else {
      CloseOn(reference, true, dt);
    }
  }
  if (stage == GripStage::kClosing) CloseOn(reference, false, dt);
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
          target.q[j] += closing_[f];
        }
      }
    }
  }
  if (!pressing_) return ControlHand(model_, settings_.moving, target, state, dt, memory_);
  PneumaticGains gains = StiffHold(target.sensing_delay);
  // Fingers that yield to the object settle on it the sooner the less they are damped.
  if (task_.enclosing) gains.damping = settings_.moving.damping;
  return ControlHand(model_, gains, target, state, dt, memory_);
}

// Fingers that did not touch where they were planned to go on, as long as the plan moves none of
// their joints; before `all` must, only those that the plan has moved.
void GripController::CloseOn(const HandTarget& plan, bool all, double dt) {
  constexpr double kMoving = 0.02;  // rad/s
  for (int f = 0; f < kNumFingers; ++f) {
    const bool moves = plan.qd.size() > 0 && (std::abs(plan.qd[1 + 2 * f]) > kMoving ||
                                              std::abs(plan.qd[2 + 2 * f]) > kMoving);
    planned_closing_[f] = planned_closing_[f] || moves;
    if (moves || !(all || planned_closing_[f]) || sense_.touching[f]) continue;
    closing_[f] = std::min(settings_.max_closing, closing_[f] + settings_.closing_rate * dt);
  }
}

void GripController::Press(const RobotState& state, double dt, HandTarget& target) {
  pressed_ += dt;
  const double ramp = std::min(1.0, pressed_ / settings_.ramp);
  const double ease = std::max(0.01, 1 - eased_ / settings_.ease);
  const double force =
      ease * ramp * std::min({task_.max_force, bearable_, force_scale_ * task_.force});
  if (!held_ && pressed_ > settings_.ramp + settings_.settle) {
    held_ = true;
    reference_ = state.hand_q;  // joints may have given way to their stops
    aperture_ = Aperture();
  }
  if (held_ && eased_ == 0) WatchSlip(state, dt);

  HandVector posture = reference_ - state.hand_q;
  GripTorque grip;
  if (task_.enclosing) {
    grip = EnclosingGripTorque(hand_, tip_frames_, X_HB_, {task_.involved, force});
  } else {
    const PerFinger<double> sensed = SensedForce();
    double both = 0;
    for (const double n : sensed) both += n / 2;
    if (task_.push_H) both = sensed[kThumb];
    const double limit = settings_.max_correction * force;
    // Where a valve gives all it has, more would only bend the other joints.
    const double missing = AtFullPressure(state) ? std::min(0.0, force - both) : force - both;
    correction_ = std::clamp(correction_ + settings_.force_integral * missing * dt, -limit, limit);
    int opposed = 0;
    for (int f = kIndex; f < kNumFingers; ++f) opposed += task_.involved[f];
    const double even = (2 * both - sensed[kThumb]) / std::max(1, opposed);
    for (int f = kIndex; f < kNumFingers && held_ && !task_.push_H; ++f) {
      if (!task_.involved[f]) continue;
      share_[f] = std::clamp(
          share_[f] + settings_.force_integral * (even - sensed[f]) / force * opposed * dt,
          1 - settings_.max_correction, 1 + settings_.max_correction);
    }
    grip = TorqueOf(force + correction_);
    for (double& n : grip.force) n *= force / (force + correction_);
    if (!task_.push_H) {
      // Along these the force decides, the posture in all others.
      const HandDirections closing = ClosingDirections(hand_, tip_frames_, X_HB_, task_.involved);
      for (int k = 0; k < closing.cols(); ++k) {
        posture -= closing.col(k).dot(posture) * closing.col(k);
      }
    }
  }
  target_force_ = grip.force;
  target.torque = grip.torque;
  target.offset = sense_.offset;  // what the model errs by, known from the free hand
  for (int j = 0; j < model_.layout.num_joints(); ++j) {
    if (!Grips(j)) continue;
    target.pressing[model_.layout.valve_of_joint[j]] = true;
    // Fingers that enclose yield to the object's shape, the thumb of a key grip bends as its one
    // valve makes it: no stiffness about any posture.
    const bool yields = (task_.enclosing || task_.push_H) && IsFingerJoint(j);
    target.q[j] = state.hand_q[j] + (yields ? 0 : posture[j]);
  }
}

GripTorque GripController::TorqueOf(double force) const {
  return task_.push_H
             ? KeyGripTorque(hand_, tip_frames_, X_HB_, *task_.push_H, force)
             : FingertipGripTorque(hand_, tip_frames_, X_HB_, {task_.involved, force, share_});
}

// Whether a valve whose joints no stop helps gives all it has.
bool GripController::AtFullPressure(const RobotState& state) const {
  const ValveVector q = MeanOfValves(model_.layout, state.hand_q);
  for (int j = 0; j < model_.layout.num_joints(); ++j) {
    const int v = model_.layout.valve_of_joint[j];
    if (Grips(j) && q[v] - model_.lower[v] >= settings_.near_stop &&
        state.pressure[v] > kFull * kMaxPressureBar) {
      return true;
    }
  }
  return false;
}

// What the valves can give at this posture, less what the force's controller may add. A joint that
// is near enough gives way to its stop, which bears more than any valve.
double GripController::BearableForce(const RobotState& state) const {
  const ValveVector q = MeanOfValves(model_.layout, state.hand_q);
  const ValveVector per_newton = MeanOfValves(model_.layout, TorqueOf(1).torque);
  ValveVector most = kMaxPressureBar * model_.torque_per_bar - sense_.offset -
                     model_.return_stiffness.cwiseProduct(q - model_.return_rest);
  if (state.hand_bias.size() > 0) {
    most -= model_.gravity * MeanOfValves(model_.layout, state.hand_bias);
  }
  double force = task_.max_force;
  for (int v = 0; v < kNumValves; ++v) {
    if (q[v] - model_.lower[v] < settings_.near_stop) continue;
    if (per_newton[v] > 0) force = std::min(force, settings_.bearable * most[v] / per_newton[v]);
  }
  return std::max(force, kLeastForce);
}

void GripController::WatchSlip(const RobotState& state, double dt) {
  since_regrip_ += dt;
  const double aperture = Aperture();
  // Fingers that enclose an object settle on it for long: only what is faster counts.
  if (task_.enclosing) aperture_ += dt / (settings_.settling + dt) * (aperture - aperture_);
  const double distance =
      task_.enclosing ? settings_.enclosing_regrip_distance : settings_.regrip_distance;
  if (since_regrip_ < settings_.regrip_pause) {
    if (task_.enclosing) aperture_ = aperture;
    return;
  }
  if (aperture_ - aperture < distance) return;
  force_scale_ *= settings_.regrip_factor;
  aperture_ = aperture;
  reference_ = state.hand_q;
  since_regrip_ = 0;
  ++regrips_;
}

double GripController::Aperture() const {
  Eigen::Vector3d others = Eigen::Vector3d::Zero(), knuckles = Eigen::Vector3d::Zero();
  int count = 0;
  for (int f = kIndex; f < kNumFingers; ++f) {
    if (!task_.involved[f]) continue;
    others += FramePose(hand_, X_HB_, tip_frames_[f]).translation();
    knuckles += X_HB_[knuckles_[f]].translation();
    ++count;
  }
  const Eigen::Vector3d against =
      task_.enclosing ? Eigen::Vector3d(knuckles / std::max(1, count))
                      : Eigen::Vector3d(FramePose(hand_, X_HB_, tip_frames_[kThumb]).translation());
  return (others / std::max(1, count) - against).norm();
}

PerFinger<double> GripController::SensedForce() const {
  PerFinger<double> sensed{};
  if (X_HB_.empty()) return sensed;
  Eigen::Vector3d others = Eigen::Vector3d::Zero();
  int count = 0;
  for (int f = kIndex; f < kNumFingers; ++f) {
    if (!task_.involved[f]) continue;
    others += FramePose(hand_, X_HB_, tip_frames_[f]).translation();
    ++count;
  }
  const Eigen::Vector3d p_thumb = FramePose(hand_, X_HB_, tip_frames_[kThumb]).translation();
  const Eigen::Vector3d axis = (others / std::max(1, count) - p_thumb).normalized();
  PerFinger<Eigen::Vector3d> pushes = task_.pushes_H;
  for (int f = 0; f < kNumFingers; ++f) {
    if (task_.push_H) pushes[f] = *task_.push_H;
    if (pushes[f].isZero()) pushes[f] = f == kThumb ? axis : Eigen::Vector3d(-axis);
  }
  sensed = PadForcesAlong(model_, hand_, tip_frames_, X_HB_, q_, sense_.torque, pushes);
  for (int f = 0; f < kNumFingers; ++f) {
    if (!Presses(f)) sensed[f] = 0;
  }
  if (task_.push_H) {
    if (std::isnan(sensed[kThumb])) sensed[kThumb] = target_force_[kThumb];
    return sensed;
  }
  return BalancedForces(sensed, task_.involved, target_force_);
}

}  // namespace springgrasp
