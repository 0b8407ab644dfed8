#include "experiment/plan_grasp.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "experiment/closing_plan.h"
#include "experiment/grasp_requests.h"
#include "experiment/place_plan.h"
#include "experiment/plan_hold.h"
#include "grasp/object_contacts.h"
#include "kinematics/hand_motion.h"
#include "kinematics/reach_plan.h"
#include "kinematics/shape_distance.h"
#include "kinematics/smooth_hand_ik.h"

namespace springgrasp {
namespace {

// Slower reaches are tried where the arm is not fast enough for the demonstrated one.
constexpr double kSlower[] = {1.0, 1.4, 2.0};
constexpr double kApproachClearance = 0.02;  // m, between object and open hand on its way
constexpr double kClosingPart = 0.25;        // of T, in which the open hand nears the object
constexpr double kWay = 0.72;                // of T, then the object enters the hand
// The hand is not fully open on its way yet, so its open outline may cut the object a little (tuned
// with experiments/first_grasps, seeds below 1000).
constexpr double kBlocked = -0.01;  // m, less than this on the way: another pose is tried
// m, between object and waiting fingers, so that what stands 10 mm from where it is believed is not
// knocked over (tuned with experiments/pose_error, seed 63); pinched balls are not at the smaller.
constexpr double kWaitClearance = 0.020, kPinchWaitClearance = 0.015;
constexpr double kReleaseClearance = 0.05;   // m, between object and fingers that let go
constexpr double kInset = 0.026;             // m, of a plate, between its edge and the contacts
constexpr double kSpareClearance = 0.003;    // m, between a plate and what shall not touch it
constexpr double kSetDownClearance = 0.012;  // m, between table and a hand that sets down
constexpr double kStartClearance = 0.01;     // m, between object and a robot that begins
constexpr double kFastest = 1.5;             // s, reach of the robot's arm

// What all parts of a plan read.
struct Planning {
  const RobotBody& body;
  const Grasp& grasp;
  const PlanRequest& request;
  HumanHand human;  // that demonstrated
  Pose X_WH_start;
  GenerateOptions generate;

