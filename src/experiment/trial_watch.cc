#include "experiment/trial_watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "sim/model_index.h"

namespace springgrasp {
namespace {

constexpr double kLostAfter = 0.2;       // s without any hand contact: the object is lost
constexpr double kLostBeyond = 0.08;     // m moved in the hand: the object is lost
constexpr double kOpposedWindow = 0.02;  // s, to see the first opposed contact

double TiltDeg(const Pose& a, const Pose& b) {
  return RotationDistance(Eigen::Quaterniond(a.linear()), Eigen::Quaterniond(b.linear())) * 180 /
         std::numbers::pi;
}

// Torsional friction of a body's first geom, m.
double TorsionOf(const mjModel& model, int body) {
  return model.body_geomnum[body] > 0 ? model.geom_friction[3 * model.body_geomadr[body] + 1] : 0;
}

}  // namespace

TrialWatch::TrialWatch(const Simulation& simulation, const RobotIo& robot, int object,
                       const TrialCriteria& criteria, Performance& performance)
    : simulation_(simulation),
      robot_(robot),
      object_(object),
      criteria_(criteria),
      performance_(performance),
      roles_(ClassifyGeoms(simulation.model())),
      torsion_(TorsionOf(simulation.model(), object)),
      window_(roles_, object),
      opposed_window_(roles_, object),
      X_WO_start_(ObjectPose()) {}

Pose TrialWatch::ObjectPose() const {
  return ReadBodyState(simulation_.model(), simulation_.data(), object_).X_WB;
}
Pose TrialWatch::ObjectInHand() const {
  return robot_.HandPose(simulation_).inverse() * ObjectPose();
}

void TrialWatch::Record(Outcome outcome, const std::string& message) {
  performance_.events.push_back({simulation_.time(), outcome, message});
}

void TrialWatch::Settled() { X_WO_start_ = ObjectPose(); }
void TrialWatch::Gripped() { X_HO_grip_ = ObjectInHand(); }

void TrialWatch::Step(double dt) {
  if (simulation_.diverged()) {
    Record(Outcome::kDiverged, simulation_.diverged()->warning);
    over_ = true;
    return;
  }
  const Pose X_WO = ObjectPose();
  const Pose X_WH = robot_.HandPose(simulation_);
  window_.Add(simulation_.contacts(), X_WO, X_WH, torsion_, dt);
  WatchTable();
  if (!opposed_) WatchFirstContact(X_WO, X_WH, dt);
  if (performance_.reached >= Phase::kLift && !released_) WatchHeld(X_WO, X_WH, dt);
}

void TrialWatch::WatchTable() {
  double tips = 0, others = 0;
  for (const ContactPoint& c : simulation_.contacts()) {
    const GeomRole &a = roles_[c.geom1], &b = roles_[c.geom2];
    const auto is_support = [](const GeomRole& r) {
      return r.part == GeomPart::kTable || r.part == GeomPart::kRing || r.part == GeomPart::kFloor;
    };
    const GeomRole& robot_part = is_support(a) ? b : a;
    if (is_support(a) == is_support(b)) continue;
    if (robot_part.part == GeomPart::kFinger && robot_part.phalanx == 1)
      tips += c.normal_force;
    else if (robot_part.hand() || robot_part.part == GeomPart::kArm)
      others += c.normal_force;
  }
  if (tips > criteria_.max_tip_table_force || others > criteria_.max_table_force) {
    Record(Outcome::kCollided,
           fmt::format("table or ring touched with {:.1f} N in {}", std::max(tips, others),
                       PhaseName(performance_.reached)));
    over_ = true;
  }
}

// Bodies of the robot that touch the object now, for messages.
std::string TrialWatch::Touching() const {
  std::string names;
  for (const ContactPoint& c : simulation_.contacts()) {
    const int other = c.body1 == object_ ? c.body2 : c.body2 == object_ ? c.body1 : -1;
    if (other < 0) continue;
    const std::string name = NameOf(simulation_.model(), mjOBJ_BODY, other);
    if (names.find(name) == std::string::npos) names += (names.empty() ? "" : ", ") + name;
  }
  return names.empty() ? "nothing" : names;
}

void TrialWatch::WatchFirstContact(const Pose& X_WO, const Pose& X_WH, double dt) {
  opposed_window_.Add(simulation_.contacts(), X_WO, X_WH, torsion_, dt);
  const double moved = (X_WO.translation() - X_WO_start_.translation()).norm();
  const double tilt = TiltDeg(X_WO, X_WO_start_);
  if (performance_.reached > Phase::kSettle &&
      (moved > criteria_.max_early_motion || tilt > criteria_.max_early_tilt_deg)) {
    Record(Outcome::kCollided,
           fmt::format("object moved {:.0f} mm and tilted {:.0f} degrees before the first "
                       "opposed contact, in {}, touching {}",
                       1e3 * moved, tilt, PhaseName(performance_.reached), Touching()));
    over_ = true;
    return;
  }
  const ContactWindow window = opposed_window_.Mean();
  if (window.duration >= kOpposedWindow) {
    opposed_ = IsOpposed(window, criteria_);
    opposed_window_.Clear();
  }
}

// Slip since the end of the grip, and whether the object is still there.
void TrialWatch::WatchHeld(const Pose& X_WO, const Pose& X_WH, double dt) {
  const Pose X_HO = X_WH.inverse() * X_WO;
  const double slip = (X_HO.translation() - X_HO_grip_.translation()).norm();
  const double rotation =
      RotationDistance(Eigen::Quaterniond(X_HO.linear()), Eigen::Quaterniond(X_HO_grip_.linear()));
  performance_.slip = std::max(performance_.slip, slip);
  performance_.rotation = std::max(performance_.rotation, rotation);
  if (!slip_ &&
      (slip > criteria_.max_slip || rotation * 180 / std::numbers::pi > criteria_.max_slip_deg)) {
    slip_ =
        TrialEvent{simulation_.time(), Outcome::kSlipped,
                   fmt::format("{:.0f} mm and {:.0f} degrees in the hand, in {}", 1e3 * slip,
                               rotation * 180 / std::numbers::pi, PhaseName(performance_.reached))};
  }
  const bool touched = std::any_of(simulation_.contacts().begin(), simulation_.contacts().end(),
                                   [&](const ContactPoint& c) {
                                     return (c.body1 == object_ && roles_[c.geom2].hand()) ||
                                            (c.body2 == object_ && roles_[c.geom1].hand());
                                   });
  untouched_ = touched ? 0 : untouched_ + dt;
  if (untouched_ > kLostAfter || slip > kLostBeyond) Dropped("the hand lost the object");
}

void TrialWatch::Dropped(const std::string& message) {
  if (over_) return;
  const Phase phase = performance_.reached;
  const Outcome outcome = phase == Phase::kLift    ? Outcome::kDroppedLift
                          : phase == Phase::kHold  ? Outcome::kDroppedHold
                          : phase == Phase::kPlace ? Outcome::kDroppedPlace
                                                   : Outcome::kDroppedDisturb;
  // A fall begins as a slip; the fall is what counts.
  slip_.reset();
  Record(outcome, message);
  over_ = true;
}

}  // namespace springgrasp
