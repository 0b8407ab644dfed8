#include "experiment/perform_grasp.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <optional>

#include "base/error.h"
#include "base/files.h"
#include "experiment/reach_report.h"
#include "experiment/trajectory_csv.h"
#include "experiment/trial_film.h"
#include "grasp/library.h"
#include "kinematics/mirror.h"
#include "sim/scene_builder.h"

namespace springgrasp {
namespace {

// The block that an object stands on.
Obstacle PedestalOf(const Scene& scene, int object) {
  const SceneObject& o = scene.objects[object];
  Obstacle block;
  block.shape = {Shape::Kind::kBox, o.pedestal};
  block.X_WS.linear() = Eigen::AngleAxisd(o.yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  block.X_WS.translation() = ObjectStartPose(scene, object).translation();
  block.X_WS.translation().z() = scene.table.height + o.pedestal.z() / 2;
  return block;
}

constexpr double kDegrees = 180 / std::numbers::pi;

void RecordPlan(const PlanResult& plan, TrialResult& result) {
  auto& v = result.values;
  v["mapping_error_mm"] = 1e3 * plan.mapping_error;
  v["contact_slide_mm"] = 1e3 * plan.posture.slide;
  v["contact_penetration_mm"] = 1e3 * plan.posture.penetration;
  v["planned_opposition_deg"] = plan.posture.opposition_deg;
  if (!plan.plan) return;
  v["limit_margin"] = plan.limit_margin;
  v["table_clearance_mm"] = 1e3 * plan.table_clearance;
  v["self_clearance_mm"] = 1e3 * plan.self_clearance;
  v["approach_clearance_mm"] = 1e3 * plan.clearance;
  v["reach_joined"] = plan.join;
  v["free_angle_deg"] = plan.free_angle_deg;
  v["reach_duration_s"] = plan.motion.T;
}

void RecordPerformance(const Performance& p, const std::string& type, const PerformOptions& options,
                       TrialResult& result) {
  auto& v = result.values;
  v["simulated_s"] = p.duration;
  if (p.reached > Phase::kReach) {
    v["arm_error_mm"] = 1e3 * p.arm_error;
    v["arm_end_error_mm"] = 1e3 * p.end_error;
    v["arm_late_error_mm"] = 1e3 * p.late_reach.position;
    v["arm_late_error_deg"] = kDegrees * p.late_reach.rotation;
    v["finger_error_mm"] = 1e3 * p.finger_error;
  }
  if (p.grip.duration > 0) {
    const ContactCheck closed = CheckContacts(type, p.grip, options.shape, options.criteria);
    v["grip_epsilon"] = closed.epsilon;
    v["grip_volume"] = closed.volume;
    v["grip_task"] = closed.task;
    double least = 1e9;  // of thumb and index, which all types need
    for (const int f : {kThumb, kIndex}) least = std::min(least, p.grip.normal[f]);
    v["grip_least_normal_n"] = least;
  }
  const ContactWindow& window = p.reached > Phase::kDisturb ? p.after
                                : p.reached > Phase::kHold  ? p.hold
                                                            : p.grip;
  if (window.duration > 0) {
    for (int f = 0; f < kNumFingers; ++f) {
      v[fmt::format("normal_{}_n", kFingerNames[f])] = window.normal[f];
      v[fmt::format("load_share_{}", kFingerNames[f])] = window.LoadShare(f);
    }
    v["palm_normal_n"] = window.palm_normal;
    for (int f = 0; f < kNumFingers; ++f) {
      v[fmt::format("largest_force_{}_n", kFingerNames[f])] = p.largest_force[f];
      if (p.reached <= Phase::kHold || p.force_target[f] == 0) continue;
      v[fmt::format("force_target_{}_n", kFingerNames[f])] = p.force_target[f];
      v[fmt::format("force_sensed_{}_n", kFingerNames[f])] = p.force_sensed[f];
      v[fmt::format("force_hold_{}_n", kFingerNames[f])] = p.hold.normal[f];
    }
    v["regrips"] = p.regrips;
    const ContactCheck check = CheckContacts(type, window, options.shape, options.criteria);
    v["opposition_deg"] = check.opposition_deg;
    v["epsilon"] = check.epsilon;
    v["volume"] = check.volume;
  }
  if (p.reached >= Phase::kLift) {
    v["slip_mm"] = 1e3 * p.slip;
    v["rotation_deg"] = kDegrees * p.rotation;
  }
  if (p.reached > Phase::kHold) {
    v["creep_mm_s"] = 1e3 * p.creep;
    v["weight_error"] = p.weight_error;
    v["arm_hold_error_mm"] = 1e3 * p.held.position;
    v["arm_hold_error_deg"] = kDegrees * p.held.rotation;
  }
  v["beyond_arm_torque_nm"] = p.violations.arm_torque;
  v["beyond_arm_torque_s"] = p.violations.arm_torque_s;
  v["beyond_arm_range_deg"] = kDegrees * p.violations.arm_range;
  v["beyond_hand_range_deg"] = kDegrees * p.violations.hand_range;
  v["below_ambient_bar"] = p.violations.pressure_low;
  v["beyond_supply_bar"] = p.violations.pressure_high;
  v["beyond_valve_rate_bar_s"] = p.violations.valve_rate;
  if (p.reached > Phase::kDisturb) v["shake_fraction"] = p.shake_fraction;
  if (p.placed) {
    v["place_error_mm"] = 1e3 * p.place_error;
    v["place_tilt_deg"] = kDegrees * p.place_tilt;
  }
}

std::vector<Grasp> ShippedGrasps() {
  std::vector<Grasp> grasps;
  for (LibraryEntry& entry : ReadLibrary(ShippedLibrary())) grasps.push_back(entry.grasp);
  return grasps;
}

// What a plan without success tells of other places to begin from.
struct Sought {
  std::vector<Pose> holds;  // of the hand, X_WH
  bool blocked = false;     // the robot would begin in the object's place
};

// From the scene's start posture, the `posture`th that is tried.
TrialResult PerformFrom(const Grasp& grasp, const Scene& scene, const PerformGraspOptions& options,
                        PlanMemory& plans, int posture, Sought* sought = nullptr) {
  TrialResult result;
  BuildOptions build;
  build.with_looks = false;
  Simulation simulation(BuildModel(scene, build));
  const std::string side = GraspingSide(scene);
  const RobotIo robot(simulation.model(), side);
  const RobotBody body = MakeRobotBody(simulation, side);
  const Pose X_WO = ObjectStartPose(scene, 0);
  result.values["object_x"] = X_WO.translation().x();
  result.values["object_y"] = X_WO.translation().y();

  Scene believed = scene;
  if (options.believe_truth) believed.objects[0].believed = SceneBelief();
  PlanRequest request;
  request.object = BelieveObject(believed, 0);
  if (body.mirrored) {
    ThrowUnless(grasp.type != "lateral", "the left hand does not perform lateral grasps");
    request.object.X_WO = MirroredObjectPose(request.object.X_WO);
  }
  request.place = scene.objects[0].place;
  if (body.mirrored && request.place) request.place->x() *= -1;
  request.table_height = scene.table.height;
  request.table_edge = scene.table.position.y() - scene.table.size.y() / 2;
  if (scene.objects[0].pedestal.z() > 0) {
    Obstacle pedestal = PedestalOf(scene, 0);
    if (body.mirrored) pedestal.X_WS = MirroredObjectPose(pedestal.X_WS);
    request.obstacles.push_back(pedestal);
  }
  request.arm_start = robot.Read(simulation).arm_q;
  request.criteria = options.criteria;
  request.object_centre = options.object_centre;
  request.baseline = options.baseline;
  request.seek_holds = sought != nullptr;
  PlanResult plan = plans.Get(options.plan_key, posture, [&] {
    if (request.baseline && request.baseline->name == "synergies") {
      request.baseline->synergies = FindSynergies(body, ShippedGrasps());
    }
    return PlanGrasp(body, grasp, request);
  });
  RecordPlan(plan, result);
  if (sought != nullptr) {
    sought->blocked = plan.blocked;
    if (!body.mirrored) sought->holds = plan.holds;
  }
  if (!plan.plan) {
    result.outcome = Outcome::kUnreachable;
    result.message = plan.reason;
    result.phase = "plan";
    return result;
  }
  if (!options.motion.empty()) {
    WriteFileAtomically(options.motion, FormatFingertipMotion(plan.motion));
  }
  if (body.mirrored) {
    for (Pose& X : plan.plan->X_WH) X = MirroredBodyPose(X);
    plan.plan->X_WO_place = MirroredObjectPose(plan.plan->X_WO_place);
    for (Pose& X : plan.plan->X_WH_place) X = MirroredBodyPose(X);
    for (auto& tips : plan.plan->p_WF) {
      for (Eigen::Vector3d& p : tips) p = MirroredPoint(p);
    }
  }

  robot.Place(plan.plan->arm.front(), plan.plan->hand.front(), simulation);
  simulation.Forward();
  PerformOptions perform;
  perform.criteria = options.criteria;
  perform.pneumatics = scene.pneumatics;
  perform.actuation = options.actuation;
  perform.shape = scene.objects[0].shape.value_or(plan.plan->shape);
  perform.exact_arm = options.exact_arm;
  perform.exact_fingers = options.exact_fingers;
  perform.max_finger_force = scene.max_finger_force;
  std::optional<TrialFilm> film;
  if (!options.video.empty()) {
    film.emplace(simulation, robot, scene, *plan.plan,
                 FilmOptions{options.video, options.camera, options.annotate});
  }
  const Performance performance =
      Perform(simulation, robot, scene.objects[0].name, body, *plan.plan, perform,
              [&](const Simulation& now, Phase phase) {
                if (film) film->Look(now, phase);
              });
  if (film) film->Finish();
  if (!options.trajectory.empty()) {
    WriteFileAtomically(options.trajectory,
                        FormatTrajectory(performance.trajectory, robot.layout()));
  }
  const TrialEvent verdict = DecideOutcome(performance.events);
  result.outcome = verdict.outcome;
  result.message = verdict.message;
  result.phase = std::string(PhaseName(performance.reached));
  RecordPerformance(performance, grasp.type, perform, result);
  return result;
}

}  // namespace

TrialResult PerformGrasp(const Grasp& grasp, const Scene& scene,
                         const PerformGraspOptions& options) {
  PlanMemory plans;
  return PerformGrasp(grasp, scene, options, plans);
}

TrialResult PerformGrasp(const Grasp& grasp, const Scene& scene, const PerformGraspOptions& options,
                         PlanMemory& plans) {
  int posture = 0;
  Sought sought;
  const TrialResult result = PerformFrom(grasp, scene, options, plans, posture, &sought);
  const ReachAids aids = AidsOf(scene);
  if (result.outcome != Outcome::kUnreachable || !(aids.torso || aids.platform)) return result;
  Scene believed = scene;
  if (options.believe_truth) believed.objects[0].believed = SceneBelief();
  const Eigen::Vector3d p_WO = BelieveObject(believed, 0).X_WO.translation();
  // Of a blocked start's neighbours many are blocked too, which is soon seen.
  constexpr std::size_t kMoves = 5, kMovesWhereBlocked = 24;
  std::vector<BasePosture> bases =
      MovesToHold(scene, aids, sought.holds, options.criteria.lift_height,
                  sought.blocked ? kMovesWhereBlocked : kMoves);
  for (const BasePosture& base : MovesIntoReach(scene, aids, p_WO, {})) bases.push_back(base);
  for (const BasePosture& base : bases) {
    Scene moved = scene;
    for (const auto& [joint, value] : base) moved.start[joint] = value;
    TrialResult again = PerformFrom(grasp, moved, options, plans, ++posture);
    if (again.outcome == Outcome::kUnreachable) continue;
    for (const auto& [joint, value] : base) again.values["start_" + joint] = value;
    return again;
  }
  return result;
}

}  // namespace springgrasp
