#include "experiment/plan_grasp.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "control/hanging_hand.h"
#include "experiment/closing_plan.h"
#include "experiment/grasp_requests.h"
#include "experiment/place_plan.h"
#include "grasp/generate.h"
#include "kinematics/hand_motion.h"
#include "kinematics/reach_plan.h"
#include "kinematics/shape_distance.h"
#include "kinematics/smooth_hand_ik.h"

namespace springgrasp {
namespace {

// Slower reaches are tried where the arm is not fast enough for the demonstrated one.
constexpr double kSlower[] = {1.0, 1.4, 2.0};
constexpr double kApproachClearance = 0.02;  // m, between object and open hand on its way
constexpr double kWay = 0.72;                // of T, then the object enters the hand
// The hand is not fully open on its way yet, so its open outline may cut the object a little (tuned
// with experiments/first_grasps, seeds below 1000).
constexpr double kBlocked = -0.01;        // m, less than this on the way and another pose is tried
constexpr double kWaitClearance = 0.015;  // m, between object and waiting fingers
constexpr double kReleaseClearance = 0.05;   // m, between object and fingers that let go
constexpr double kInset = 0.015;             // m, of a plate, between its edge and the contacts
constexpr double kSpareClearance = 0.003;    // m, between a plate and what shall not touch it
constexpr double kSetDownClearance = 0.012;  // m, between table and a hand that sets down
constexpr double kStartClearance = 0.01;     // m, between object and a robot that begins
constexpr double kFastest = 1.5;             // s, reach of the robot's arm

// Smallest distance of the open hand from the object over the first `samples` of the way, m.
double ClearanceOnTheWay(const RobotHand& hand, const Shape& shape, const Pose& X_OW,
                         const std::vector<Pose>& X_WH, const Eigen::VectorXd& q_open,
                         double samples) {
  std::vector<Pose> X_HB;
  ForwardKinematics(hand.tree, q_open, X_HB);
  double clearance = 1;
  for (std::size_t i = 0; i < X_WH.size() && static_cast<double>(i) < samples; i += 3) {
    clearance = std::min(clearance, HandDistance(hand, X_HB, X_OW * X_WH[i], shape,
                                                 {true, true, true, true, true}, true));
  }
  return clearance;
}

// Whether nothing of the hand, open, and the arm is at the object before they move.
bool StartsClear(const RobotBody& body, const PlanRequest& request, const Pose& X_WH,
                 const Eigen::VectorXd& q_open) {
  std::vector<Pose> X_B;
  ForwardKinematics(body.hand.tree, q_open, X_B);
  const Pose& X_WO = request.object.X_WO;
  const Shape& shape = *request.object.shape;
  return HandDistance(body.hand, X_B, X_WO.inverse() * X_WH, shape, {true, true, true, true, true},
                      true) >= kStartClearance &&
         ArmDistance(body.arm, body.arm_body, request.arm_start, shape, X_WO, X_B) >=
             kStartClearance;
}

// Of palm and spare fingers from the object as it lies in the hand, a little less, m.
double SpareDistance(const RobotHand& hand, const Shape& shape, const ContactPosture& posture,
                     const PerFinger<bool>& involved) {
  std::vector<Pose> X_HB;
  ForwardKinematics(hand.tree, posture.q, X_HB);
  PerFinger<bool> spare;
  for (int f = 0; f < kNumFingers; ++f) spare[f] = !involved[f];
  return HandDistance(hand, X_HB, posture.X_HO.inverse(), shape, spare, true) - 1e-4;
}

// In a hand's frame H, m/s^2.
Eigen::Vector3d GravityIn(const Pose& X_WH) {
  return X_WH.linear().transpose() * Eigen::Vector3d(0, 0, -9.81);
}

PneumaticHandModel DrivesOf(const RobotHand& hand) {
  return PneumaticHandModel(hand.opposition >= 0 ? OppositionHand() : DocumentedHand());
}

// The contact posture with the joints where the hand that holds the object at X_WO can have them.
ContactPosture SolveHangingPosture(const RobotHand& hand, const ContactRequest& contacts,
                                   const Pose& X_WO) {
  constexpr int kRounds = 3;
  constexpr double kClose = 0.01;  // rad
  const PneumaticHandModel drives = DrivesOf(hand);
  ContactPosture posture = SolveContactPosture(hand, contacts);
  for (int round = 0; round < kRounds; ++round) {
    const RobotHand hanging =
        HangingHand(drives, hand, GravityIn(X_WO * posture.X_HO.inverse()), posture.q);
    if ((hanging.tree.lower - posture.q).maxCoeff() < kClose) break;
    posture = SolveContactPosture(hanging, contacts);
  }
  return posture;
}

// What does not hang on the object yet hangs deeper: the joints along a way of hand poses.
void LetHang(const RobotHand& hand, const std::vector<Pose>& X_WH,
             std::vector<Eigen::VectorXd>& q) {
  const PneumaticHandModel drives = DrivesOf(hand);
  for (std::size_t i = 0; i < q.size(); ++i) {
    q[i] = HangingPosture(drives, hand, GravityIn(X_WH[i]), q[i]);
  }
}

// The last posture of a baseline's way that keeps its involved fingers off the object as the hand
// will hold it, or the first.
Eigen::VectorXd LastClear(const RobotHand& hand, const std::vector<Eigen::VectorXd>& q,
                          const Pose& X_OH, const Shape& shape, const PerFinger<bool>& involved) {
  std::vector<Pose> X_HB;
  for (std::size_t i = q.size(); i-- > 0;) {
    ForwardKinematics(hand.tree, q[i], X_HB);
    if (HandDistance(hand, X_HB, X_OH, shape, involved, false) >= kWaitClearance) return q[i];
  }
  return q.front();
}

template <typename Vector>
std::vector<Vector> Fixed(const std::vector<Eigen::VectorXd>& path) {
  return std::vector<Vector>(path.begin(), path.end());
}

// Height of O above the lowest point of an object turned like this, m.
double LowestPoint(const Shape& shape, const Eigen::Matrix3d& R_WO) {
  if (shape.kind == Shape::Kind::kSphere) return shape.size.x() / 2;
  const Eigen::Vector3d up_O = R_WO.transpose().col(2).cwiseAbs();
  if (shape.kind == Shape::Kind::kCylinder) {
    return shape.size.x() / 2 * up_O.head<2>().norm() + shape.size.z() / 2 * up_O.z();
  }
  return up_O.dot(shape.size) / 2;
}

// The way to request.place from where `reach` ends, for an object of this shape.
PlacePlan PlanPlaceTo(const Arm& arm, const PlanRequest& request, const Shape& shape,
                      const ReachPlan& reach, double T, Pose& X_WO_place) {
  PlaceRequest place;
  place.X_WO = place.X_WO_place = request.object.X_WO;
  place.X_WO_place.translation() << *request.place,
      request.table_height + LowestPoint(shape, request.object.X_WO.linear());
  place.X_WH = reach.X_WH;
  place.T = T;
  place.q_lifted = reach.lift.back();
  place.lift = request.criteria.lift_height;
  place.dt = request.dt;
  place.criteria = request.criteria;
  X_WO_place = place.X_WO_place;
  return PlanPlace(arm, place);
}

}  // namespace

PlanResult PlanGrasp(const RobotBody& body, const Grasp& grasp, const PlanRequest& request) {
  ThrowUnless(request.object.shape.has_value(),
              "the object of the scene has no primitive shape; grasping needs `shape` (sphere, "
              "cylinder or box), also beside a `model`");
  PlanResult result;
  const double dt = request.dt;
  GenerateOptions generate;
  generate.shape = *request.object.shape;
  generate.tip_radius = body.hand.tip_radius;
  generate.dt = dt;
  generate.object_centre = request.object_centre;
  generate.inset = kInset;
  // Of a lateral grasp the index lies where the plate comes to; the thumb closes on it.
  const auto closing = [&](const PerFinger<bool>& involved) {
    return grasp.type == "lateral" ? PerFinger<bool>{true} : involved;
  };
  const Pose X_WH_start = HandPose(body.arm, request.arm_start);
  // The hand that demonstrated.
  const HumanHand human = ScaledHand(body.human, grasp.hand_length / kMmmHandLength);

  for (const double slower : kSlower) {
    generate.duration = slower * std::max(kFastest, grasp.scales.T);
    generate.X_WO = request.object.X_WO;
    generate.X_WG_start.reset();

    // Where the hand holds the object (independent of where the object stands).
    FingertipMotion motion = GenerateMotion(grasp, generate);
    std::vector<Eigen::VectorXd> q_human =
        SolveHandMotionSmoothly(human, TipsOf(motion), {.dt = dt});
    const ContactRequest contacts =
        RequestContacts(human, body.hand, motion, q_human[ContactSample(motion, dt)]);
    result.posture = SolveHangingPosture(body.hand, contacts, request.object.X_WO);
    const Pose X_GH = result.posture.X_HG.inverse();
    const Eigen::VectorXd q_open = HangingPosture(
        DrivesOf(body.hand), body.hand,
        GravityIn(request.object.X_WO * result.posture.X_HO.inverse()),
        OpenedPosture(body.hand, result.posture, generate.shape, closing(motion.involved), 1.0));

    if (!StartsClear(body, request, X_WH_start, q_open)) {
      result.reason = "the robot would stand in the object's place from the start";
      return result;
    }

    // The reach of G from where the robot's hand is, for an object turned by what it leaves free.
    const auto path = [&](const Pose& X_OF) {
      GenerateOptions turned = generate;
      turned.X_WO = request.object.X_WO * X_OF;
      turned.X_WG_start = X_WH_start * result.posture.X_HG;
      turned.similar_reach = true;
      motion = GenerateMotion(grasp, turned);
      std::vector<Pose> X_OH;
      for (const FingertipMotionSample& sample : motion.samples) {
        X_OH.push_back(turned.X_WO.inverse() * sample.X_WG * X_GH);
      }
      const bool edge_on = grasp.type == "lateral";
      if (edge_on) {
        X_OH = EdgeOnApproach(X_OH, result.posture.X_HG, motion.n_OC[kThumb], dt, motion.T);
      }
      for (Pose& X : X_OH) X = X_OF * X;  // the object itself stays where it is
      // Late, only the way along the plate keeps off it.
      X_OH = ClearApproach(body.hand, generate.shape, X_OH, q_open, dt, motion.T,
                           kApproachClearance, 0.25, !edge_on);
      for (Pose& X : X_OH) X = request.object.X_WO * X;
      return X_OH;
    };

    const std::vector<Pose> nominal = path(Pose::Identity());
    const HandMotionResult nominal_hand = MapHandMotion(
        human, body.hand,
        RequestHandMotion(motion, q_human, result.posture, nominal, request.object.X_WO, dt),
        result.posture);
    ReachRequest reach;
    reach.shape = generate.shape;
    reach.X_WO = request.object.X_WO;
    reach.X_HO = result.posture.X_HO;
    reach.X_HC = ContactFrame(generate.shape, result.posture);
    reach.tilt_free = grasp.type != "power";
    reach.involved = motion.involved;
    reach.spare_clearance =
        grasp.type == "lateral"
            ? kSpareClearance
            : std::min(kSpareClearance,
                       SpareDistance(body.hand, generate.shape, result.posture, motion.involved));
    reach.table_height = request.table_height;
    reach.table_edge = request.table_edge;
    reach.body = &body.arm_body;
    reach.q_start = request.arm_start;
    reach.dt = dt;
    reach.T = motion.T;
    // An object that seats in the palm has to pass the thumb on its way in.
    const bool power = grasp.type == "power";
    Eigen::VectorXd q_wait = power ? q_open
                                   : OpenedPosture(body.hand, result.posture, generate.shape,
                                                   closing(motion.involved), kWaitClearance);
    reach.q_hand = CloseAfterArrival(body.hand, nominal_hand, closing(motion.involved), q_wait,
                                     result.posture.q, dt, motion.T);
    LetHang(body.hand, nominal, reach.q_hand);
    reach.path = path;
    reach.clear = [&](const std::vector<Pose>& X_WH) {
      return ClearanceOnTheWay(body.hand, generate.shape, request.object.X_WO.inverse(), X_WH,
                               q_open, kWay * motion.T / dt) >= kBlocked;
    };
    Arm arm = body.arm;
    for (int j = 0; j < arm.num_joints(); ++j) arm.q[arm.joints[j]] = request.arm_start[j];
    PlacePlan place;
    Pose X_WO_place = Pose::Identity();
    if (request.place) {
      reach.refusal = [&](const ReachPlan& reached) {
        place = PlanPlaceTo(arm, request, generate.shape, reached, motion.T, X_WO_place);
        return place.reason;
      };
    }
    ReachOptions options;
    options.lift = request.criteria.lift_height;
    options.lift_duration = request.criteria.lift;
    options.shake = request.criteria.shake_amplitude;
    options.shake_frequency = request.criteria.shake_frequency;
    options.shake_duration = request.criteria.shake_duration;
    // An object that slides in the hand is set down with the hand lower than it took it.
    if (request.place) options.least_clearance = kSetDownClearance;
    ReachPlan planned = PlanReach(arm, body.hand, reach, options);
    if (!planned.reachable && request.place) {
      options.least_clearance = ReachOptions().least_clearance;
      planned = PlanReach(arm, body.hand, reach, options);
    }
    result.reason = planned.reason;
    result.holds = planned.holds;
    if (!planned.reachable) continue;

    // The chosen one in full.
    const Pose& X_WO = request.object.X_WO;
    path(planned.X_OF);
    q_human = SolveHandMotionSmoothly(human, TipsOf(motion), {.dt = dt});
    HandMotionResult hand = MapHandMotion(
        human, body.hand,
        RequestHandMotion(motion, q_human, result.posture, planned.X_WH, X_WO, dt), result.posture);
    result.motion = motion;
    result.mapping_error = hand.mapping_error;
    result.clearance = hand.clearance;
    result.limit_margin = planned.limit_margin;
    result.table_clearance = planned.table_clearance;
    result.self_clearance = planned.self_clearance;
    result.join = planned.join;
    result.free_angle_deg = RotationDistance(Eigen::Quaterniond::Identity(),
                                             Eigen::Quaterniond(planned.X_OF.linear())) *
                            180 / std::numbers::pi;

    GraspPlan plan;
    plan.type = grasp.type;
    plan.involved = motion.involved;
    plan.shape = generate.shape;
    plan.mass = request.object.mass;
    plan.friction = request.object.friction;
    plan.dt = dt;
    plan.T = motion.T;
    plan.X_WH = planned.X_WH;
    plan.arm = Fixed<ArmVector>(planned.arm);
    Eigen::VectorXd q_end = result.posture.q;
    if (request.baseline) {
      hand.q = PlanBaselineHand(*request.baseline, body, human, grasp, motion, result.posture);
      for (std::size_t i = 0; i < hand.q.size(); ++i) {
        hand.p_HF[i] = TipPositions(body.hand, hand.q[i]);
      }
      q_end = hand.q.back();
      // Demonstrated fingers have a widest aperture of their own; others open as far as they must.
      q_wait = request.baseline->name == "playback" ? body.hand.tree.upper
               : power                              ? hand.q.front()
                       : LastClear(body.hand, hand.q, result.posture.X_HO.inverse(), generate.shape,
                                   closing(motion.involved));
    }
    std::vector<Eigen::VectorXd> q_hand =
        CloseAfterArrival(body.hand, hand, closing(motion.involved), q_wait, q_end, dt, motion.T);
    LetHang(body.hand, planned.X_WH, q_hand);
    plan.hand = Fixed<HandVector>(q_hand);
    plan.lift = Fixed<ArmVector>(planned.lift);
    for (int axis = 0; axis < 3; ++axis) plan.shake[axis] = Fixed<ArmVector>(planned.shake[axis]);
    plan.X_HO = planned.X_WH.back().inverse() * X_WO;
    if (request.place) {
      plan.X_WO_place = X_WO_place;
      plan.X_WH_place = place.X_WH;
      plan.place = Fixed<ArmVector>(place.arm);
      plan.retreat = Fixed<ArmVector>(place.retreat);
    }
    plan.released = power ? q_open
                          : OpenedPosture(body.hand, result.posture, generate.shape,
                                          closing(motion.involved), kReleaseClearance);
    for (std::size_t i = 0; i < q_hand.size(); ++i) {
      PerFinger<Eigen::Vector3d> tips = TipPositions(body.hand, q_hand[i]);
      for (Eigen::Vector3d& tip : tips) tip = planned.X_WH[i] * tip;
      plan.p_WF.push_back(tips);
    }
    result.plan = std::move(plan);
    return result;
  }
  return result;
}

}  // namespace springgrasp
