#include "experiment/perform.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "experiment/arm_reference.h"
#include "experiment/force_window.h"
#include "experiment/grip_task.h"
#include "experiment/place_held.h"
#include "experiment/trial_watch.h"
#include "kinematics/mirror.h"
#include "motion/minimum_jerk.h"
#include "sim/model_index.h"

namespace springgrasp {
namespace {

constexpr double kGravity = 9.81;     // m/s^2
constexpr double kMinRise = 0.5;      // of the lift height, that the object must have risen
constexpr double kLateReach = 0.8;    // of T, from where on the hand must be where it is wanted
constexpr double kGripWindow = 0.25;  // s, to see whether a finger touches at the end of grip

// One trial under way: references, controllers, bookkeeping.
class Performer {
 public:
  Performer(Simulation& simulation, const RobotIo& robot, const std::string& object,
            const RobotBody& body, const GraspPlan& plan, const PerformOptions& options,
            const StepObserver& observer)
      : simulation_(simulation),
        robot_(robot),
        object_name_(object),
        object_(IdOf(simulation.model(), mjOBJ_BODY, object)),
        mirrored_(body.mirrored),
        arm_(body.arm),
        hand_(body.hand),
        plan_(plan),
        options_(options),
        criteria_(options.criteria),
        observer_(observer),
        tip_frames_(TipFrames(body.hand.tree)),
        nominal_hand_(robot.layout()),
        drives_(options.pneumatics, simulation.timestep(), options.actuation),
        grip_(BelievedHand(robot.layout(), options), body.hand.tree, tip_frames_,
              GripTaskOf(plan, body.hand, options), options.grip.settings),
        watch_(simulation, robot, object_, criteria_, performance_) {}

  Performance Run() {
    Settle() && Reach() && Grip() && Lift() && Hold() && Disturb() && After() && Place();
    performance_.duration = simulation_.time();
    performance_.regrips = grip_.regrips();
    return std::move(performance_);
  }

 private:
  // One control and simulation step. `load` in [0, 1] scales the carried load. Returns false when
  // the trial is over.
  bool Step(const ArmTarget& arm_target, const HandReference& hand, GripStage stage, double load) {
    const double dt = simulation_.timestep();
    if (stage == GripStage::kFree) {
      if (options_.exact_arm) robot_.MoveArm(arm_target.q, arm_target.qd, simulation_);
      if (options_.exact_fingers) robot_.MoveHand(hand.q, hand.qd, simulation_);
    }
    RobotState state = robot_.Read(simulation_);
    const ValveVector pressure = state.pressure;
    drives_.Sense(state);
    RobotCommand command;
    ArmTarget target = arm_target;
    if (load > 0)
      target.feedforward_torque = load * LoadTorque(arm_, state.arm_q, plan_.X_HO, plan_.mass);
    command.arm_torque = ControlArm(options_.arm, target, state, dt, arm_memory_);
    HandTarget hand_target;
    hand_target.q = hand_planned_ = hand.q;
    hand_target.qd = hand.qd;
    hand_target.qdd = hand.qdd;
    hand_target.sensing_delay = options_.pneumatics.sensing_delay;
    command.valve_pressure = grip_.Control(state, hand_target, stage, dt);
    WatchLimits(robot_, nominal_hand_, options_.pneumatics, state, target.q, hand.q, command, dt,
                performance_.violations);
    command.valve_pressure = drives_.Step(command.valve_pressure, pressure);
    robot_.Write(command, simulation_);
    simulation_.Step();
    watch_.Step(dt);
    if (simulation_.diverged()) return false;
    const HandLoad load_now = watch_.Load();
    for (int f = 0; f < kNumFingers; ++f) {
      performance_.largest_force[f] = std::max(performance_.largest_force[f], load_now.normal[f]);
    }
    force_window_.Add(grip_.target_force(), grip_.SensedForce());
    Sample(state, command);
    if (observer_) observer_(simulation_, performance_.reached);
    return !watch_.over();
  }

