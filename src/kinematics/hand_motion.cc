#include "kinematics/hand_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "kinematics/shape_distance.h"
#include "motion/minimum_jerk.h"

namespace springgrasp {
namespace {

constexpr PerFinger<bool> kAllFingers = {true, true, true, true, true};
constexpr int kOpenings = 10;        // tried degrees of opening
constexpr double kSmoothing = 0.02;  // s, half width of the final moving average
constexpr double kHold = 0.05;       // s, an opening is kept this long after its need
constexpr double kAhead = 0.2;       // of T, an opening is finished this much before

double Clearance(const RobotHand& robot, const Shape& shape, const Pose& X_OH,
                 const Eigen::VectorXd& q, std::vector<Pose>& X_HB) {
  ForwardKinematics(robot.tree, q, X_HB);
  return HandDistance(robot, X_HB, X_OH, shape, kAllFingers, true);
}

// Moving average over +-half samples, twice, ends held.
template <typename T>
void Smooth(std::vector<T>& series, int half) {
  const int n = static_cast<int>(series.size());
  std::vector<T> copy;
  for (int pass = 0; pass < 2; ++pass) {
    copy = series;
    for (int k = 0; k < n; ++k) {
      T sum = copy[std::clamp(k - half, 0, n - 1)];
      for (int i = -half + 1; i <= half; ++i) sum += copy[std::clamp(k + i, 0, n - 1)];
      series[k] = sum / (2 * half + 1);
    }
  }
}

// Samples to each side of the final moving average.
int SmoothingHalf(double dt) { return std::max(1, static_cast<int>(kSmoothing / 2 / dt)); }

// The average reaches two half widths back: contact is planned that much before T.
double ContactTime(const HandMotionRequest& request) {
  return request.T - 2 * SmoothingHalf(request.dt) * request.dt;
}

// 0: human-like, 1: on the contacts.
double ContactBlend(const HandMotionRequest& request, int k) {
  const double t_contact = ContactTime(request);
  const double t_close = std::min(request.t_switch, 0.7 * t_contact);
  return MinimumJerkPosition((request.dt * k - t_close) / (t_contact - t_close));
}

// The springs open a hand wider than a finger reaches, and near its full length a finger has to
// move its joints ever faster to follow. Wanted tips beyond kFree of its length, in the plane in
// which it bends, are drawn in smoothly, at most to kLongest.
Eigen::Vector3d DrawnIn(const RobotHand& robot, const std::vector<Pose>& X_HB, int finger,
                        const Eigen::Vector3d& p_HF) {
  constexpr double kFree = 0.8, kLongest = 0.95;
  const RobotHand::Finger& f = robot.fingers[finger];
  const Pose& X_HBase = X_HB[f.base];
  const Eigen::Vector3d axis = X_HBase.linear() * robot.tree.nodes[f.base].axis;
  const Eigen::Vector3d reach = p_HF - X_HBase.translation();
  const Eigen::Vector3d beside = axis.dot(reach) * axis, in_plane = reach - beside;
  const double r = in_plane.norm() / f.length;
  if (r <= kFree) return p_HF;
  const double room = kLongest - kFree;
  const double drawn = kFree + room * std::tanh((r - kFree) / room);
  return X_HBase.translation() + beside + drawn / r * in_plane;
}

// How far one finger must open (0..1 towards `q_open`) at each sample to stay clear. What even the
// open finger does not have is not asked.
std::vector<double> Openings(const RobotHand& robot, const HandMotionRequest& request,
                             const HandMotionOptions& options, const Eigen::VectorXd& q_open,
                             const std::vector<Eigen::VectorXd>& q, int finger, double t_contact) {
  const int n = static_cast<int>(q.size());
  PerFinger<bool> only = {};
  only[finger] = true;
  std::vector<double> needed(n, 0.0);
  std::vector<Pose> X_HB;
  const auto clearance = [&](int k, double opening) {
    ForwardKinematics(robot.tree, q[k] + opening * (q_open - q[k]), X_HB);
    return HandDistance(robot, X_HB, request.X_OH[k], request.shape, only, false);
  };
  for (int k = 0; k < n; ++k) {
    const double left = (t_contact - request.dt * k) / (options.closing * request.T);
    if (left <= 0) break;
    const double wanted = options.clearance * std::min(1.0, left);
    double best = clearance(k, 0);
    for (int i = 1; i <= kOpenings && best < wanted; ++i) {
      const double opening = static_cast<double>(i) / kOpenings;
      const double found = clearance(k, opening);
      if (found < best + 1e-5) continue;
      best = found;
      needed[k] = opening;
    }
  }
  // Open well before the need, since the way open leads through where the object will be; held as
  // far as the average reaches, so that it stays enough.
  const int half = std::max(1, static_cast<int>(kHold / 2 / request.dt));
  const int ahead = 2 * half + static_cast<int>(kAhead * request.T / request.dt);
  std::vector<double> held(n, 0.0);
  for (int k = 0; k < n; ++k) {
    for (int i = std::max(0, k - 2 * half); i <= std::min(n - 1, k + ahead); ++i) {
      held[k] = std::max(held[k], needed[i]);
    }
  }
  Smooth(held, half);
  for (int k = 0; k < n; ++k) {
    held[k] *=
        MinimumJerkPosition((t_contact - request.dt * k) / (0.5 * options.closing * request.T));
  }
  return held;
}

// No joint faster than `step` per sample: what comes later is kept, what was before gives way.
void LimitSteps(double step, std::vector<Eigen::VectorXd>& q) {
  for (std::size_t k = q.size() - 1; k-- > 0;) {
    q[k] = q[k].cwiseMin((q[k + 1].array() + step).matrix());
    q[k] = q[k].cwiseMax((q[k + 1].array() - step).matrix());
  }
}

}  // namespace

Eigen::VectorXd OpenedPosture(const RobotHand& robot, const ContactPosture& posture,
                              const Shape& shape, const PerFinger<bool>& involved,
                              double clearance) {
  const Pose X_OH = posture.X_HO.inverse();
  std::vector<Pose> X_HB;
  Eigen::VectorXd q = posture.q;
  for (int f = 0; f < kNumFingers; ++f) {
    if (!involved[f]) continue;
    PerFinger<bool> only = {};
    only[f] = true;
    // The proximal joint opens first, then the distal one.
    for (const int j : {robot.fingers[f].j0, robot.fingers[f].j1}) {
      const double from = q[j], to = std::min(from, robot.open[j]);
      for (int i = 1; i <= 2 * kOpenings; ++i) {
        ForwardKinematics(robot.tree, q, X_HB);
        if (HandDistance(robot, X_HB, X_OH, shape, only, false) >= clearance) break;
        q[j] = from + (to - from) * i / (2 * kOpenings);
      }
    }
  }
  return q;
}

std::vector<MappingTarget> MappingTargets(const HumanHand& human, const RobotHand& robot,
                                          const HandMotionRequest& request,
                                          const HandMotionOptions& options) {
  const int n = static_cast<int>(request.q_human.size());
  ThrowUnless(n > 0 && request.p_HF.size() == request.q_human.size() &&
                  request.X_OH.size() == request.q_human.size(),
              "a hand motion needs as many joint samples ({}) as fingertips ({}) and hand poses "
              "({})",
              request.q_human.size(), request.p_HF.size(), request.X_OH.size());
  ThrowUnless(request.dt > 0 && request.T > 0, "a hand motion needs a positive step and duration");
  std::vector<Pose> X_HB;
  ForwardKinematics(robot.tree, robot.open, X_HB);
  // What drawing in would take from the contacts is given back.
  const int contact = std::min(n - 1, static_cast<int>(std::lround(request.T / request.dt)));
  PerFinger<Eigen::Vector3d> back;
  for (int f = 0; f < kNumFingers; ++f) {
    back[f] = request.p_HF[contact][f] - DrawnIn(robot, X_HB, f, request.p_HF[contact][f]);
  }
  std::vector<MappingTarget> targets;
  for (int k = 0; k < n; ++k) {
    const double blend = ContactBlend(request, k);
    MappingTarget target = TargetFromHuman(human, request.q_human[k], robot);
    for (int f = 0; f < kNumFingers; ++f) {
      if (!request.involved[f]) continue;
      target.p_HF[f] += blend * (request.p_HF[k][f] - target.p_HF[f]);
      target.p_HF[f] = DrawnIn(robot, X_HB, f, target.p_HF[f]) + blend * back[f];
      target.lambda[f] = std::pow(options.lambda_contact, blend * blend * blend);
    }
    targets.push_back(target);
  }
  return targets;
}

HandMotionResult MapHandMotion(const HumanHand& human, const RobotHand& robot,
                               const HandMotionRequest& request, const ContactPosture& posture,
                               const HandMotionOptions& options) {
  const std::vector<MappingTarget> targets = MappingTargets(human, robot, request, options);
  const int n = static_cast<int>(targets.size());
  const int half = SmoothingHalf(request.dt);
  const double t_contact = ContactTime(request);

  MappingOptions mapping = options.mapping;
  mapping.max_step = options.max_speed * request.dt;
  HandMotionResult result;
  double error = 0, count = 0;
  const std::vector<MappingResult> along =
      MapHandAlong(robot, targets, static_cast<int>(std::lround(request.T / request.dt)), mapping);
  for (int k = 0; k < n; ++k) {
    const MappingResult& mapped = along[k];
    for (int f = 0; f < kNumFingers; ++f) {
      if (!request.involved[f]) continue;
      error += mapped.tip_error[f];
      count += 1;
    }
    result.q.push_back(mapped.q + ContactBlend(request, k) * (posture.q - mapped.q));
  }
  result.mapping_error = count > 0 ? error / count : 0;

  constexpr double kFully = 1;  // m
  const Eigen::VectorXd q_open =
      OpenedPosture(robot, posture, request.shape, request.involved, kFully);
  const std::vector<Eigen::VectorXd> mapped = result.q;
  for (int f = 0; f < kNumFingers; ++f) {
    const std::vector<double> opening =
        Openings(robot, request, options, q_open, mapped, f, t_contact);
    for (int k = 0; k < n; ++k) {
      for (const int j : {robot.fingers[f].j0, robot.fingers[f].j1}) {
        result.q[k][j] += opening[k] * (q_open[j] - result.q[k][j]);
      }
    }
  }
  LimitSteps(options.max_speed * request.dt, result.q);
  Smooth(result.q, half);
  for (Eigen::VectorXd& q : result.q) q = q.cwiseMax(robot.tree.lower).cwiseMin(robot.tree.upper);

  result.clearance = std::numeric_limits<double>::infinity();
  std::vector<Pose> X_HB;
  for (int k = 0; k < n; ++k) {
    const double clearance = Clearance(robot, request.shape, request.X_OH[k], result.q[k], X_HB);
    if (request.dt * k < t_contact - options.closing * request.T) {
      result.clearance = std::min(result.clearance, clearance);
    }
    PerFinger<Eigen::Vector3d> tips;
    for (int f = 0; f < kNumFingers; ++f) {
      tips[f] = FramePose(robot.tree, X_HB, robot.fingers[f].tip).translation();
    }
    result.p_HF.push_back(tips);
    if (k == 0) continue;
    result.max_step =
        std::max(result.max_step, (result.q[k] - result.q[k - 1]).cwiseAbs().maxCoeff());
  }
  return result;
}

std::vector<Pose> ClearApproach(const RobotHand& robot, const Shape& shape,
                                const std::vector<Pose>& X_OH, const Eigen::VectorXd& q_open,
                                double dt, double T, double clearance, double closing, bool late) {
  constexpr double kStep = 0.01, kMost = 0.16, kMostLate = 0.06;  // m, offsets
  constexpr double kNearGoal = 0.95, kApproach = 0.2;  // of T, where less clearance is unavoidable
  constexpr int kStride = 3;                           // samples between checks
  const int n = static_cast<int>(X_OH.size());
  if (n == 0) return {};
  const int last = std::min(n - 1, static_cast<int>(std::lround(T / dt)));
  // Where an offset is largest: first in the middle, then late, where the object must not enter
  // along the fingers.
  const double peaks[] = {std::max(0.3, 1 - 1.5 * closing), std::max(0.6, 1 - 0.8 * closing)};
  const auto bump = [&](int k, double peak) {
    const double s = dt * k / T;
    return s < peak ? MinimumJerkPosition(s / peak) : MinimumJerkPosition((1 - s) / (1 - peak));
  };
  std::vector<Pose> X_HB;
  // What the open hand has at the goal is all that can be asked near it.
  const double at_goal = Clearance(robot, shape, X_OH[last], q_open, X_HB);
  const auto wanted = [&](int k) {
    const double s = dt * k / T;
    return std::min(clearance, at_goal + (clearance - at_goal) *
                                             std::clamp((kNearGoal - s) / kApproach, 0.0, 1.0));
  };
  std::vector<Pose> path = X_OH;
  const auto shortage = [&](const Eigen::Vector3d& offset_O, double peak) {
    double sum = 0;
    for (int k = 0; k < last; k += kStride) {
      Pose X = path[k];
      X.translation() += bump(k, peak) * offset_O;
      sum +=
          std::max(0.0, wanted(k) - HandDistance(robot, X_HB, X, shape, kAllFingers, true) - 1e-4);
    }
    return sum;
  };
  const Eigen::Matrix3d R_OA = X_OH[last].linear() * robot.R_HA;
  for (const double peak : peaks) {
    if (peak == peaks[1] && !late) break;
    const double most = peak == peaks[0] ? kMost : kMostLate;
    Eigen::Vector3d best = Eigen::Vector3d::Zero();
    double least = shortage(best, peak);
    for (double a = kStep; least > 0 && a <= most; a += kStep) {
      for (const Eigen::Vector3d& d_A :
           {Eigen::Vector3d(-0.7, 0, 0.7), Eigen::Vector3d(-0.4, 0, 0.9),
            Eigen::Vector3d(-0.9, 0, 0.4), Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(-1, 0, 0)}) {
        const Eigen::Vector3d offset = a * (R_OA * d_A.normalized());
        const double s = shortage(offset, peak);
        if (s >= least - 1e-6) continue;
        least = s;
        best = offset;
      }
    }
    for (int k = 0; k < last; ++k) path[k].translation() += bump(k, peak) * best;
  }
  return path;
}

}  // namespace springgrasp
