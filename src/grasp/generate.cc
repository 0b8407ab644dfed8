#include "grasp/generate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/error.h"
#include "grasp/generate_fingers.h"
#include "grasp/learn_reach.h"
#include "grasp/mesh_contacts.h"
#include "grasp/transfer.h"

namespace springgrasp {
namespace {

using Eigen::Vector3d;

// Turns and scales the position forcing of `reach` as its way from start to goal is turned and
// scaled against that of `learned`.
void TurnForcing(const PoseDmp& learned, PoseDmp& reach) {
  const Vector3d from = (learned.motion.g - learned.motion.x0).head<3>();
  const Vector3d to = (reach.motion.g - reach.motion.x0).head<3>();
  if (from.norm() < 1e-6 || to.norm() < 1e-6) return;
  const Eigen::Matrix3d turn =
      Eigen::Quaterniond::FromTwoVectors(from, to).toRotationMatrix() * (to.norm() / from.norm());
  reach.motion.weights.leftCols<3>() =
      (learned.motion.weights.leftCols<3>() * turn.transpose()).eval();
}

double SectionRadius(const Shape& shape, const TriangleMesh* mesh, const Vector3d& along) {
  return mesh ? MeanSectionRadius(*mesh, along) : MeanSectionRadius(shape, along);
}

// Fingertips where no hand has any.
bool Astray(const FingerMotion& motion) {
  constexpr double kFarthest = 0.5;  // m from H
  return std::any_of(motion.p_HF.begin(), motion.p_HF.end(), [](const Fingertips& tips) {
    return std::any_of(tips.begin(), tips.end(),
                       [](const Vector3d& p) { return !(p.norm() <= kFarthest); });
  });
}

// Fingers that open much wider than those that were shown are closed as hard as it takes. The
// learned way back to a contact is bent, and far away a bent way may lead past it: then straight.
std::optional<FingerMotion> FingersOf(const FingerRun& run, const std::vector<double>& acceleration,
                                      double dt) {
  constexpr double kMissed = 0.002;  // m, of a contact from T on
  constexpr int kTries = 28;
  const auto error = [&](const std::optional<FingerMotion>& motion) {
    return motion && !Astray(*motion) ? ContactError(run, *motion, dt)
                                      : std::numeric_limits<double>::infinity();
  };
  std::optional<FingerMotion> best = SimulateFingers(run, acceleration, dt);
  if (!run.hold || error(best) <= kMissed) return best;
  FingerRun straight = run;
  straight.bend.fill(Vector3d::Zero());
  for (const FingerRun* other : {&run, &std::as_const(straight)}) {
    std::optional<FingerMotion> motion = SimulateFingers(*other, acceleration, dt, kTries);
    if (error(motion) < error(best)) best = std::move(motion);
    if (error(best) <= kMissed) break;
  }
  return best;
}

}  // namespace

Vector3d MiddleOfContacts(const PerFinger<Contact>& contacts, const PerFinger<bool>& involved) {
  Vector3d others = Vector3d::Zero();
  int count = 0;
  for (int i = kIndex; i < kNumFingers; ++i) {
    if (!involved[i]) continue;
    others += contacts[i].p_OC;
    ++count;
  }
  return 0.5 * (contacts[kThumb].p_OC + others / std::max(1, count));
}

PerFinger<Contact> ContactsOn(const Grasp& grasp, const Shape& shape, double tip_radius,
                              const TriangleMesh* mesh) {
  PerFinger<Contact> contacts;
  for (int i = 0; i < kNumFingers; ++i) {
    if (!grasp.involved[i]) continue;
    const double off = tip_radius + grasp.clearance[i];
    if (const auto hit = mesh ? ContactOfRay(*mesh, grasp.rays[i], off)
                              : ContactOfRay(shape, grasp.rays[i], off)) {
      contacts[i] = *hit;
      continue;
    }
    // Eq. (6): on a sphere of the mean radius of the section orthogonal to the reach.
    const Vector3d start = StartPose(grasp.reach).translation();
    const Vector3d along = GoalPose(grasp.reach).translation() - start;
    const Vector3d n = grasp.rays[i].direction.normalized();
    contacts[i].n_O = n;
    contacts[i].p_OC = Vector3d(0, 0, grasp.rays[i].height * shape.size.z()) +
                       (SectionRadius(shape, mesh, along) + tip_radius) * n;
  }
  return contacts;
}

FingertipMotion GenerateMotion(const Grasp& given, const GenerateOptions& options) {
  const Grasp grasp = EncloseAlongAxis(given, options.shape);
  const double T = options.duration.value_or(grasp.scales.T);
  ThrowUnless(T > 0 && std::isfinite(T), "duration is {} s, expected a positive number", T);
  ThrowUnless(options.dt > 0 && options.dt <= 0.1 * T,
              "step is {} s, expected a positive number up to a tenth of the duration {} s",
              options.dt, T);

  FingertipMotion motion;
  motion.type = grasp.type;
  motion.involved = grasp.involved;
  motion.shape = options.shape;
  motion.X_WO = options.X_WO;
  motion.X_HG = grasp.X_HG;
  motion.hand_length = grasp.hand_length;
  motion.T = T;
  // Turning the reach about O's z is turning O under it; only the contacts' names in O change.
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(options.yaw, Vector3d::UnitZ()));
  const Pose X_WO = options.X_WO * MakePose(Vector3d::Zero(), turn);

