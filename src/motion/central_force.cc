#include "motion/central_force.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace springgrasp {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Index i with t[i] <= time < t[i + 1], guessed as for even samples first.
Index FindInterval(const VectorXd& t, double time) {
  const Index last = t.size() - 2;
  const double step = (t[t.size() - 1] - t[0]) / static_cast<double>(t.size() - 1);
  const Index guess = std::clamp<Index>(static_cast<Index>((time - t[0]) / step), 0, last);
  for (Index i = std::max<Index>(guess - 1, 0); i <= std::min(guess + 1, last); ++i) {
    if (t[i] <= time && time < t[i + 1]) return i;
  }
  const double* found = std::upper_bound(t.data(), t.data() + t.size(), time);
  return std::clamp<Index>(found - t.data() - 1, 0, last);
}

// Linear between the points, end values held.
double Interpolate(const VectorXd& t, const VectorXd& values, double time) {
  if (time <= t[0] || t.size() == 1) return values[0];
  if (time >= t[t.size() - 1]) return values[t.size() - 1];
  const Index i = FindInterval(t, time);
  const double fraction = (time - t[i]) / (t[i + 1] - t[i]);
  return values[i] + fraction * (values[i + 1] - values[i]);
}

void RequireIncreasing(const VectorXd& t, const char* what) {
  ThrowUnless(t.size() > 0 && t.allFinite(), "{}: times missing or not finite", what);
  for (Index i = 1; i < t.size(); ++i) {
    ThrowUnless(t[i] > t[i - 1], "{}: times must increase; {} follows {}", what, t[i], t[i - 1]);
  }
}

// From -1 to 1 over `width` around zero; a sharp step that is 1 at zero if width is 0.
double BlendedSign(double t, double width) {
  if (t >= 0.5 * width) return 1;
  if (t < -0.5 * width) return -1;
  const double x = t / width + 0.5;
  return 2 * x * x * x * (10 - x * (15 - 6 * x)) - 1;
}

}  // namespace

double SwitchTime(const VectorXd& t, const Eigen::MatrixXd& v) {
  ThrowUnless(t.size() > 0 && v.rows() == t.size(), "switch time: {} times, {} velocities",
              t.size(), v.rows());
  Index best = 0;
  for (Index i = 1; i < t.size(); ++i) {
    if (v.row(i).squaredNorm() > v.row(best).squaredNorm()) best = i;
  }
  return t[best];
}

CentralForce MakeCentralForce(const MotionSamples& motion, double gamma, std::optional<double> T) {
  RequireIncreasing(motion.t, "central force");
  ThrowUnless(motion.a.rows() == motion.t.size(), "central force: {} times, {} accelerations",
              motion.t.size(), motion.a.rows());
  CentralForce force;
  force.t = motion.t;
  force.a = motion.a.rowwise().norm();
  force.T = T.value_or(motion.t[motion.t.size() - 1]);
  force.t_switch = SwitchTime(motion.t, motion.v);
  force.gamma = gamma;
  return force;
}

namespace {

// gamma |a| at t, after the delay; 0 outside the table.
double Magnitude(const CentralForce& force, double t) {
  const double time = t - force.delay;
  if (time < force.t[0] || time > force.t[force.t.size() - 1]) return 0;
  return force.gamma * Interpolate(force.t, force.a, time);
}

// With the sign that it has at t, changed `lag` after the switch.
double SignedForce(const CentralForce& force, double magnitude, double lag, double t) {
  const double closes = force.t_switch + force.delay + lag;
  double f = BlendedSign(t - closes, force.blend) * magnitude;
  if (f > 0) f *= force.beta;
  if (force.hold <= 0) return f;
  if (t >= force.T) return std::max(f, force.hold);
  if (!force.ramp || t <= closes) return f;
  const double x = (t - closes) / (force.T - closes);
  return std::max(f, force.hold * x * x * (3 - 2 * x));
}

}  // namespace

double EvaluateCentralForce(const CentralForce& force, double t) {
  return SignedForce(force, Magnitude(force, t), 0, t);
}

void EvaluateCentralForces(const CentralForce& force, double t, VectorXd& f) {
  const double magnitude = Magnitude(force, t);
  for (Index i = 0; i < f.size(); ++i) {
    f[i] = SignedForce(force, magnitude, i < force.lag.size() ? force.lag[i] : 0, t);
  }
}

std::vector<double> CentralForceKinks(const CentralForce& force) {
  std::vector<double> kinks = {force.t[0] + force.delay, force.T,
                               force.t[force.t.size() - 1] + force.delay};
  for (Index i = 0; i < std::max<Index>(1, force.lag.size()); ++i) {
    const double closes = force.t_switch + force.delay + (i < force.lag.size() ? force.lag[i] : 0);
    for (const double part : {-0.5, 0.0, 0.5}) kinks.push_back(closes + part * force.blend);
  }
  std::sort(kinks.begin(), kinks.end());
  kinks.erase(std::unique(kinks.begin(), kinks.end()), kinks.end());
  return kinks;
}

ForceProfile MakeForceProfile(const CentralForce& force) {
  RequireIncreasing(force.t, "central force");
  ThrowUnless(force.a.size() == force.t.size(), "central force: {} times, {} accelerations",
              force.t.size(), force.a.size());
  ForceProfile profile = {[force](double t) { return EvaluateCentralForce(force, t); },
                          CentralForceKinks(force)};
  if (force.lag.size() > 0) {
    profile.each = [force](double t, VectorXd& f) { EvaluateCentralForces(force, t, f); };
  }
  return profile;
}

ForceProfile MakeForceProfile(const VectorXd& t, const VectorXd& f) {
  RequireIncreasing(t, "force table");
  ThrowUnless(t.size() == f.size(), "force table: {} times, {} forces", t.size(), f.size());
  return {[t, f](double time) { return Interpolate(t, f, time); },
          std::vector<double>(t.data(), t.data() + t.size())};
}

ForceProfile MakeForceProfile(const std::vector<double>& f, double dt) {
  const auto n = static_cast<Index>(f.size());
  VectorXd t(n);
  for (Index i = 0; i < n; ++i) t[i] = static_cast<double>(i) * dt;
  return MakeForceProfile(t, Eigen::Map<const VectorXd>(f.data(), n));
}

ForceProfile ConstantForce(double f) {
  return {[f](double) { return f; }, {}};
}

}  // namespace springgrasp
