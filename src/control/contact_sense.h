// Touch without touch sensors: the torque that something outside puts on the joints of a valve is
// what pressure and angle leave unexplained by the model of the hand.
//   τ_ext = g p − κ (q − q0) − d q̇ − τ_g,   low-passed; friction and what the model errs by are
// measured while the hand is known to be free and taken off.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/fingers.h"
#include "control/pneumatic_hand.h"
#include "kinematics/kinematic_tree.h"

namespace springgrasp {

struct ContactSettings {
  double torque = 0.03;       // Nm, of the finger's valves that is a contact
  double hold = 0.01;         // s, for so long
  double filter = 0.015;      // s
  double zero_filter = 0.15;  // s, of the offset while free
};

struct ContactSense {
  ValveVector torque = ValveVector::Zero();  // Nm, on each joint of the valve, against flexion
  ValveVector offset = ValveVector::Zero();  // Nm, taken off already
  PerFinger<bool> touching = {};             // once touched, until Release
  PerFinger<double> pressed_for = {};        // s
};

// One reading. `free`: nothing is touched, the offset is learned.
void SenseContacts(const PneumaticHandModel& model, const ContactSettings& settings,
                   const RobotState& state, bool free, double dt, ContactSense& sense);

// Force (N) of each finger's pad along the unit vector `axis_H`, from the sensed torques of a hand
// whose bodies stand at X_HB: the joints feel only its part in the plane in which the finger bends,
// which is taken to be the projection of a force along the axis.
PerFinger<double> PadForcesAlong(const HandLayout& layout, const KinematicTree& hand,
                                 const PerFinger<int>& tip_frames, const std::vector<Pose>& X_HB,
                                 const ValveVector& torque, const Eigen::Vector3d& axis_H);

}  // namespace springgrasp