  void Sample(const RobotState& state, const RobotCommand& command) {
    if (simulation_.time() < next_sample_ - 1e-9) return;
    next_sample_ += options_.sample_dt;
    TrajectorySample sample;
    sample.t = simulation_.time();
    sample.phase = performance_.reached;
    sample.X_WO = watch_.ObjectPose();
    sample.X_WH = robot_.HandPose(simulation_);
    sample.X_WH_planned = planned_;
    const HandLoad load = watch_.Load();
    for (int f = 0; f < kNumFingers; ++f) {
      sample.p_WF[f] = robot_.Fingertip(simulation_, f);
      sample.p_WF_planned[f] = planned_ * PlannedTipInHand(plan_, sample_of_plan_, f);
      sample.normal[f] = load.normal[f];
    }
    sample.palm_normal = load.palm_normal;
    sample.state = state;
    sample.hand_planned = hand_planned_;
    sample.force_target = grip_.target_force();
    sample.force_sensed = grip_.SensedForce();
    sample.command = command;
    performance_.trajectory.push_back(sample);
  }

  long StepsFor(double duration) const { return std::lround(duration / simulation_.timestep()); }
  void Enter(Phase phase) { performance_.reached = phase; }
  ArmTarget Rest(const ArmVector& q) const {
    ArmTarget target;
    target.q = q;
    return target;
  }

  HandReference StillAt(const HandVector& q) const {
    return {q, HandVector::Zero(q.size()), HandVector::Zero(q.size())};
  }

  bool Settle() {
    Enter(Phase::kSettle);
    planned_ = plan_.X_WH.front();
    for (long i = 0; i < StepsFor(criteria_.settle); ++i) {
      if (!Step(Rest(plan_.arm.front()), StillAt(plan_.hand.front()), GripStage::kFree, 0))
        return false;
    }
    watch_.Settled();
    return true;
  }

  bool Reach() {
    Enter(Phase::kReach);
    const double end = plan_.dt * static_cast<double>(plan_.arm.size() - 1);
    double arm_sum = 0, finger_sum = 0;
    long fingers = 0;
    const long steps = StepsFor(end);
    for (long i = 0; i < steps; ++i) {
      const double t = static_cast<double>(i) * simulation_.timestep();
      planned_ = PlannedHandPose(plan_, t + simulation_.timestep());
      sample_of_plan_ = std::min(plan_.arm.size() - 1, static_cast<std::size_t>(t / plan_.dt));
      if (!Step(ArmReferenceAt(plan_.arm, plan_.dt, t), HandReferenceAt(plan_.hand, plan_.dt, t),
                t < plan_.T ? GripStage::kFree : GripStage::kClosing, 0)) {
        return false;
      }
      const Pose X_WH = robot_.HandPose(simulation_);
      arm_sum += (X_WH.translation() - planned_.translation()).squaredNorm();
      if (t > kLateReach * plan_.T) performance_.late_reach.Add(X_WH, planned_);
      if (t > plan_.T) continue;
      for (int f = 0; f < kNumFingers; ++f) {
        if (!plan_.involved[f]) continue;
        finger_sum += (X_WH.inverse() * robot_.Fingertip(simulation_, f) -
                       PlannedTipInHand(plan_, sample_of_plan_, f))
                          .squaredNorm();
        ++fingers;
      }
    }
    const Pose X_WH = robot_.HandPose(simulation_);
    performance_.arm_error = std::sqrt(arm_sum / static_cast<double>(std::max(1L, steps)));
    performance_.finger_error = std::sqrt(finger_sum / static_cast<double>(std::max(1L, fingers)));
    performance_.end_error = (X_WH.translation() - plan_.X_WH.back().translation()).norm();
    return true;
  }

  bool Grip() {
    Enter(Phase::kGrip);
    planned_ = plan_.X_WH.back();
    for (long i = 0; i < StepsFor(criteria_.grip); ++i) {
      const double t = static_cast<double>(i) * simulation_.timestep();
      if (t <= criteria_.grip - kGripWindow) watch_.window().Clear();
      if (!Step(Rest(plan_.arm.back()), StillAt(plan_.hand.back()), GripStage::kPressing, 0)) {
        return false;
      }
    }
    performance_.grip = watch_.window().Mean();
    watch_.Gripped();
    for (int f = 0; f < kNumFingers; ++f) {
      if (!plan_.involved[f] || performance_.grip.normal[f] >= criteria_.contact_force) continue;
      watch_.Record(Outcome::kMissed,
                    fmt::format("{} does not touch at the end of grip", kFingerNames[f]));
      return false;
    }
    return true;
  }

