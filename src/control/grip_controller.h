// The hand from its reach to the held object: follows the planned angles, recognises by pressure
// and angle where each finger touches, presses once the opposed fingers do with a chosen force, or
// what its valves can give, holds its posture across the grip from there on, and regrips when pads
// come closer together than they were (enclosing: curl in faster than fingers that settle), which
// the object only lets them if it slips. At the fingertips the force is held by what is sensed of
// it.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "control/contact_sense.h"
#include "control/grip.h"
#include "control/pneumatic_hand.h"

namespace springgrasp {

// A gripping hand is stiffer than a moving one: the closed chain damps it (tuned with the grasps of
// experiments/four_grasps, seeds below 1000), the less the later (s) its sensors are.
inline PneumaticGains StiffHold(double sensing_delay = 0) {
  const double prompt = 1 / (1 + sensing_delay / 0.008);
  PneumaticGains gains;
  gains.stiffness = 2.0 * prompt;
  gains.integral = 2.0 * prompt;
  gains.damping = 0.1 * prompt;
  gains.lead = 4.0 * prompt;
  gains.max_integral = 0.25;
  gains.integral_leak = 1.5;
  return gains;
}

// Tuned with experiments/grip, seeds 1 and 11.
struct GripSettings {
  PneumaticGains moving;
  ContactSettings contact;
  double closing_rate = 0.6;        // rad/s, of a finger that did not touch where it was planned to
  double max_closing = 0.25;        // rad beyond the plan
  double patience = 0.5;            // s, for all fingers to touch; then they press anyhow
  double ease = 0.4;                // s, from the full force to none
  double ramp = 0.5;                // s, to the full force
  double settle = 0.4;              // s after that until the posture is held
  double force_integral = 3;        // 1/s, of the sensed force's error
  double max_correction = 0.4;      // of the force
  double bearable = 0.95;           // of the force that the valves can give, asked for at most
  double near_stop = 0.45;          // rad, that a joint may give way to its stop instead
  double regrip_distance = 0.0015;  // m, that thumb and fingers come closer when the object slips
  double enclosing_regrip_distance = 0.003;  // m, that the fingers' pads come nearer to their bases
  double settling = 0.3;                     // s, within that time
  double regrip_factor = 1.3;                // on the force
  double regrip_pause = 0.15;                // s
};

inline PerFinger<Eigen::Vector3d> NoDirections() {
  PerFinger<Eigen::Vector3d> none;
  none.fill(Eigen::Vector3d::Zero());
  return none;
}

struct GripTask {
  bool enclosing = false;
  PerFinger<bool> involved = {};
  // Lateral: where the thumb pushes in H, unit. The other involved fingers keep their planned
  // posture; their sides withstand it.
  std::optional<Eigen::Vector3d> push_H;
  // Fingertip grips: where each involved pad is believed to push, unit, in H; zero: along the
  // grip's axis, from the thumb to the mean of the others and back.
  PerFinger<Eigen::Vector3d> pushes_H = NoDirections();
  double force = 3;      // N, of the thumb
  double max_force = 5;  // N, of any finger
};

enum class GripStage { kFree, kClosing, kPressing, kReleasing };

class GripController {
 public:
  // `hand` (root H) must outlive this; frames of the pads by index.
  GripController(const PneumaticHandModel& model, const KinematicTree& hand,
                 const PerFinger<int>& tip_frames, const GripTask& task,
                 const GripSettings& settings = {});

  // Valve commands (bar). Allocates in its first call only. `reference`: what the plan wants of the
  // joints now. Stage kFree: nothing is near; kClosing: fingers stop where they touch; kPressing:
  // they grip; kReleasing: their force goes to zero, then they follow the
  // reference whatever they touch.
  ValveVector Control(const RobotState& state, const HandTarget& reference, GripStage stage,
                      double dt);

  bool pressing() const { return pressing_; }
  bool held() const { return held_; }
  int regrips() const { return regrips_; }
  const PerFinger<bool>& touching() const { return sense_.touching; }
  // Asked for, and as the robot feels it where each pad pushes, in the last call; N.
  const PerFinger<double>& target_force() const { return target_force_; }
  PerFinger<double> SensedForce() const;

 private:
  // Whether a finger closes and presses.
  bool Presses(int finger) const {
    return task_.involved[finger] && (!task_.push_H || finger == kThumb);
  }
  // One of the two joints of a finger that bend it.
  bool IsFingerJoint(int joint) const { return joint != 0 && joint != model_.layout.opposition; }
  // Whether a joint has part in the grip: its valve presses instead of following the plan.
  bool Grips(int joint) const {
    if (joint == 0) return !task_.push_H;
    return Presses(IsFingerJoint(joint) ? (joint - 1) / 2 : int{kThumb});
  }
  GripTorque TorqueOf(double force) const;
  double BearableForce(const RobotState& state) const;
  bool AtFullPressure(const RobotState& state) const;
  void Press(const RobotState& state, double dt, HandTarget& target);
  void WatchSlip(const RobotState& state, double dt);
  void CloseOn(const HandTarget& plan, bool all, double dt);
  double Aperture() const;

  const PneumaticHandModel model_;
  const KinematicTree& hand_;
  const PerFinger<int> tip_frames_;
  const GripTask task_;
  const GripSettings settings_;
  PerFinger<int> knuckles_ = {};  // bodies that the proximal joints turn
  std::vector<Pose> X_HB_;        // at the posture of the last call
  HandVector q_;                  // rad, that posture
  HandControlState memory_;
  ContactSense sense_;
  HandVector touched_;                           // rad, where each touching finger stopped
  HandVector reference_;                         // rad, posture that is held
  double waited_ = 0, pressed_ = 0, eased_ = 0;  // s
  PerFinger<double> closing_ = {};               // rad beyond the plan
  PerFinger<bool> planned_closing_ = {};         // moved by the plan since the hand is there
  bool pressing_ = false, held_ = false;
  double correction_ = 0;                                      // N
  double bearable_ = std::numeric_limits<double>::infinity();  // N
  PerFinger<double> share_ = {1, 1, 1, 1, 1};
  double force_scale_ = 1, aperture_ = 0, since_regrip_ = 0;
  int regrips_ = 0;
  PerFinger<double> target_force_ = {};
};

}  // namespace springgrasp
