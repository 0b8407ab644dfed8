#include "grasp/generate_fingers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "grasp/spring_integrator.h"
#include "motion/minimum_jerk.h"

namespace springgrasp {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

// Of T, over which the central force changes its sign. Profile paper: spring-model note, section 6.
// Profile human: the hand comes to rest at its widest, as people's do; chosen on tracked
// demonstrations of the four types, seeds 1 and 2.
constexpr double kBlend = 0.05, kCalmBlend = 0.2;

}  // namespace

MatrixXd SystemPoints(const FingerRun& run, const std::vector<int>& fingers, const Fingertips& p_H,
                      bool direction) {
  MatrixXd points(run.dim, static_cast<Eigen::Index>(fingers.size()));
  const Pose X_PH = run.dim == 2 ? run.X_HP.inverse() : Pose::Identity();
  for (std::size_t n = 0; n < fingers.size(); ++n) {
    const Vector3d& p = p_H[fingers[n]];
    const Vector3d q = direction ? Vector3d(X_PH.linear() * p) : Vector3d(X_PH * p);
    points.col(static_cast<Eigen::Index>(n)) = q.head(run.dim);
  }
  return points;
}

namespace {

// Outward normals (unit), or the preshape in units of its mean length.
MatrixXd OpeningDirections(const FingerRun& run, const std::vector<int>& fingers) {
  double length = 0, count = 0;
  for (int i = 0; i < kNumFingers; ++i) {
    if (!run.involved[i]) continue;
    length += run.share[i] * run.opening[i].norm();
    count += run.share[i];
  }
  if (length > 0) return SystemPoints(run, fingers, run.opening, true) * (count / length);
  MatrixXd normals = SystemPoints(run, fingers, run.n_H, true);
  for (Eigen::Index n = 0; n < normals.cols(); ++n) {
    const double norm = normals.col(n).norm();
    if (norm > 1e-6) normals.col(n) /= norm;  // in the plane a normal gets shorter
  }
  return normals;
}

}  // namespace

SpringSystem MakeSystem(const FingerRun& run, const std::vector<int>& fingers) {
  const int count = static_cast<int>(fingers.size());
  SpringSystem system = MakeSpringSystem(count, run.dim, run.gains.mass);
  const auto position = [&](int finger) {
    const auto found = std::find(fingers.begin(), fingers.end(), finger);
    return found == fingers.end() ? -1 : static_cast<int>(found - fingers.begin());
  };
  for (std::size_t e = 0; e < run.edges.size(); ++e) {
    const int i = position(run.edges[e].first);
    const int j = position(run.edges[e].second);
    if (i < 0 || j < 0) continue;
    system.springs.push_back({i, j, run.gains.k[e], run.rest_lengths[e], run.gains.d[e]});
  }
  system.anchors = SystemPoints(run, fingers, run.p_HC);
  system.normals = OpeningDirections(run, fingers);
  system.opening_bend = SystemPoints(run, fingers, run.opening_bend, true);
  system.bend = SystemPoints(run, fingers, run.bend, true);
  for (int n = 0; n < count; ++n) {
    const int finger = fingers[static_cast<std::size_t>(n)];
    system.involved[static_cast<std::size_t>(n)] = run.involved[finger];
    system.share[n] = run.share[finger];
    system.rest_radius[n] = run.mean_radius;
  }
  system.kc = run.gains.kc;
  system.dc = run.gains.dc;
  system.d0 = run.ambient_damping;
  system.r_max = run.max_ratio;
  system.ratio = run.ratio == "paper"        ? ForceRatio::kPaper
                 : run.ratio == "reciprocal" ? ForceRatio::kReciprocal
                                             : ForceRatio::kBalanced;
  system.opening = OpeningDirection::kOutward;
  return system;
}

CentralForce MakeRunForce(const FingerRun& run, const std::vector<int>& fingers,
                          const std::vector<double>& acceleration, double dt) {
  CentralForce force;
  // The reach's acceleration after T is the primitive settling; the holding force takes over.
  const auto last = static_cast<Eigen::Index>(std::floor(run.T / dt + 1e-9));
  const Eigen::Index count =
      std::min<Eigen::Index>(last + 1, static_cast<Eigen::Index>(acceleration.size()));
  force.t = VectorXd::LinSpaced(count, 0, static_cast<double>(count - 1) * dt);
  force.a = VectorXd::Map(acceleration.data(), count);
  force.T = run.T;
  force.t_switch = run.t_switch;
  force.gamma = run.gains.gamma;
  force.blend = (run.hold ? kCalmBlend : kBlend) * run.T;
  force.delay = run.gains.delay;
  force.beta = run.gains.closing;
  if (std::any_of(run.lag.begin(), run.lag.end(), [](double lag) { return lag != 0; })) {
    force.lag.resize(static_cast<Eigen::Index>(fingers.size()));
    for (std::size_t n = 0; n < fingers.size(); ++n) {
      force.lag[static_cast<Eigen::Index>(n)] = run.lag[fingers[n]];
    }
  }
  if (!run.hold) return force;
  force.hold = HoldingForce(run);
  force.ramp = true;
  return force;
}