  // Contacts on the new surface; G keeps its place among them.
  const bool plate = options.inset > 0 && grasp.type == "lateral" &&
                     options.shape.kind == Shape::Kind::kBox &&
                     grasp.shape.kind == Shape::Kind::kBox;
  const PerFinger<Contact> contacts =
      plate ? PlateContacts(grasp, options.shape, options.tip_radius, options.inset)
            : ContactsOn(grasp, options.shape, options.tip_radius, options.mesh.get());
  const PerFinger<Contact> learned = ContactsOn(grasp, grasp.shape, grasp.tip_radius);
  Vector3d shift = Vector3d::Zero();
  if (!options.object_centre) {
    shift = MiddleOfContacts(contacts, grasp.involved) - MiddleOfContacts(learned, grasp.involved);
  }
  Pose X_OG_goal = grasp.X_OH * grasp.X_HG;
  X_OG_goal.translation() += shift;
  Pose X_OG_start = StartPose(grasp.reach);
  X_OG_start.translation() += shift;
  if (options.X_WG_start) X_OG_start = X_WO.inverse() * *options.X_WG_start;
  motion.X_HO = grasp.X_HG * X_OG_goal.inverse() * MakePose(Vector3d::Zero(), turn.conjugate());

  // The reach (Eq. (10)-(13)).
  const int count = static_cast<int>(std::floor(1.5 * T / options.dt + 1e-9)) + 1;
  PoseDmp reach = WithEndpoints(grasp.reach, X_OG_start, X_OG_goal);
  reach.motion.tau = T;
  if (options.similar_reach) TurnForcing(grasp.reach, reach);
  const Pose X_GH = grasp.X_HG.inverse();
  const HandPath path = RollOutHand(reach, X_GH, T, options.dt, count);

  // The fingers, their gains restored for the new movement.
  FingerRun run;
  run.dim = grasp.dim;
  run.X_HP = grasp.X_HP;
  run.involved = grasp.involved;
  run.share = grasp.share;
  const Pose X_HO = grasp.X_HG * X_OG_goal.inverse();
  Vector3d moved = Vector3d::Zero();
  int involved = 0;
  for (int i = 0; i < kNumFingers; ++i) {
    run.p_HC[i] = grasp.offset[i];
    run.n_H[i].setZero();
    run.opening[i] = grasp.opening[i];
    run.lag[i] = grasp.lag[i] * T;
    run.p_HF[i] = grasp.offset[i];
    run.v_HF[i] = grasp.velocity[i] * (grasp.scales.T / T);
    motion.p_OC[i].setZero();
    motion.n_OC[i].setZero();
    if (!grasp.involved[i]) continue;
    run.p_HC[i] = X_HO * contacts[i].p_OC;
    run.n_H[i] = X_HO.linear() * contacts[i].n_O;
    run.p_HF[i] = run.p_HC[i] + grasp.offset[i];
    run.opening_bend[i] = grasp.opening_bend[i];
    run.bend[i] = grasp.bend[i];
    if (options.object_centre) {
      run.p_HF[i] = X_HO * learned[i].p_OC + grasp.offset[i];
      run.p_HC[i] = X_HO.translation();
      run.bend[i].setZero();  // of a way to a contact
    }
    motion.p_OC[i] = turn * contacts[i].p_OC;
    motion.n_OC[i] = turn * contacts[i].n_O;
    moved += run.p_HC[i];
    ++involved;
  }
  if (involved > 0 && grasp.dim == 2) run.X_HP.translation() = moved / involved;
  if (options.object_centre) {
    const Vector3d along = X_OG_goal.translation() - X_OG_start.translation();
    run.mean_radius = SectionRadius(options.shape, options.mesh.get(), along) + options.tip_radius;
  }
  for (const GraspEdge& edge : grasp.edges) {
    run.edges.emplace_back(edge.i, edge.j);
    run.rest_lengths.push_back(edge.rest_length);
  }
  ReachScales scales = grasp.scales;
  scales.T = T;
  // A start next to the object would ask for a boundless gain.
  const Vector3d from = (path.X_OG.front() * X_GH).translation();
  scales.A = std::max(0.5 * grasp.scales.A, (from - (X_OG_goal * X_GH).translation()).norm());
  run.gains = GainsFor(grasp, scales);
  run.ambient_damping = grasp.ambient_damping * (grasp.scales.T / T);
  run.ratio = grasp.ratio;
  run.max_ratio = grasp.max_ratio;
  run.hold = grasp.profile == "human";
  run.T = T;
  run.t_switch = grasp.switch_rule == "fitted" ? grasp.t_switch * T : path.t_switch;
  motion.t_switch = run.t_switch + run.gains.delay;
  const auto fingers = FingersOf(run, path.acceleration, options.dt);
  ThrowUnless(fingers.has_value(),
              "{}: the fingertip springs run away (kc {} N/m, dc {} N s/m, gamma {} kg, T {} s)",
              grasp.name, run.gains.kc, run.gains.dc, run.gains.gamma, T);

  if (options.object_centre) {
    // The contacts are where the springs came to rest.
    for (int i = 0; i < kNumFingers; ++i) {
      if (!grasp.involved[i]) continue;
      motion.p_OC[i] = motion.X_HO.inverse() * fingers->p_HF.back()[i];
      motion.n_OC[i] = motion.p_OC[i].normalized();
    }
  }
  for (int n = 0; n < count; ++n) {
    const auto k = static_cast<std::size_t>(n);
    FingertipMotionSample sample;
    sample.t = n * options.dt;
    sample.X_WG = X_WO * path.X_OG[k];
    sample.X_WH = sample.X_WG * X_GH;
    sample.f_cen = fingers->f_cen[k];
    sample.p_HF = fingers->p_HF[k];
    motion.samples.push_back(sample);
  }
  return motion;
}

}  // namespace springgrasp
