#include "experiment/finger_baseline.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "experiment/grasp_requests.h"
#include "grasp/generate.h"
#include "kinematics/hand_ik.h"
#include "kinematics/hand_mapping.h"
#include "kinematics/hand_motion.h"
#include "kinematics/smooth_hand_ik.h"

namespace springgrasp {
namespace {

constexpr int kGrid = 41;              // per synergy, of the coarse search
constexpr int kRefinements = 12;       // of its step, halved
constexpr double kLibraryStep = 0.02;  // s, between postures that synergies are found from

// Of a grasp on the object that it was learned from: the human tips through the reach.
std::vector<KnownTips> TipsOnOwnObject(const Grasp& grasp, double dt) {
  GenerateOptions generate;
  generate.shape = grasp.shape;
  generate.tip_radius = grasp.tip_radius;
  generate.dt = dt;
  const FingertipMotion motion = GenerateMotion(grasp, generate);
  std::vector<KnownTips> tips = TipsOf(motion);
  tips.resize(ContactSample(motion, dt) + 1);
  return tips;
}

HumanHand DemonstratingHand(const RobotBody& body, const Grasp& grasp) {
  return ScaledHand(body.human, grasp.hand_length / kMmmHandLength);
}

// Eq. (14) with one weight of the position term for all fingers.
MappingTarget Target(const RobotBody& body, const HumanHand& human, const Eigen::VectorXd& q_human,
                     double lambda) {
  MappingTarget target = TargetFromHuman(human, q_human, body.hand);
  target.lambda.fill(lambda);
  return target;
}

std::vector<Eigen::VectorXd> MapMotion(const RobotBody& body, const HumanHand& human,
                                       const std::vector<KnownTips>& tips) {
  std::vector<MappingTarget> targets;
  for (const Eigen::VectorXd& q_human : SolveHandMotion(human, tips)) {
    targets.push_back(Target(body, human, q_human, 1));
  }
  std::vector<Eigen::VectorXd> q;
  const int last = static_cast<int>(targets.size()) - 1;
  for (const MappingResult& mapped : MapHandAlong(body.hand, targets, last)) q.push_back(mapped.q);
  return q;
}

Eigen::VectorXd InRange(const RobotHand& hand, const Eigen::VectorXd& q) {
  return q.cwiseMax(hand.tree.lower).cwiseMin(hand.tree.upper);
}

Eigen::VectorXd Posture(const RobotHand& hand, const PosturalSynergies& s,
                        const Eigen::Vector2d& a) {
  return InRange(hand, s.mean + s.basis * a);
}

// Mean square distance of the involved tips from the planned contacts, both in H.
double DistanceFromContacts(const RobotHand& hand, const ContactPosture& posture,
                            const PerFinger<bool>& involved, const Eigen::VectorXd& q) {
  const PerFinger<Eigen::Vector3d> tips = TipPositions(hand, q);
  double sum = 0;
  int count = 0;
  for (int f = 0; f < kNumFingers; ++f) {
    if (!involved[f]) continue;
    sum += (tips[f] - posture.X_HO * posture.p_OC[f]).squaredNorm();
    ++count;
  }
  return sum / std::max(1, count);
}

// A coarse grid over what the library's postures span, then a pattern search about its best.
Eigen::Vector2d NearestSynergies(const RobotHand& hand, const ContactPosture& posture,
                                 const PerFinger<bool>& involved, const PosturalSynergies& s) {
  const auto cost = [&](const Eigen::Vector2d& a) {
    return DistanceFromContacts(hand, posture, involved, Posture(hand, s, a));
  };
  const Eigen::Vector2d cell = (s.high - s.low) / (kGrid - 1);
  Eigen::Vector2d best = s.low;
  double least = cost(best);
  const auto visit = [&](const Eigen::Vector2d& a) {
    const double c = cost(a);
    if (c >= least) return false;
    least = c;
    best = a;
    return true;
  };
  for (int i = 0; i < kGrid; ++i) {
    for (int j = 0; j < kGrid; ++j) visit(s.low + Eigen::Vector2d(i * cell[0], j * cell[1]));
  }
  double scale = 0.5;
  for (int n = 0; n < kRefinements;) {
    const Eigen::Vector2d centre = best;
    bool better = false;
    for (const double u : {-scale, scale}) {
      better = visit(centre + Eigen::Vector2d(u * cell[0], 0)) || better;
      better = visit(centre + Eigen::Vector2d(0, u * cell[1])) || better;
    }
    if (better) continue;
    scale /= 2;
    ++n;
  }
  return best;
}

// u in [0, 1] over the reach.
double Progress(const FingertipMotion& motion, std::size_t sample) {
  return std::min(1.0, motion.samples[sample].t / motion.T);
}

// The tips of `played` about the object as the robot holds it, with the weights of a grasp by
// springs, but nothing that would bring them onto the object's surface.
std::vector<Eigen::VectorXd> MapPlayed(const RobotBody& body, const HumanHand& human,
                                       const FingertipMotion& played,
                                       const ContactPosture& posture) {
  const double dt = played.samples[1].t - played.samples[0].t;
  const std::vector<Eigen::VectorXd> q_human =
      SolveHandMotionSmoothly(human, TipsOf(played), {.dt = dt});
  const HandMotionRequest request = RequestHandMotion(
      played, q_human, posture, std::vector<Pose>(played.samples.size()), Pose::Identity(), dt);
  std::vector<Eigen::VectorXd> q;
  const auto contact = static_cast<int>(ContactSample(played, dt));
  for (const MappingResult& mapped :
       MapHandAlong(body.hand, MappingTargets(human, body.hand, request), contact)) {
    q.push_back(mapped.q);
  }
  return q;
}

}  // namespace

PosturalSynergies FindSynergies(const RobotBody& body, const std::vector<Grasp>& library) {
  std::vector<Eigen::VectorXd> postures;
  for (const Grasp& grasp : library) {
    const std::vector<Eigen::VectorXd> q =
        MapMotion(body, DemonstratingHand(body, grasp), TipsOnOwnObject(grasp, kLibraryStep));
    postures.insert(postures.end(), q.begin(), q.end());
  }
  ThrowUnless(postures.size() > 2, "synergies need a library of grasps");
  Eigen::MatrixXd all(body.hand.tree.num_joints(), static_cast<Eigen::Index>(postures.size()));
  for (std::size_t i = 0; i < postures.size(); ++i) {
    all.col(static_cast<Eigen::Index>(i)) = postures[i];
  }
  PosturalSynergies s;
  s.mean = all.rowwise().mean();
  all.colwise() -= s.mean;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(all, Eigen::ComputeThinU);
  s.basis = svd.matrixU().leftCols(2);
  const Eigen::VectorXd variance = svd.singularValues().array().square();
  s.explained = variance.head(2).sum() / variance.sum();
  const Eigen::MatrixXd coordinates = s.basis.transpose() * all;
  s.low = coordinates.rowwise().minCoeff();
  s.high = coordinates.rowwise().maxCoeff();
  return s;
}

std::vector<Eigen::VectorXd> PlanBaselineHand(const BaselineRequest& request, const RobotBody& body,
                                              const HumanHand& human, const Grasp& grasp,
                                              const FingertipMotion& motion,
                                              const ContactPosture& posture) {
  std::vector<Eigen::VectorXd> result;
  const std::size_t n = motion.samples.size();
  if (request.name == "interpolation") {
    const double dt = kLibraryStep;
    const Eigen::VectorXd q_human = SolveHandMotion(human, TipsOnOwnObject(grasp, dt)).back();
    const Eigen::VectorXd closed = MapHand(body.hand, Target(body, human, q_human, 0)).q;
    for (std::size_t i = 0; i < n; ++i) {
      result.push_back(body.hand.open + Progress(motion, i) * (closed - body.hand.open));
    }
  } else if (request.name == "playback") {
    ThrowUnless(!request.demonstrated.empty(), "playback needs the demonstrated fingertips");
    const auto& tips = request.demonstrated;
    FingertipMotion played = motion;
    for (std::size_t i = 0; i < n; ++i) {
      const double at = Progress(motion, i) * static_cast<double>(tips.size() - 1);
      const auto k = static_cast<std::size_t>(at);
      const double u = at - static_cast<double>(k);
      for (int f = 0; f < kNumFingers; ++f) {
        played.samples[i].p_HF[f] =
            (1 - u) * tips[k][f] + u * tips[std::min(k + 1, tips.size() - 1)][f];
      }
    }
    result = MapPlayed(body, human, played, posture);
  } else if (request.name == "synergies") {
    const PosturalSynergies& s = request.synergies;
    const Eigen::Vector2d open =
        (s.basis.transpose() * (body.hand.open - s.mean)).cwiseMax(s.low).cwiseMin(s.high);
    const Eigen::Vector2d closed = NearestSynergies(body.hand, posture, motion.involved, s);
    for (std::size_t i = 0; i < n; ++i) {
      result.push_back(Posture(body.hand, s, open + Progress(motion, i) * (closed - open)));
    }
  } else {
    Fail("no baseline is named '{}', expected interpolation, playback or synergies", request.name);
  }
  return result;
}

}  // namespace springgrasp
