// PERFORM: one planned grasp in physics, phase by phase.
#pragma once

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "control/arm_controller.h"
#include "control/grip_controller.h"
#include "experiment/contact_window.h"
#include "experiment/grasp_plan.h"
#include "experiment/limit_watch.h"
#include "experiment/phases.h"
#include "experiment/robot_body.h"
#include "experiment/verdict.h"
#include "sim/pneumatics.h"
#include "sim/robot_io.h"
#include "sim/simulation.h"

namespace springgrasp {

struct GripOptions {
  double acceleration = 20;         // m/s^2, that the grip shall withstand besides gravity
  double safety = 2.5;              // of the grip force
  double min_force = 2.5;           // N, of the thumb at the fingertips
  double min_key_force = 3.5;       // N, of the thumb, whose one valve curls it in if it is more
  double min_enclosing_force = 10;  // N, of all fingers of a power grasp together
  GripSettings settings;
};

struct PerformOptions {
  Shape shape;  // of the object as it is, for the verdict; the plan has the believed
  TrialCriteria criteria;
  GripOptions grip;
  ArmGains arm;
  PneumaticParameters pneumatics;  // of the scene
  RandomEngine actuation{0};       // stream "actuation" of the trial: sensor noise
  double max_finger_force = 5;     // N
  // Joints put where they are wanted before every step until T, the end of the reach proper.
  bool exact_arm = false, exact_fingers = false;
  double sample_dt = 0.01;  // s, of the recorded trajectory
};

// One row of the recorded trajectory.
struct TrajectorySample {
  double t = 0;
  Phase phase = Phase::kSettle;
  Pose X_WO, X_WH, X_WH_planned;
  PerFinger<Eigen::Vector3d> p_WF, p_WF_planned;
  PerFinger<double> normal;                          // N
  double palm_normal = 0;                            // N
  RobotState state;                                  // mass and bias left out of files
  HandVector hand_planned;                           // rad
  PerFinger<double> force_target{}, force_sensed{};  // N, asked for; felt along the grip's axis
  RobotCommand command;
};

// Of the hand frame H against its plan.
struct PoseError {
  double position = 0, rotation = 0;  // m, rad
  void Add(const Pose& X, const Pose& planned) {
    position = std::max(position, (X.translation() - planned.translation()).norm());
    rotation = std::max(rotation, RotationDistance(Eigen::Quaterniond(X.linear()),
                                                   Eigen::Quaterniond(planned.linear())));
  }
};

struct Performance {
  std::vector<TrialEvent> events;  // what went wrong, unordered
  Phase reached = Phase::kSettle;
  ContactWindow grip, hold, after;         // end of grip, last of hold, after the disturbances
  double slip = 0, rotation = 0;           // m, rad: largest in the hand from grip to the end
  double creep = 0;                        // m/s in hold
  double weight_error = 0;          // of m g: what the contact forces of hold lack to carry it
  double shake_fraction = 0;               // smallest of three axes, achieved over commanded
  double arm_error = 0;                    // m, RMS of the hand frame against plan in the reach
  double finger_error = 0;                 // m, RMS of fingertips against plan in the reach
  double end_error = 0;                    // m, hand frame against plan at the end of the reach
  PoseError late_reach, held;              // largest from 0.8 T to the end of the reach; in hold
  bool placed = false;                     // set down, the hand away again
  double place_error = 0, place_tilt = 0;  // m, rad: from where and how it should stand
  LimitViolations violations;
  PerFinger<double> force_target{};   // N, mean over the window of hold
  PerFinger<double> force_sensed{};   // N, the same
  PerFinger<double> largest_force{};  // N, any time of a finger's normal force on the object
  int regrips = 0;
  double duration = 0;  // s, simulated
  std::vector<TrajectorySample> trajectory;
};

// Called after every simulation step; for videos and tests.
using StepObserver = std::function<void(const Simulation&, Phase)>;

// Runs settle, reach, grip, lift, hold, disturb, after and, if the plan has one, place on
// `simulation` (placed at its start), whose object is the body `object`. `robot` and `body` belong
// to one side; the plan's poses are those of the world, its angles the side's. Never throws for
// what physics does: divergence is an event.
Performance Perform(Simulation& simulation, const RobotIo& robot, const std::string& object,
                    const RobotBody& body, const GraspPlan& plan, const PerformOptions& options,
                    const StepObserver& observer = {});

}  // namespace springgrasp
