#include "experiment/verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace springgrasp {
namespace {

double AngleDeg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const double scale = a.norm() * b.norm();
  if (scale < 1e-12) return 0;
  return std::acos(std::clamp(a.dot(b) / scale, -1.0, 1.0)) * 180 / std::numbers::pi;
}

double Opposition(const ContactWindow& w, bool with_palm) {
  Eigen::Vector3d others = with_palm ? w.palm_f_H : Eigen::Vector3d(Eigen::Vector3d::Zero());
  for (int f = kIndex; f < kNumFingers; ++f) others += w.f_H[f];
  return AngleDeg(w.f_H[kThumb], others);
}

// Weight together with each of the forces of `disturb`.
std::vector<Eigen::Matrix<double, 6, 1>> DisturbedWeights(const Eigen::Matrix3d& R_WO,
                                                          const TrialCriteria& criteria) {
  constexpr double kGravity = 9.81;
  std::vector<Eigen::Matrix<double, 6, 1>> tasks;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {1.0, -1.0}) {
      const Eigen::Vector3d f_W = sign * criteria.force_per_mass * Eigen::Vector3d::Unit(axis) -
                                  kGravity * Eigen::Vector3d::UnitZ();
      if (f_W.norm() < 1) continue;  // it bears the weight
      tasks.push_back(Eigen::Matrix<double, 6, 1>::Zero());
      tasks.back().head<3>() = R_WO.transpose() * f_W.normalized();
    }
  }
  return tasks;
}

}  // namespace

bool IsOpposed(const ContactWindow& window, const TrialCriteria& criteria) {
  if (window.normal[kThumb] < criteria.contact_force) return false;
  const bool other = window.palm_normal >= criteria.contact_force ||
                     std::any_of(window.normal.begin() + 1, window.normal.end(),
                                 [&](double n) { return n >= criteria.contact_force; });
  return other && Opposition(window, true) >= criteria.min_opposition_deg;
}

ContactCheck CheckContacts(const std::string& type, const ContactWindow& w, const Shape& shape,
                           const TrialCriteria& criteria) {
  ContactCheck check;
  const bool power = type == "power";
  PerFinger<bool> counted = {};
  counted[kThumb] = true;
  if (!power) counted[kIndex] = true;
  if (type == "tripod") counted[kMiddle] = true;

  // Which fingers must touch.
  if (power) {
    int fingers = 0;
    for (int f = kIndex; f < kNumFingers; ++f) {
      counted[f] = w.normal[f] >= criteria.contact_force;
      fingers += counted[f];
    }
    double palm = w.palm_normal;
    if (std::min(shape.size.x(), shape.size.y()) >= criteria.palm_like_size) {
      for (int f = kIndex; f < kNumFingers; ++f) palm += w.proximal_normal[f];
    }
    const bool palm_touches = palm >= criteria.contact_force;
    if (w.normal[kThumb] < criteria.contact_force) {
      check.reason = "thumb does not touch";
    } else if (fingers < 2 || (fingers < 3 && !palm_touches)) {
      check.reason = fmt::format(
          "{} fingers besides the thumb and {} palm, at least 2 with the "
          "palm or 3 are needed",
          fingers, palm_touches ? "the" : "no");
    }
  } else {
    double other = w.palm_normal;
    for (int f = 0; f < kNumFingers; ++f) {
      if (counted[f] && w.normal[f] < criteria.contact_force && check.reason.empty()) {
        check.reason = fmt::format("{} does not touch", kFingerNames[f]);
      }
      if (!counted[f]) other += w.normal[f];
    }
    if (check.reason.empty() && type != "lateral" &&
        other > criteria.max_other_load * w.total_normal) {
      check.reason = fmt::format("other parts of the hand bear {:.0f} % of the load",
                                 100 * other / w.total_normal);
    }
    if (check.reason.empty() && type == "lateral") {
      // Radial axis of the index: y of H, which its flexion leaves alone; there it presses.
      const double from_radial = AngleDeg(w.f_H[kIndex], Eigen::Vector3d::UnitY());
      if (w.normal[kThumb] - w.proximal_normal[kThumb] < criteria.contact_force) {
        check.reason = "the thumb's last phalanx does not touch";
      } else if (w.normal[kIndex] - w.proximal_normal[kIndex] < criteria.contact_force) {
        check.reason = "the index's last phalanx does not touch";
      } else if (from_radial > 45) {
        check.reason =
            fmt::format("index touched {:.0f} degrees from its radial side", from_radial);
      }
    }
  }

  check.opposition_deg = Opposition(w, power);
  std::vector<QualityContact> contacts;
  for (const MeanContact& c : w.contacts) {
    const bool is_counted = c.role.part == GeomPart::kPalm ? power : counted[c.role.finger];
    if (is_counted) contacts.push_back(c.geometry);
  }
  const GraspQuality6d quality =
      EvaluateGraspQuality(contacts, shape.size.maxCoeff() / 2, DisturbedWeights(w.R_WO, criteria));
  check.epsilon = quality.epsilon;
  check.volume = quality.volume;
  check.task = quality.task;
  if (check.reason.empty() && check.opposition_deg < criteria.min_opposition_deg) {
    check.reason =
        fmt::format("thumb and fingers are opposed by {:.0f} degrees only", check.opposition_deg);
  }
  if (check.reason.empty() && !(check.epsilon > 0)) {
    check.reason = "the contacts alone do not close";
  }
  check.ok = check.reason.empty();
  return check;
}

TrialEvent DecideOutcome(const std::vector<TrialEvent>& events) {
  const auto is_fatal = [](const TrialEvent& e) {
    return e.outcome == Outcome::kError || e.outcome == Outcome::kDiverged;
  };
  for (const TrialEvent& e : events) {
    if (is_fatal(e)) return e;
  }
  const auto earliest =
      std::min_element(events.begin(), events.end(),
                       [](const TrialEvent& a, const TrialEvent& b) { return a.t < b.t; });
  return earliest == events.end() ? TrialEvent{} : *earliest;
}

}  // namespace springgrasp
