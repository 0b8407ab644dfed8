#include "experiment/plan_grasp.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "experiment/grasp_requests.h"
#include "grasp/generate.h"
#include "kinematics/hand_motion.h"
#include "kinematics/reach_plan.h"
#include "kinematics/shape_distance.h"
#include "kinematics/smooth_hand_ik.h"
#include "motion/minimum_jerk.h"

namespace springgrasp {
namespace {

// Slower reaches are tried where the arm is not fast enough for the demonstrated one.
constexpr double kSlower[] = {1.0, 1.4, 2.0};
constexpr double kClosed = 1.35;  // fraction of T at which the fingers are planned closed
constexpr double kApproachClearance = 0.02;  // m, between object and open hand on its way
constexpr double kWay = 0.72;                // of T, then the object enters the hand
// The hand is not fully open on its way yet, so its open outline may cut the object a little (tuned
// with experiments/first_grasps, seeds below 1000).
constexpr double kBlocked = -0.01;         // m, less than this on the way and another pose is tried
constexpr double kWaitClearance = 0.015;   // m, between object and waiting fingers
constexpr double kMaxEarlyFlexion = 0.25;  // rad
constexpr double kInset = 0.015;           // m, of a plate, between its edge and the contacts
constexpr double kSpareClearance = 0.003;  // m, between a plate and what shall not touch it
constexpr double kFastest = 1.5;           // s, reach of the robot's arm

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

// The chambers fill slower than a human hand closes, so the robot's closing waits for its arm: the
// fingers follow the human-like motion up to the widest aperture, hold it (opened at least as far
// as `q_wait`) until the arm has arrived at T, and close on the contact posture until kClosed T.
std::vector<Eigen::VectorXd> CloseAfterArrival(
    const RobotHand& hand, const HandMotionResult& motion, const PerFinger<bool>& involved,
    const Eigen::VectorXd& q_wait, const Eigen::VectorXd& q_contact, double dt, double T) {
  // Widest aperture within the part of the reach where humans have it.
  const auto at = [&](double t) {
    return std::min(motion.q.size() - 1, static_cast<std::size_t>(std::lround(t / dt)));
  };
  std::size_t widest = at(0.3 * T);
  double aperture = -1;
  for (std::size_t i = at(0.3 * T); i <= at(0.75 * T); ++i) {
    double sum = 0;
    for (int f = kIndex; f < kNumFingers; ++f) {
      if (involved[f]) sum += (motion.p_HF[i][f] - motion.p_HF[i][kThumb]).norm();
    }
    if (sum <= aperture) continue;
    aperture = sum;
    widest = i;
  }
  // Uninvolved fingers and the palm are in place when the hand arrives.
  Eigen::VectorXd q_arrive = q_contact;
  for (int f = 0; f < kNumFingers; ++f) {
    if (!involved[f]) continue;
    for (const int j : {hand.fingers[f].j0, hand.fingers[f].j1}) {
      q_arrive[j] = std::min(motion.q[widest][j], q_wait[j]);
    }
  }
  // Thumb and fingers of this hand cross when they curl together: before the arrival none flexes
  // much more than it will have to.
  std::vector<Eigen::VectorXd> q = motion.q;
  for (Eigen::VectorXd& posture : q) {
    posture = posture.cwiseMin((q_arrive.array() + kMaxEarlyFlexion).matrix());
  }
  const std::vector<Eigen::VectorXd> human_like = q;
  const double t_widest = static_cast<double>(widest) * dt;
  for (std::size_t i = 0; i < q.size(); ++i) {
    const double t = static_cast<double>(i) * dt;
    if (t <= T) {
      // Leaves the human-like motion for the waiting posture from before the widest aperture on.
      const double u = MinimumJerkPosition(
          std::clamp((t - 0.5 * t_widest) / (0.9 * T - 0.5 * t_widest), 0.0, 1.0));
      q[i] = (1 - u) * human_like[std::min(i, widest)] + u * q_arrive;
    } else {
      const double u = MinimumJerkPosition(std::clamp((t - T) / ((kClosed - 1) * T), 0.0, 1.0));
      q[i] = (1 - u) * q_arrive + u * q_contact;
    }
  }
  return q;
}

template <typename Vector>
std::vector<Vector> Fixed(const std::vector<Eigen::VectorXd>& path) {
  return std::vector<Vector>(path.begin(), path.end());
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
    result.posture = SolveContactPosture(body.hand, contacts);
    const Pose X_GH = result.posture.X_HG.inverse();
    const Eigen::VectorXd q_open =
        OpenedPosture(body.hand, result.posture, generate.shape, closing(motion.involved), 1.0);

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
      if (grasp.type == "lateral") {
        X_OH = EdgeOnApproach(X_OH, result.posture.X_HG, motion.n_OC[kThumb], dt, motion.T);
      }
      X_OH =
          ClearApproach(body.hand, generate.shape, X_OH, q_open, dt, motion.T, kApproachClearance);
      for (Pose& X : X_OH) X = turned.X_WO * X;
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
    reach.X_HG = result.posture.X_HG;
    reach.tilt_free = grasp.type != "power";
    reach.involved = motion.involved;
    if (grasp.type == "lateral") reach.spare_clearance = kSpareClearance;
    reach.table_height = request.table_height;
    reach.table_edge = request.table_edge;
    reach.body = &body.arm_body;
    reach.q_start = request.arm_start;
    reach.dt = dt;
    reach.T = motion.T;
    reach.q_hand = nominal_hand.q;
    reach.path = path;
    reach.clear = [&](const Pose& X_OF, const std::vector<Pose>& X_WH) {
      const Pose X_OW = (request.object.X_WO * X_OF).inverse();
      return ClearanceOnTheWay(body.hand, generate.shape, X_OW, X_WH, q_open,
                               kWay * motion.T / dt) >= kBlocked;
    };
    Arm arm = body.arm;
    for (int j = 0; j < arm.num_joints(); ++j) arm.q[arm.joints[j]] = request.arm_start[j];
    ReachOptions options;
    options.lift = request.criteria.lift_height;
    options.lift_duration = request.criteria.lift;
    options.shake = request.criteria.shake_amplitude;
    options.shake_frequency = request.criteria.shake_frequency;
    options.shake_duration = request.criteria.shake_duration;
    const ReachPlan planned = PlanReach(arm, body.hand, reach, options);
    result.reason = planned.reason;
    if (!planned.reachable) continue;

    // The chosen one in full.
    const Pose X_WO = request.object.X_WO * planned.X_OF;
    path(planned.X_OF);
    q_human = SolveHandMotionSmoothly(human, TipsOf(motion), {.dt = dt});
    const HandMotionResult hand = MapHandMotion(
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
    // An object that seats in the palm has to pass the thumb on its way in.
    const Eigen::VectorXd q_wait = grasp.type == "power"
                                       ? q_open
                                       : OpenedPosture(body.hand, result.posture, generate.shape,
                                                       closing(motion.involved), kWaitClearance);
    const std::vector<Eigen::VectorXd> q_hand = CloseAfterArrival(
        body.hand, hand, closing(motion.involved), q_wait, result.posture.q, dt, motion.T);
    plan.hand = Fixed<HandVector>(q_hand);
    plan.lift = Fixed<ArmVector>(planned.lift);
    for (int axis = 0; axis < 3; ++axis) plan.shake[axis] = Fixed<ArmVector>(planned.shake[axis]);
    plan.X_HO = result.posture.X_HO;
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