double HoldingForce(const FingerRun& run) {
  // Largest pull of the springs between involved fingers on one of them at its contact. The other
  // fingers are free to follow.
  Fingertips pull;
  pull.fill(Vector3d::Zero());
  for (std::size_t e = 0; e < run.edges.size(); ++e) {
    const auto [i, j] = run.edges[e];
    if (!run.involved[i] || !run.involved[j]) continue;
    const Vector3d d = run.p_HC[i] - run.p_HC[j];
    const double r = std::max(d.norm(), 1e-6);
    const double held = std::min(run.share[i], run.share[j]);
    const Vector3d force = held * run.gains.k[e] * (1 - run.rest_lengths[e] / r) * d;
    pull[i] -= force;
    pull[j] += force;
  }
  double largest = 0;
  for (const Vector3d& p : pull) largest = std::max(largest, p.norm());
  // At 1 mm the direction of the central force has length 0.7 (soft norm of 1 mm).
  return std::max(run.gains.holding, 1.5 * largest);
}

namespace {

// One run under a given holding force.
std::optional<FingerMotion> SimulateHeld(const FingerRun& run,
                                         const std::vector<double>& acceleration, double dt,
                                         double hold) {
  const std::vector<int> fingers = {0, 1, 2, 3, 4};
  const SpringSystem system = MakeSystem(run, fingers);
  CentralForce force = MakeRunForce(run, fingers, acceleration, dt);
  force.hold = hold;
  const ForceProfile profile = MakeForceProfile(force);

  const auto count = static_cast<Eigen::Index>(acceleration.size());
  const VectorXd times = VectorXd::LinSpaced(count, 0, static_cast<double>(count - 1) * dt);
  SpringIntegration integration;
  // The contact is stiff under a closing force: steps that follow T keep the scaling by time exact.
  integration.step = std::min(dt, 0.004 * run.T);
  const auto trajectory =
      IntegrateSprings(system, profile, SystemPoints(run, fingers, run.p_HF),
                       SystemPoints(run, fingers, run.v_HF, true), times, integration);
  if (!trajectory) return std::nullopt;

  FingerMotion motion;
  const Pose X_PH = run.X_HP.inverse();
  for (Eigen::Index n = 0; n < count; ++n) {
    Fingertips tips;
    for (int i = 0; i < kNumFingers; ++i) {
      const VectorXd p = trajectory->Point(n, i, run.dim);
      if (run.dim == 3) {
        tips[i] = p;
        continue;
      }
      // Out of the plane: from the start to the contact by minimum jerk (system contract 5.5).
      const double from = (X_PH * run.p_HF[i]).z();
      const double to = run.involved[i] ? (X_PH * run.p_HC[i]).z() : from;
      const double s = MinimumJerkPosition(std::min(1.0, times[n] / run.T));
      tips[i] = run.X_HP * Vector3d(p[0], p[1], from + (to - from) * s);
    }
    motion.p_HF.push_back(tips);
    motion.f_cen.push_back(profile.f(times[n]));
  }
  return motion;
}

}  // namespace

double ContactError(const FingerRun& run, const FingerMotion& motion, double dt) {
  const auto n =
      std::min(static_cast<std::size_t>(std::lround(run.T / dt)), motion.p_HF.size() - 1);
  double error = 0;
  for (std::size_t k = n; k < motion.p_HF.size(); ++k) {
    for (int i = 0; i < kNumFingers; ++i) {
      if (!run.involved[i] || run.share[i] < 1) continue;  // who takes part in part may hover
      const double distance = (motion.p_HF[k][i] - run.p_HC[i]).norm();
      error = std::max(error, std::abs(distance - run.mean_radius));
    }
  }
  return error;
}

std::optional<FingerMotion> SimulateFingers(const FingerRun& run,
                                            const std::vector<double>& acceleration, double dt,
                                            int tries) {
  constexpr double kLanded = 0.001;  // m
  constexpr int kHalvings = 6;
  constexpr double kHarder = 1.5;
  double hold = run.hold ? HoldingForce(run) : 0;
  std::optional<FingerMotion> best;
  double best_error = std::numeric_limits<double>::infinity();
  const auto lands = [&](double force) {
    auto motion = SimulateHeld(run, acceleration, dt, force);
    if (!motion) return false;
    const double error = ContactError(run, *motion, dt);
    const bool landed = error <= kLanded;
    if (landed || error < best_error) {
      best_error = error;
      best = std::move(motion);
    }
    return landed;
  };
  // A hand that is slow against its reach is late at the contacts: it is closed harder, just as
  // hard as it takes, so that similar movements get similar forces.
  if (lands(hold) || !run.hold) return best;
  for (int n = 1; n < tries; ++n) {
    double late = hold;
    hold *= kHarder;
    if (!lands(hold)) continue;
    for (int k = 0; k < kHalvings; ++k) {
      const double middle = std::sqrt(late * hold);
      (lands(middle) ? hold : late) = middle;
    }
    break;
  }
  return best;
}

}  // namespace springgrasp
