#include "grasp/learn.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "grasp/aperture.h"
#include "grasp/generate_fingers.h"
#include "grasp/grasp_frame.h"
#include "grasp/learn_complete.h"
#include "grasp/learn_fit.h"
#include "grasp/learn_preshape.h"
#include "grasp/learn_reach.h"
#include "grasp/learn_segment.h"
#include "grasp/learn_track.h"
#include "grasp/shown_reach.h"
#include "grasp/spring_system.h"

namespace springgrasp {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kContactWindow = 0.08;  // s, after the contact instant

// Tips of the relaxed hand, m, at the demonstrator's hand length.
Fingertips RelaxedTips(const LearnOptions& options) {
  Fingertips tips = options.relaxed_tips.value_or(DefaultRelaxedTips());
  for (Vector3d& p : tips) p *= options.hand_length / kNominalHandLength;
  return tips;
}

double TipRadius(const LearnOptions& options) {
  return options.tip_radius * (options.hand_length / kNominalHandLength);
}

Pose NominalGraspInHand(const LearnOptions& options) {
  Pose X_HG = options.X_HG_nominal.value_or(DefaultGraspInHand());
  X_HG.translation() *= options.hand_length / kNominalHandLength;
  return X_HG;
}

// Mean tips in H at and just after the contact, while the fingers stay closed.
Fingertips TipsAtContact(const HandTrack& track, int contact) {
  const int from = std::min(contact, track.size() - 1);
  const int to = std::min(track.size() - 1, contact + static_cast<int>(kContactWindow / track.dt));
  Fingertips mean = track.p_HF[static_cast<std::size_t>(from)];
  for (int n = from + 1; n <= to; ++n) {
    for (int i = 0; i < kNumFingers; ++i) mean[i] += track.p_HF[static_cast<std::size_t>(n)][i];
  }
  for (Vector3d& p : mean) p /= to - from + 1;
  return mean;
}

// Frame of a hand whose orientation was not recorded, in its track's frame M (the world's axes):
// X_MH, constant. From the wrist x points to the fingers and z from the thumb to them; without a
// wrist the hand hangs on the grasp frame, the wrist being where the reach came from.
Pose HandFromFingers(const HandTrack& track, const ReachSegment& reach, const Fingertips& p_MF,
                     const PerFinger<bool>& involved, const Pose& X_HG_nominal) {
  if (track.wrist) {
    Vector3d fingers = Vector3d::Zero();
    int count = 0;
    for (int i = kIndex; i < kNumFingers; ++i) {
      if (!track.observed[i]) continue;
      fingers += p_MF[i];
      ++count;
    }
    fingers /= count;
    const Matrix3d R = FrameFromXZ(fingers, fingers - p_MF[kThumb]);
    return MakePose(Vector3d::Zero(), Quaterniond(R));
  }
  const Vector3d from = track.X_WH[static_cast<std::size_t>(reach.begin)].translation() -
                        track.X_WH[static_cast<std::size_t>(reach.contact)].translation();
  const Vector3d wrist = from.norm() > 1e-3 ? from : Vector3d(0, -1, 0);
  return GraspFrame(p_MF, involved, wrist) * X_HG_nominal.inverse();
}

// Fingers that were never seen lie as in the relaxed hand; involved ones beside the nearest seen.
void PoseUnseenFingers(const PerFinger<bool>& observed, const PerFinger<bool>& involved,
                       const Fingertips& relaxed, Fingertips& p_HF) {
  for (int i = 0; i < kNumFingers; ++i) {
    if (observed[i]) continue;
    p_HF[i] = relaxed[i];
    if (!involved[i]) continue;
    int nearest = kThumb;
    for (int j = kIndex; j < kNumFingers; ++j) {
      if (!observed[j]) continue;
      if (nearest == kThumb || std::abs(j - i) < std::abs(nearest - i)) nearest = j;
    }
    p_HF[i] = p_HF[nearest] + relaxed[i] - relaxed[nearest];
  }
}

// Hand plane of the paper's 2-D springs: through the contact centroid, its normal the direction of
// least variance of all involved tips over the movement. Two fingers leave that to chance: then the
// normal is the part of H's y orthogonal to G's x. Returns X_HP, and the RMS distance from it.
Pose HandPlane(const std::vector<Fingertips>& p_HF, const PerFinger<bool>& involved,
               const Fingertips& p_HC, const Pose& X_HG, double& planarity) {
  Vector3d centroid = Vector3d::Zero();
  int fingers = 0;
  for (int i = 0; i < kNumFingers; ++i) {
    if (!involved[i]) continue;
    centroid += p_HC[i];
    ++fingers;
  }
  centroid /= fingers;
  Matrix3d scatter = Matrix3d::Zero();
  for (const Fingertips& tips : p_HF) {
    for (int i = 0; i < kNumFingers; ++i) {
      if (involved[i]) scatter += (tips[i] - centroid) * (tips[i] - centroid).transpose();
    }
  }
  scatter /= static_cast<double>(p_HF.size()) * fingers;
  const Vector3d x = X_HG.linear().col(0);
  Vector3d normal = Eigen::SelfAdjointEigenSolver<Matrix3d>(scatter).eigenvectors().col(0);
  if (fingers == 2) normal = Vector3d::UnitY() - x.dot(Vector3d::UnitY()) * x;
  if (normal.dot(Vector3d::UnitY()) < 0) normal = -normal;
  normal.normalize();
  planarity = std::sqrt(normal.dot(scatter * normal));
  const Vector3d in_plane = x - x.dot(normal) * normal;
  return MakePose(centroid, Quaterniond(FrameFromXZ(in_plane, normal)));
}

// Outward normals at the contacts in H: those of the object's surface, or away from G's origin.
Fingertips ContactNormals(const Grasp& grasp, const Fingertips& p_HC) {
  Fingertips normals;
  for (int i = 0; i < kNumFingers; ++i) {
    normals[i] = (p_HC[i] - grasp.X_HG.translation()).normalized();
    if (!grasp.involved[i]) continue;
    const Vector3d n_O = OutwardNormal(grasp.shape, grasp.X_OH * p_HC[i]);
    normals[i] = grasp.X_OH.linear().transpose() * n_O;
  }
  return normals;
}

// Replaces a grasp by what its own file says, so that the value in memory and the one read back
// are the same to the bit.
Grasp AsWritten(Grasp grasp) {
  std::string text = FormatGrasp(grasp);
  for (int n = 0; n < 10; ++n) {
    grasp = ParseGrasp(text, grasp.name);
    std::string again = FormatGrasp(grasp);
    if (again == text) break;
    text = std::move(again);
  }
  return grasp;
}

}  // namespace

