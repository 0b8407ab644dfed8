// PERFORM: one planned grasp in physics, phase by phase.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "control/arm_controller.h"
#include "control/pneumatic_hand.h"
#include "experiment/contact_window.h"
#include "experiment/grasp_plan.h"
#include "experiment/phases.h"
#include "experiment/verdict.h"
#include "kinematics/kinematic_tree.h"
#include "sim/pneumatics.h"
#include "sim/robot_io.h"
#include "sim/simulation.h"

namespace springgrasp {

// A gripping hand is stiffer than a moving one: the closed chain damps it (tuned with the first
// grasps, seeds below 1000).
inline PneumaticGains StiffHold() {
  PneumaticGains gains;
  gains.stiffness = 1.0;
  gains.integral = 2.0;
  gains.damping = 0.04;
  gains.max_integral = 0.25;
  return gains;
}

struct GripOptions {
  double acceleration = 20;         // m/s^2, that the grip shall withstand besides gravity
  double safety = 2.5;              // of the fingertip grip force
  double min_force = 2.5;           // N
  double enclosing_pressure = 3.0;  // bar, of the involved fingers in a power grasp
  double thumb_distal_ratio = 0.3;
  double distal_ratio = 0.8;          // distal over proximal pressure in a power grasp
  PneumaticGains hand = StiffHold();  // once the grip has settled
  double ramp = 0.6;                  // s, to full grip
};

struct PerformOptions {
  Shape shape;  // of the object as it is, for the verdict; the plan has the believed
  TrialCriteria criteria;
  GripOptions grip;
  ArmGains arm;
  PneumaticGains hand;
  PneumaticParameters pneumatics;  // of the scene
  RandomEngine actuation{0};       // stream "actuation" of the trial: sensor noise
  double max_finger_force = 5;     // N
  double sample_dt = 0.01;         // s, of the recorded trajectory
};

// One row of the recorded trajectory.
struct TrajectorySample {
  double t = 0;
  Phase phase = Phase::kSettle;
  Pose X_WO, X_WH, X_WH_planned;
  PerFinger<Eigen::Vector3d> p_WF;
  PerFinger<double> normal;  // N
  double palm_normal = 0;    // N
  RobotState state;          // mass and bias left out of files
  HandVector hand_planned;   // rad
  RobotCommand command;
};

struct Performance {
  std::vector<TrialEvent> events;  // what went wrong, unordered
  Phase reached = Phase::kSettle;
  ContactWindow grip, hold, after;  // end of grip, last of hold, after the disturbances
  double slip = 0, rotation = 0;    // m, rad: largest in the hand from grip to the end
  double creep = 0;                 // m/s in hold
  double shake_fraction = 0;        // smallest of three axes, achieved over commanded
  double arm_error = 0;             // m, RMS of the hand frame against plan in the reach
  double finger_error = 0;          // m, RMS of fingertips against plan in the reach
  double end_error = 0;             // m, hand frame against plan at the end of the reach
  double duration = 0;              // s, simulated
  std::vector<TrajectorySample> trajectory;
};

// Called after every simulation step; for videos and tests.
using StepObserver = std::function<void(const Simulation&, Phase)>;

// Runs settle, reach, grip, lift, hold, disturb and after on `simulation` (placed at its start),
// whose object is the body `object`. `hand` is the kinematic tree of the hand with root H.
// Never throws for what physics does: divergence is an event.
Performance Perform(Simulation& simulation, const RobotIo& robot, const std::string& object,
                    const KinematicTree& hand, const KinematicTree& arm, const GraspPlan& plan,
                    const PerformOptions& options, const StepObserver& observer = {});

}  // namespace springgrasp