  bool Lift() {
    Enter(Phase::kLift);
    const double start = watch_.ObjectPose().translation().z();
    for (long i = 0; i < StepsFor(criteria_.lift); ++i) {
      const double t = static_cast<double>(i) * simulation_.timestep();
      watch_.window().Clear();
      if (!Step(ArmReferenceAt(plan_.lift, plan_.dt, t), StillAt(plan_.hand.back()),
                GripStage::kPressing, std::min(1.0, t / (0.2 * criteria_.lift)))) {
        return false;
      }
    }
    const double risen = watch_.ObjectPose().translation().z() - start;
    if (risen < kMinRise * criteria_.lift_height || watch_.window().Mean().support_normal > 0) {
      watch_.Dropped(fmt::format("object risen by {:.0f} mm only", 1e3 * risen));
      return false;
    }
    return true;
  }

  bool Hold() {
    Enter(Phase::kHold);
    planned_ = HandPose(arm_, plan_.lift.back());
    if (mirrored_) planned_ = MirroredBodyPose(planned_);
    const double quiet = 0.5;  // s, let the lift die out before creep is measured
    Eigen::Vector3d p_HO_quiet = watch_.ObjectInHand().translation();
    for (long i = 0; i < StepsFor(criteria_.hold); ++i) {
      const double t = static_cast<double>(i) * simulation_.timestep();
      if (t <= quiet) p_HO_quiet = watch_.ObjectInHand().translation();
      if (t <= criteria_.hold - criteria_.window) {
        watch_.window().Clear();
        force_window_.Clear();
      }
      if (!Step(Rest(plan_.lift.back()), StillAt(plan_.hand.back()), GripStage::kPressing, 1))
        return false;
      performance_.held.Add(robot_.HandPose(simulation_), planned_);
    }
    performance_.creep = (watch_.ObjectInHand().translation() - p_HO_quiet).norm() /
                         std::max(0.1, criteria_.hold - quiet);
    performance_.hold = watch_.window().Mean();
    performance_.weight_error =
        WeightError(performance_.hold, robot_.HandPose(simulation_).linear(),
                    simulation_.model().body_subtreemass[object_] * kGravity);
    performance_.force_target = force_window_.MeanTarget();
    performance_.force_sensed = force_window_.MeanSensed();
    return true;
  }

  bool Disturb() {
    Enter(Phase::kDisturb);
    const double force = criteria_.force_per_mass * simulation_.model().body_mass[object_];
    for (int axis = 0; axis < 3; ++axis) {
      for (const double sign : {1.0, -1.0}) {
        simulation_.ApplyForce(object_name_, sign * force * Eigen::Vector3d::Unit(axis));
        for (long i = 0; i < StepsFor(criteria_.force_duration); ++i) {
          if (!Step(Rest(plan_.lift.back()), StillAt(plan_.hand.back()), GripStage::kPressing, 1))
            return false;
        }
      }
    }
    simulation_.ApplyForce(object_name_, Eigen::Vector3d::Zero());
    performance_.shake_fraction = 1e9;
    for (int axis = 0; axis < 3; ++axis) {
      double low = 1e9, high = -1e9;
      for (long i = 0; i < StepsFor(criteria_.shake_duration); ++i) {
        const double t = static_cast<double>(i) * simulation_.timestep();
        if (!Step(ArmReferenceAt(plan_.shake[axis], plan_.dt, t), StillAt(plan_.hand.back()),
                  GripStage::kPressing, 1)) {
          return false;
        }
        const double x = robot_.HandPose(simulation_).translation()[axis];
        low = std::min(low, x);
        high = std::max(high, x);
      }
      performance_.shake_fraction =
          std::min(performance_.shake_fraction, (high - low) / 2 / criteria_.shake_amplitude);
    }
    return true;
  }

  bool After() {
    Enter(Phase::kAfter);
    watch_.window().Clear();
    for (long i = 0; i < StepsFor(criteria_.after); ++i) {
      if (!Step(Rest(plan_.lift.back()), StillAt(plan_.hand.back()), GripStage::kPressing, 1))
        return false;
    }
    performance_.after = watch_.window().Mean();
    if (watch_.slip()) performance_.events.push_back(*watch_.slip());
    if (performance_.shake_fraction < criteria_.min_shake_fraction) {
      watch_.Record(Outcome::kError,
                    fmt::format("the arm reached {:.0f} % of the shaking amplitude only",
                                100 * performance_.shake_fraction));
    }
    for (const ContactWindow* window : {&performance_.hold, &performance_.after}) {
      const ContactCheck check = CheckContacts(plan_.type, *window, options_.shape, criteria_);
      if (!check.ok) watch_.Record(Outcome::kWrongContacts, check.reason);
    }
    if (plan_.place.empty()) Enter(Phase::kDone);
    return true;
  }