  const Shape& shape() const { return generate.shape; }
  const Pose& X_WO() const { return request.object.X_WO; }
  bool power() const { return grasp.type == "power"; }
  bool lateral() const { return grasp.type == "lateral"; }
  double wait_clearance() const {
    return grasp.type == "pinch" ? kPinchWaitClearance : kWaitClearance;
  }
};

Planning PlanningOf(const RobotBody& body, const Grasp& grasp, const PlanRequest& request) {
  ThrowUnless(request.object.shape.has_value(),
              "the object of the scene has no primitive shape; grasping needs `shape` (sphere, "
              "cylinder or box), also beside a `model`");
  Planning p{body,
             grasp,
             request,
             ScaledHand(body.human, grasp.hand_length / kMmmHandLength),
             HandPose(body.arm, request.arm_start),
             {}};
  p.generate.shape = *request.object.shape;
  p.generate.X_WO = request.object.X_WO;
  p.generate.tip_radius = body.hand.tip_radius;
  p.generate.dt = request.dt;
  p.generate.object_centre = request.object_centre;
  p.generate.inset = kInset;
  return p;
}

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

// The last posture of a baseline's way that keeps its involved fingers off the object as the hand
// will hold it, or the first.
Eigen::VectorXd LastClear(const RobotHand& hand, const std::vector<Eigen::VectorXd>& q,
                          const Pose& X_OH, const Shape& shape, const PerFinger<bool>& involved,
                          double clearance) {
  std::vector<Pose> X_HB;
  for (std::size_t i = q.size(); i-- > 0;) {
    ForwardKinematics(hand.tree, q[i], X_HB);
    if (HandDistance(hand, X_HB, X_OH, shape, involved, false) >= clearance) return q[i];
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

struct HandReach {
  FingertipMotion motion;
  std::vector<Pose> X_WH;
};

// The reach of G from where the robot's hand is, for an object turned by X_OF, which it leaves
// free.
HandReach ReachOfHand(const Planning& p, const Hold& hold, const Pose& X_OF) {
  GenerateOptions turned = p.generate;
  turned.X_WO = p.X_WO() * X_OF;
  turned.X_WG_start = p.X_WH_start * hold.posture.X_HG;
  turned.similar_reach = true;
  HandReach reach;
  reach.motion = GenerateMotion(p.grasp, turned);
  const Pose X_GH = hold.posture.X_HG.inverse();
  std::vector<Pose> X_OH;
  for (const FingertipMotionSample& sample : reach.motion.samples) {
    X_OH.push_back(turned.X_WO.inverse() * sample.X_WG * X_GH);
  }
  const double dt = turned.dt, T = reach.motion.T;
  if (p.lateral()) {
    X_OH = EdgeOnApproach(X_OH, hold.posture.X_HG, reach.motion.n_OC[kThumb], dt, T);
  }
  for (Pose& X : X_OH) X = X_OF * X;  // the object itself stays where it is
  // Late, only the way along the plate keeps off it.
  X_OH = ClearApproach(p.body.hand, p.shape(), X_OH, hold.q_open, dt, T, kApproachClearance,
                       kClosingPart, !p.lateral());
  for (const Pose& X : X_OH) reach.X_WH.push_back(p.X_WO() * X);
  return reach;
}

HandMotionResult MapReach(const Planning& p, const Hold& hold, const HandReach& reach,
                          const std::vector<Eigen::VectorXd>& q_human,
                          const std::vector<Pose>& X_WH) {
  return MapHandMotion(
      p.human, p.body.hand,
      RequestHandMotion(reach.motion, q_human, hold.posture, X_WH, p.X_WO(), p.generate.dt),
      hold.posture);
}

// The arm's part, but for the place.
ReachRequest RequestReach(const Planning& p, const Hold& hold, const Eigen::VectorXd& q_wait) {
  const RobotHand& hand = p.body.hand;
  const HandReach nominal = ReachOfHand(p, hold, Pose::Identity());
  ReachRequest reach;
  reach.shape = p.shape();
  reach.X_WO = p.X_WO();
  reach.X_HO = hold.posture.X_HO;
  reach.X_HC = ContactFrame(p.shape(), hold.posture);
  reach.tilt_free = !p.power();
  // Turned far, a plate would leave the index's first phalanx.
  reach.tilt_far = !p.lateral();
  reach.involved = nominal.motion.involved;
  reach.spare_clearance = p.lateral()
                              ? kSpareClearance
                              : std::min(kSpareClearance, SpareDistance(hand, p.shape(), hold));
  reach.table_height = p.request.table_height;
  reach.table_edge = p.request.table_edge;
  reach.obstacles = p.request.obstacles;
  reach.body = &p.body.arm_body;
  reach.q_start = p.request.arm_start;
  reach.dt = p.generate.dt;
  reach.T = nominal.motion.T;
  reach.q_hand = CloseAfterArrival(hand, MapReach(p, hold, nominal, hold.q_human, nominal.X_WH),
                                   hold.closing, q_wait, hold.posture.q, reach.dt, reach.T);
  LetHang(hand, nominal.X_WH, reach.q_hand);
  reach.path = [&p, &hold](const Pose& X_OF) { return ReachOfHand(p, hold, X_OF).X_WH; };
  reach.clear = [&p, &hold, samples = kWay * reach.T / reach.dt](const std::vector<Pose>& X_WH) {
    return ClearanceOnTheWay(p.body.hand, p.shape(), p.X_WO().inverse(), X_WH, hold.q_open,
                             samples) >= kBlocked;
  };
  return reach;
}

ReachOptions OptionsOf(const TrialCriteria& criteria) {
  ReachOptions options;
  options.lift = criteria.lift_height;
  options.lift_duration = criteria.lift;
  options.shake = criteria.shake_amplitude;
  options.shake_frequency = criteria.shake_frequency;
  options.shake_duration = criteria.shake_duration;
  return options;
}

// Joints of the hand along the chosen reach, by the springs' motion or a baseline in its stead.
std::vector<Eigen::VectorXd> PlanFingers(const Planning& p, const Hold& hold,
                                         const FingertipMotion& motion, HandMotionResult mapped,
                                         Eigen::VectorXd q_wait, const std::vector<Pose>& X_WH) {
  const RobotHand& hand = p.body.hand;
  Eigen::VectorXd q_end = hold.posture.q;
  if (p.request.baseline) {
    mapped.q =
        PlanBaselineHand(*p.request.baseline, p.body, p.human, p.grasp, motion, hold.posture);
    for (std::size_t i = 0; i < mapped.q.size(); ++i) {
      mapped.p_HF[i] = TipPositions(hand, mapped.q[i]);
    }
    q_end = mapped.q.back();
    // Demonstrated fingers have a widest aperture of their own; others open as far as they must.
    q_wait = p.request.baseline->name == "playback" ? hand.tree.upper
             : p.power()                            ? mapped.q.front()
                         : LastClear(hand, mapped.q, hold.posture.X_HO.inverse(), p.shape(),
                                     hold.closing, p.wait_clearance());
  }
  std::vector<Eigen::VectorXd> q =
      CloseAfterArrival(hand, mapped, hold.closing, q_wait, q_end, p.generate.dt, motion.T);
  LetHang(hand, X_WH, q);
  return q;
}

// At the speed of p.generate; nothing in result.plan if the arm cannot.
PlanResult PlanAtThisSpeed(const Planning& p, const Hold& hold) {
  const PlanRequest& request = p.request;
  const RobotHand& hand = p.body.hand;
  PlanResult result;
  result.posture = hold.posture;
  // An object that seats in the palm has to pass the thumb on its way in.
  const Eigen::VectorXd q_wait =
      p.power() ? hold.q_open : OpenedHold(hand, hold, p.shape(), p.wait_clearance());
  ReachRequest reach = RequestReach(p, hold, q_wait);
  Arm arm = p.body.arm;
  for (int j = 0; j < arm.num_joints(); ++j) arm.q[arm.joints[j]] = request.arm_start[j];
  PlacePlan place;
  Pose X_WO_place = Pose::Identity();
  ReachOptions options = OptionsOf(request.criteria);
  if (request.place) {
    reach.refusal = [&](const ReachPlan& reached) {
      place = PlanPlaceTo(arm, request, p.shape(), reached, reach.T, X_WO_place);
      return place.reason;
    };
    // An object that slides in the hand is set down with the hand lower than it took it.
    options.least_clearance = kSetDownClearance;
  }
  ReachPlan planned = PlanReach(arm, hand, reach, options);
  if (!planned.reachable && request.place) {
    planned = PlanReach(arm, hand, reach, OptionsOf(request.criteria));
  }
  result.reason = planned.reason;
  result.holds = planned.holds;
  if (!planned.reachable) return result;

  const HandReach chosen = ReachOfHand(p, hold, planned.X_OF);
  const HandMotionResult mapped = MapReach(
      p, hold, chosen, SolveHandMotionSmoothly(p.human, TipsOf(chosen.motion), {.dt = request.dt}),
      planned.X_WH);
  result.motion = chosen.motion;
  result.mapping_error = mapped.mapping_error;
  result.clearance = mapped.clearance;
  result.limit_margin = planned.limit_margin;
  result.table_clearance = planned.table_clearance;
  result.self_clearance = planned.self_clearance;
  result.join = planned.join;
  result.free_angle_deg =
      RotationDistance(Eigen::Quaterniond::Identity(), Eigen::Quaterniond(planned.X_OF.linear())) *
      180 / std::numbers::pi;

  GraspPlan& plan = result.plan.emplace();
  plan.type = p.grasp.type;
  plan.involved = chosen.motion.involved;
  plan.shape = p.shape();
  plan.mass = request.object.mass;
  plan.friction = request.object.friction;
  plan.dt = request.dt;
  plan.T = chosen.motion.T;
  plan.X_WH = planned.X_WH;
  plan.arm = Fixed<ArmVector>(planned.arm);
  const std::vector<Eigen::VectorXd> q_hand =
      PlanFingers(p, hold, chosen.motion, mapped, q_wait, planned.X_WH);
  plan.hand = Fixed<HandVector>(q_hand);
  plan.lift = Fixed<ArmVector>(planned.lift);
  for (int axis = 0; axis < 3; ++axis) plan.shake[axis] = Fixed<ArmVector>(planned.shake[axis]);
  plan.X_HO = planned.X_WH.back().inverse() * p.X_WO();
  if (request.place) {
    plan.X_WO_place = X_WO_place;
    plan.X_WH_place = place.X_WH;
    plan.place = Fixed<ArmVector>(place.arm);
    plan.retreat = Fixed<ArmVector>(place.retreat);
  }
  plan.released = p.power() ? hold.q_open : OpenedHold(hand, hold, p.shape(), kReleaseClearance);
  for (std::size_t i = 0; i < q_hand.size(); ++i) {
    PerFinger<Eigen::Vector3d> tips = TipPositions(hand, q_hand[i]);
    for (Eigen::Vector3d& tip : tips) tip = planned.X_WH[i] * tip;
    plan.p_WF.push_back(tips);
  }
  const Pose X_OW = (plan.X_WH.back() * plan.X_HO).inverse();
  for (int f = 0; f < kNumFingers; ++f) {
    plan.n_HC[f] = plan.X_HO.linear() * OutwardNormal(plan.shape, X_OW * plan.p_WF.back()[f]);
  }
  return result;
}

}  // namespace

PlanResult PlanGrasp(const RobotBody& body, const Grasp& grasp, const PlanRequest& request) {
  Planning planning = PlanningOf(body, grasp, request);
  PlanResult result;
  for (const double slower : kSlower) {
    planning.generate.duration = slower * std::max(kFastest, grasp.scales.T);
    const Hold hold = PlanHold(body, planning.human, grasp, planning.generate);
    if (!StartsClear(body, request, planning.X_WH_start, hold.q_open)) {
      if (request.seek_holds) result = PlanAtThisSpeed(planning, hold);
      result.plan.reset();
      result.posture = hold.posture;
      result.blocked = true;
      result.reason = "the robot would stand in the object's place from the start";
      return result;
    }
    result = PlanAtThisSpeed(planning, hold);
    if (result.plan) return result;
  }
  return result;
}

}  // namespace springgrasp