PerFinger<Vector3d> DefaultRelaxedTips() {
  // MMM hand, pads 8 mm behind the apex: MCP, PIP, DIP flexed by 20, 30, 15 degrees; thumb
  // opposition 45, MCP and IP 15.
  return {Vector3d(0.0812, 0.0505, -0.0320), Vector3d(0.1507, 0.0237, -0.0480),
          Vector3d(0.1582, 0.0, -0.0547), Vector3d(0.1468, -0.0195, -0.0529),
          Vector3d(0.1250, -0.0380, -0.0409)};
}

Pose DefaultGraspInHand() {
  // Thumb and index tip of a pinch, the thumb on the palmar side.
  Fingertips tips;
  tips.fill(Vector3d::Zero());
  tips[kThumb] = Vector3d(0.095, 0.036, -0.062);
  tips[kIndex] = Vector3d(0.125, 0.026, -0.045);
  return GraspFrame(tips, InvolvedFingers("pinch"), Vector3d::Zero());
}

Grasp LearnGrasp(const Demonstration& shown, const LearnOptions& options) {
  Grasp grasp;
  grasp.type = options.type;
  grasp.name = options.name.empty() ? options.type : options.name;
  grasp.source = shown.source;
  grasp.profile = options.profile;
  grasp.dim = options.dim;
  grasp.hand_length = options.hand_length;
  grasp.tip_radius = TipRadius(options);
  grasp.involved = InvolvedFingers(options.type);
  ThrowUnless(options.dim == 2 || options.dim == 3, "dim is {}, expected 2 or 3", options.dim);
  ThrowUnless(
      options.profile == "human" || options.profile == "paper" || options.profile == "unforced",
      "profile is '{}', expected human, paper or unforced", options.profile);

  // The hand's movement, and where in it the reach lies.
  const ShownReach reach_shown = FindShownReach(shown, options.type, grasp.involved);
  const Demonstration& demonstration = reach_shown.demonstration;
  const PerFinger<bool>& closing = reach_shown.closing;
  const ReachSegment& segment = reach_shown.segment;
  HandTrack track = reach_shown.track;
  grasp.observed = track.observed;

  // Frames at contact: H (where it was not recorded), G, O.
  const Pose X_HG_nominal = NominalGraspInHand(options);
  if (!track.orientation) {
    track =
        WithHandFrame(track, HandFromFingers(track, segment, TipsAtContact(track, segment.contact),
                                             closing, X_HG_nominal));
  }
  const Fingertips relaxed = RelaxedTips(options);
  const SeenAtEnds seen = FindSeenAtEnds(track, segment);
  CompleteFingers(seen, closing, segment, {}, track);
  Fingertips p_HC = TipsAtContact(track, segment.contact);
  PoseUnseenFingers(track.observed, grasp.involved, relaxed, p_HC);
  grasp.X_HG = GraspFrame(p_HC, grasp.involved, Vector3d::Zero());
  const Pose X_WH = track.X_WH[static_cast<std::size_t>(segment.contact)];
  const auto& object = options.object ? options.object : demonstration.object;
  grasp.object_given = object.has_value();
  Pose X_WO;
  if (object) {
    X_WO = object->X_WO;
    grasp.shape = object->shape;
  } else {
    Fingertips p_WF;
    for (int i = 0; i < kNumFingers; ++i) p_WF[i] = X_WH * p_HC[i];
    const Pose X_WG = X_WH * grasp.X_HG;
    const Vector3d up = demonstration.up.value_or(X_WG.linear().col(1));
    const InferredObject inferred = InferObject(p_WF, grasp.involved, X_WG, up, TipRadius(options));
    X_WO = inferred.X_AO;
    grasp.shape = inferred.shape;
  }
  grasp.X_OH = X_WO.inverse() * X_WH;
  if (object) {
    const auto hidden = HiddenContacts(seen, grasp, p_HC);
    CompleteFingers(seen, closing, segment, hidden, track);
    for (int i = 0; i < kNumFingers; ++i) p_HC[i] = hidden[i].value_or(p_HC[i]);
    grasp.X_HG = GraspFrame(p_HC, grasp.involved, Vector3d::Zero());
  }
  for (int i = 0; i < kNumFingers; ++i) {
    if (grasp.involved[i]) grasp.rays[i] = RayOfContact(grasp.shape, grasp.X_OH * p_HC[i]);
  }

  // The reach: G in O, completed to rest, as a DMP.
  std::vector<Pose> X_OG;
  for (int n = segment.begin; n <= segment.contact; ++n) {
    X_OG.push_back(X_WO.inverse() * track.X_WH[static_cast<std::size_t>(n)] * grasp.X_HG);
  }
  const LearnedReach reach = LearnReach(X_OG, track.dt, options.basis_functions);
  grasp.reach = reach.dmp;
  grasp.quality.reach_rmse = reach.rmse;
  grasp.scales.T = reach.T;
  const Pose X_GH = grasp.X_HG.inverse();
  const int steps = static_cast<int>(std::ceil(1.35 * reach.T / track.dt));
  const HandPath path = RollOutHand(grasp.reach, X_GH, reach.T, track.dt, steps);
  grasp.scales.A =
      std::max(0.02, ((path.X_OG.front() * X_GH).translation() - grasp.X_OH.translation()).norm());

  // The fingers along it; while the reach was completed they rest.
  FitProblem fit;
  const int reach_steps = static_cast<int>(std::floor(reach.T / track.dt)) + 1;
  for (int n = 0; n < reach_steps; ++n) {
    const double t = segment.begin * track.dt + n * track.dt - reach.lead;
    const int k =
        std::clamp(static_cast<int>(std::lround(t / track.dt)), segment.begin, segment.contact);
    Fingertips tips = track.p_HF[static_cast<std::size_t>(k)];
    PoseUnseenFingers(track.observed, grasp.involved, relaxed, tips);
    fit.p_HF.push_back(tips);
  }
  for (std::size_t n = 0; n < track.sample_t.size(); ++n) {
    const double t = track.sample_t[n] - segment.begin * track.dt;
    if (t < 0 || t > (segment.contact - segment.begin) * track.dt) continue;
    fit.sample_t.push_back(t + reach.lead);
    fit.sample_p_HF.push_back(track.sample_p_HF[n]);
  }
  const Fingertips& start = fit.p_HF.front();
  double distance = 0;
  int involved = 0;
  for (int i = 0; i < kNumFingers; ++i) {
    if (!grasp.involved[i]) continue;
    distance += (start[i] - p_HC[i]).norm();
    ++involved;
  }
  grasp.scales.x0 = std::max(0.005, distance / involved);
  grasp.X_HP = HandPlane(fit.p_HF, grasp.involved, p_HC, grasp.X_HG, grasp.quality.planarity);

  fit.run.dim = grasp.dim;
  fit.run.X_HP = grasp.X_HP;
  fit.run.involved = grasp.involved;
  fit.run.p_HC = p_HC;
  fit.run.n_H = ContactNormals(grasp, p_HC);
  fit.run.p_HF = start;
  fit.run.v_HF.fill(Vector3d::Zero());
  fit.run.edges = SpringTopology(grasp.dim == 2 ? "fan7" : "brace9");
  for (const auto& [i, j] : fit.run.edges) {
    fit.run.rest_lengths.push_back((relaxed[i] - relaxed[j]).norm());
  }
  fit.run.gains.mass = grasp.mass;
  fit.human = options.profile == "human";
  fit.forced = options.profile != "unforced";
  fit.rule = RuleOf(fit.human);
  fit.run.ratio = grasp.ratio = fit.human ? "balanced" : "paper";
  fit.run.hold = fit.human;
  fit.run.max_ratio = grasp.max_ratio;
  fit.run.T = grasp.scales.T;
  fit.run.t_switch = path.t_switch;
  fit.scales = grasp.scales;
  fit.acceleration = path.acceleration;
  fit.lead = reach.lead;
  fit.dt = track.dt;
  fit.observed = track.observed;
  fit.noise = track.tip_noise;
  // Eq. (7) cannot see a speed peak that lies outside the recording or at its very edge.
  const double measured = segment.contact - segment.begin;
  const double peak = segment.peak - segment.begin;
  fit.fit_switch = fit.human || peak < 0.1 * measured || peak > 0.9 * measured;
  const std::size_t widest = WidestInstant(fit);
  grasp.quality.aperture = Aperture(fit.p_HF[widest], grasp.involved);
  grasp.quality.aperture_time =
      WidestStep(fit.p_HF, grasp.involved, widest) * track.dt / grasp.scales.T;
  if (fit.human) {
    grasp.opening = Preshape(fit, widest);
    fit.run.opening_bend = grasp.opening_bend = OpeningBend(fit, widest, grasp.opening);
    fit.run.opening = grasp.opening;
    fit.run.bend = grasp.bend = ClosingBend(fit);
    fit.run.lag = ClosingLag(fit);
    for (int i = 0; i < kNumFingers; ++i) grasp.lag[i] = fit.run.lag[i] / fit.run.T;
  }
  const FitResult fitted = FitSprings(fit);

  const SpringGains gains = RestoreGains(fitted.gains, grasp.mass, grasp.scales);
  grasp.kc = gains.kc;
  grasp.dc = gains.dc;
  for (std::size_t e = 0; e < fit.run.edges.size(); ++e) {
    const auto [i, j] = fit.run.edges[e];
    grasp.edges.push_back(
        {i, j, gains.k[e], fit.run.rest_lengths[e], gains.d[e], fitted.standard_errors[e]});
  }
  for (int i = 0; i < kNumFingers; ++i) {
    grasp.offset[i] = grasp.involved[i] ? Vector3d(start[i] - p_HC[i]) : start[i];
    grasp.velocity[i].setZero();
  }
  grasp.ambient_damping = fit.rule.ambient * gains.dc;
  grasp.reach_gain = fitted.gains.reach;
  grasp.delay = fitted.gains.delay;
  grasp.closing = fitted.gains.closing;
  grasp.holding = fitted.gains.holding;
  grasp.switch_rule = fit.fit_switch ? "fitted" : "learned";
  grasp.t_switch = fitted.t_switch / grasp.scales.T;
  grasp.quality.begin = track.t0 + segment.begin * track.dt - reach.lead;
  grasp.quality.rmse = fitted.rmse;
  grasp.quality.aperture_rmse = fitted.aperture_rmse;
  grasp.quality.aperture_reproduced = fitted.aperture;
  grasp.quality.aperture_time_reproduced = fitted.aperture_time;
  grasp.quality.samples = fitted.samples;
  grasp.quality.condition_number = fitted.condition_number;
  grasp.quality.noise = track.tip_noise;
  return AsWritten(std::move(grasp));
}

}  // namespace springgrasp