  // The hand's joints from where they are to those that let go, at time t of the release.
  HandReference Releasing(const HandVector& from, double t) const {
    const double u = MinimumJerkPosition(std::min(1.0, t / criteria_.release));
    return StillAt((1 - u) * from + u * plan_.released);
  }

  bool Place() {
    if (plan_.place.empty()) return true;
    Enter(Phase::kPlace);
    const double way = plan_.dt * static_cast<double>(plan_.place.size() - 1);
    const auto [place, retreat] = PathsForHeld(arm_, hand_, plan_, robot_.Read(simulation_).hand_q);
    for (long i = 0; i < StepsFor(way); ++i) {
      const double t = static_cast<double>(i) * simulation_.timestep();
      planned_ = plan_.X_WH_place[static_cast<std::size_t>(t / plan_.dt)];
      if (!Step(ArmReferenceAt(place, plan_.dt, t), StillAt(plan_.hand.back()),
                GripStage::kPressing, 1)) {
        return false;
      }
    }
    watch_.Released();
    HandVector gripping = plan_.hand.back();
    const long eased = StepsFor(options_.grip.settings.ease);
    for (long i = 0; i < eased + StepsFor(criteria_.release); ++i) {
      const double t = std::max(0.0, static_cast<double>(i - eased) * simulation_.timestep());
      if (i == eased) gripping = robot_.Read(simulation_).hand_q;
      if (!Step(Rest(place.back()), Releasing(gripping, t), GripStage::kReleasing,
                1 - t / criteria_.release)) {
        return false;
      }
    }
    const double away = plan_.dt * static_cast<double>(retreat.size() - 1) + criteria_.rest;
    Eigen::Vector3d p_WO_before = watch_.ObjectPose().translation();
    watch_.window().Clear();
    for (long i = 0; i < StepsFor(away); ++i) {
      const double t = static_cast<double>(i) * simulation_.timestep();
      if (t < away - criteria_.rest) {
        p_WO_before = watch_.ObjectPose().translation();
        watch_.window().Clear();
      }
      if (!Step(ArmReferenceAt(retreat, plan_.dt, t), StillAt(plan_.released),
                GripStage::kReleasing, 0)) {
        return false;
      }
    }
    const PlacedObject placed = JudgePlaced(watch_.ObjectPose(), plan_.X_WO_place, p_WO_before,
                                            watch_.window().Mean(), criteria_);
    performance_.placed = true;
    performance_.place_error = placed.error;
    performance_.place_tilt = placed.tilt;
    if (!placed.fault.empty()) watch_.Record(Outcome::kDroppedPlace, placed.fault);
    Enter(Phase::kDone);
    return true;
  }

  Simulation& simulation_;
  const RobotIo& robot_;
  const std::string object_name_;
  const int object_;
  const bool mirrored_;
  const Arm& arm_;
  const RobotHand& hand_;
  const GraspPlan& plan_;
  const PerformOptions& options_;
  const TrialCriteria& criteria_;
  const StepObserver& observer_;
  const PerFinger<int> tip_frames_;
  const PneumaticHandModel nominal_hand_;
  PneumaticDrives drives_;
  GripController grip_;
  ArmControlState arm_memory_;
  Performance performance_;
  TrialWatch watch_;  // writes into performance_, so it stands after it
  Pose planned_ = Pose::Identity();
  std::size_t sample_of_plan_ = 0;
  HandVector hand_planned_;
  ForceWindow force_window_;
  double next_sample_ = 0;
};

}  // namespace

Performance Perform(Simulation& simulation, const RobotIo& robot, const std::string& object,
                    const RobotBody& body, const GraspPlan& plan, const PerformOptions& options,
                    const StepObserver& observer) {
  return Performer(simulation, robot, object, body, plan, options, observer).Run();
}

}  // namespace springgrasp
