#include "experiment/demonstrator_recorded.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/error.h"
#include "experiment/demonstrator_grasp.h"
#include "kinematics/hand_ik.h"
#include "kinematics/human_hand.h"
#include "motion/smoothing.h"

namespace springgrasp {
namespace {

using Points = std::vector<std::optional<Eigen::Vector3d>>;

constexpr double kWristCutoff = 4;  // Hz: a solved wrist moves no faster than an arm
constexpr double kDip = M_PI / 6;   // rad, of a hand whose wrist was not recorded (assumed)

// Fills what was not seen: straight lines over gaps, the nearest point before and after.
std::vector<Eigen::Vector3d> Bridged(const std::vector<double>& t, const Points& points) {
  std::vector<Eigen::Vector3d> filled(points.size());
  int before = -1;
  for (int i = 0; i < static_cast<int>(points.size()); ++i) {
    if (!points[i]) continue;
    for (int k = before + 1; k <= i; ++k) {
      const double w = before < 0 ? 1 : (t[k] - t[before]) / (t[i] - t[before]);
      filled[k] = before < 0 ? *points[i] : (1 - w) * *points[before] + w * *points[i];
    }
    before = i;
  }
  for (std::size_t k = before + 1; k < points.size(); ++k) filled[k] = *points[before];
  return filled;
}

// Poses of the recorded hand frame, bridged; nothing if position or orientation is never seen.
std::optional<std::vector<Pose>> RecordedHand(const Demonstration& recording) {
  const auto& samples = recording.samples;
  int before = -1;
  std::vector<Pose> poses(samples.size());
  const auto pose = [&](int i) { return MakePose(*samples[i].p_WH, *samples[i].R_WH); };
  for (int i = 0; i < static_cast<int>(samples.size()); ++i) {
    if (!samples[i].p_WH || !samples[i].R_WH) continue;
    for (int k = before + 1; k <= i; ++k) {
      if (before < 0) {
        poses[k] = pose(i);
        continue;
      }
      const double w = (samples[k].t - samples[before].t) / (samples[i].t - samples[before].t);
      poses[k] = MakePose((1 - w) * *samples[before].p_WH + w * *samples[i].p_WH,
                          samples[before].R_WH->slerp(w, *samples[i].R_WH));
    }
    before = i;
  }
  if (before < 0) return std::nullopt;
  for (std::size_t k = before + 1; k < samples.size(); ++k) poses[k] = pose(before);
  return poses;
}

// Rigid X with least sum of weight |X a - b|^2 (Kabsch).
Pose AlignPoints(const std::vector<Eigen::Vector3d>& a, const std::vector<Eigen::Vector3d>& b,
                 const std::vector<double>& weight) {
  Eigen::Vector3d mean_a = Eigen::Vector3d::Zero(), mean_b = mean_a;
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    mean_a += weight[i] * a[i];
    mean_b += weight[i] * b[i];
    sum += weight[i];
  }
  mean_a /= sum;
  mean_b /= sum;
  Eigen::Matrix3d C = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < a.size(); ++i) {
    C += weight[i] * (b[i] - mean_b) * (a[i] - mean_a).transpose();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(C, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d sign(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant());
  Pose X = Pose::Identity();
  X.linear() = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
  X.translation() = mean_b - X.linear() * mean_a;
  return X;
}

// Thumb and fingers wear caps: where bare fingertips came nearer than two cap radii, each shown tip
// gives way by half of what is missing (softly, so that the motion stays smooth).
void KeepCapsApart(double cap_radius, const PerFinger<bool>& known,
                   std::vector<std::vector<Eigen::Vector3d>>& tips) {
  constexpr double kGap = 0.004;  // m
  const double apart = 2 * cap_radius + kGap;
  for (int f = kIndex; f < kNumFingers; ++f) {
    if (!known[f]) continue;
    for (std::size_t i = 0; i < tips[f].size(); ++i) {
      const Eigen::Vector3d between = tips[f][i] - tips[kThumb][i];
      const double distance = between.norm();
      if (distance < 1e-4) continue;
      const double wanted = std::pow(std::pow(distance, 8) + std::pow(apart, 8), 0.125);
      const Eigen::Vector3d half = between * ((wanted - distance) / (2 * distance));
      tips[f][i] += half;
      tips[kThumb][i] -= half;
    }
  }
}

KnownTips TipsIn(const Pose& X_AH, const std::vector<std::vector<Eigen::Vector3d>>& p_AF,
                 const PerFinger<bool>& known, std::size_t i) {
  KnownTips tips;
  for (int f = 0; f < kNumFingers; ++f) {
    if (known[f]) tips[f] = X_AH.inverse() * p_AF[f][i];
  }
  return tips;
}

// The fixed pose of H in the recording's hand frame M (markers on the back of the hand), from the
// fingertips that a hand at H can reach naturally; drawn to a prior by points 5 cm about H.
Pose FitHandInMarkers(const HumanHand& human, const std::vector<std::vector<Eigen::Vector3d>>& p_MF,
                      const PerFinger<bool>& known) {
  constexpr int kInstants = 10, kPasses = 25;
  constexpr double kPriorWeight = 3, kPriorRadius = 0.05, kBackToWrist = 0.015;
  Pose X_prior = Pose::Identity();
  X_prior.translation().z() = -kBackToWrist;
  HandIkOptions loose;
  loose.tip_deviation = 0.004;  // postures stay natural; the pose takes up the rest
  Pose X_MH = X_prior;
  std::vector<Eigen::VectorXd> q(kInstants);
  const std::size_t n = p_MF[kThumb].size();
  for (int pass = 0; pass < kPasses; ++pass) {
    std::vector<Eigen::Vector3d> a, b;
    std::vector<double> weight;
    for (int k = 0; k < kInstants; ++k) {
      const std::size_t i = (n - 1) * k / (kInstants - 1);
      q[k] = SolveHandIk(human, TipsIn(X_MH, p_MF, known, i), {}, loose).q;
      std::vector<Pose> X_HB;
      ForwardKinematics(human.tree, q[k], X_HB);
      for (int f = 0; f < kNumFingers; ++f) {
        if (!known[f]) continue;
        a.push_back(FramePose(human.tree, X_HB, human.tip[f]).translation());
        b.push_back(p_MF[f][i]);
        weight.push_back(1);
      }
    }
    for (int axis = 0; axis < 3; ++axis) {
      for (const double side : {-kPriorRadius, kPriorRadius}) {
        a.push_back(side * Eigen::Vector3d::Unit(axis));
        b.push_back(X_prior * a.back());
        weight.push_back(kPriorWeight);
      }
    }
    X_MH = AlignPoints(a, b, weight);
  }
  return X_MH;
}

// Without a wrist: one direction of the hand for the whole movement, thumb to index as at its end,
// pointing where the movement goes over ground and dipped, as hands do that work on a table; then
// the pose of least strain at every instant, smoothed.
std::vector<Pose> SolveHandPath(const HumanHand& human, const std::vector<double>& t,
                                const std::vector<std::vector<Eigen::Vector3d>>& p_WF,
                                const PerFinger<bool>& known, const HandShape& pinch,
                                const Eigen::Vector3d& up) {
  const std::size_t n = t.size();
  Eigen::Vector3d grip = Eigen::Vector3d::Zero();
  for (std::size_t i = n - std::max<std::size_t>(n / 10, 1); i < n; ++i) {
    grip += p_WF[kIndex][i] - p_WF[kThumb][i];
  }
  const auto middle = [&](std::size_t i) -> Eigen::Vector3d {
    return (p_WF[kThumb][i] + p_WF[kIndex][i]) / 2;
  };
  Eigen::Vector3d reach = middle(n - 1) - middle(0);
  reach -= reach.dot(up) * up;
  if (reach.norm() > 1e-3) reach = reach.normalized() - std::tan(kDip) * up;
  if (reach.cross(grip).norm() < 1e-3 * grip.norm()) reach += 0.1 * grip.unitOrthogonal();
  const Eigen::Vector3d grip_H = pinch.tips[kIndex] - pinch.tips[kThumb];
  const Eigen::Vector3d middle_H = (pinch.tips[kIndex] + pinch.tips[kThumb]) / 2;
  Pose prior = Pose::Identity();
  prior.linear() =
      FrameFromXZ(grip, reach) * FrameFromXZ(grip_H, Eigen::Vector3d::UnitX()).transpose();

  Eigen::VectorXd times(n);
  Eigen::MatrixXd path(n, 6);
  Eigen::VectorXd q;
  for (std::size_t i = 0; i < n; ++i) {
    prior.translation() = middle(i) - prior.linear() * middle_H;
    const HandPoseIkResult solved =
        SolveHandPoseIk(human, TipsIn(Pose::Identity(), p_WF, known, i), prior, q);
    q = solved.q;
    times[i] = t[i];
    path.row(i) << solved.X_WH.translation().transpose(),
        LogRotation(Eigen::Quaterniond(prior.linear().transpose() * solved.X_WH.linear()))
            .transpose();
  }
  const MotionSamples smooth = SmoothSamples(times, path, kWristCutoff, times);
  std::vector<Pose> poses(n);
  for (std::size_t i = 0; i < n; ++i) {
    poses[i] = MakePose(
        smooth.x.row(i).head<3>().transpose(),
        Eigen::Quaterniond(prior.linear()) * ExpRotation(smooth.x.row(i).tail<3>().transpose()));
  }
  return poses;
}

// Notes which recorded fingertips the hand cannot reach: the MMM thumb is shorter than a person's.
void NoteMisses(const DemonstratorHand& hand, const Demonstration& recording, HandMotion& motion) {
  constexpr double kWorthNoting = 0.003;  // m
  PerFinger<std::vector<double>> misses;
  for (std::size_t i = 0; i < motion.samples.size(); ++i) {
    const HandShape shape = ComputeHandShape(hand, motion.samples[i].q);
    for (int f = 0; f < kNumFingers; ++f) {
      const auto& recorded = recording.samples[i].p_WF[f];
      if (!recorded) continue;
      misses[f].push_back((motion.samples[i].X_WH * shape.tips[f] - *recorded).norm());
    }
  }
  for (int f = 0; f < kNumFingers; ++f) {
    if (misses[f].empty()) continue;
    std::sort(misses[f].begin(), misses[f].end());
    const double median = misses[f][misses[f].size() / 2];
    if (median < kWorthNoting) continue;
    motion.comments.push_back(fmt::format("shown {} lies {:.0f} mm (median) from the recorded one",
                                          kFingerNames[f], 1000 * median));
  }
}

}  // namespace

HandMotion HandMotionOf(const DemonstratorHand& hand, const Demonstration& recording,
                        const std::string& type) {
  const PerFinger<bool> known = RecordedFingers(recording);
  ThrowUnless(known[kThumb] && known[kIndex],
              "{}: a recording can be shown only with thumb and index finger", recording.source);
  HandMotion motion;
  motion.source = recording.source;
  motion.joint_names = hand.tree.joint_names;
  motion.object = recording.object;
  motion.up = recording.up.value_or(Eigen::Vector3d::UnitZ());
  motion.type = !type.empty()    ? type
                : known[kPinkie] ? "power"
                : known[kMiddle] ? "tripod"
                                 : "pinch";
  motion.involved = InvolvedFingers(motion.type);
  for (int f = 0; f < kNumFingers; ++f) motion.involved[f] &= known[f];

  const HeldPosture pinch = SolveHeldPosture(hand, "pinch", Shape{});
  HumanHand human = MakeHumanHand(hand.tree);
  human.rest = pinch.q;  // fingers that were not recorded stay half curled, out of the way

  const std::size_t n = recording.samples.size();
  std::vector<double> t(n);
  for (std::size_t i = 0; i < n; ++i) t[i] = recording.samples[i].t - recording.samples[0].t;
  const std::optional<std::vector<Pose>> X_WM = RecordedHand(recording);
  std::vector<std::vector<Eigen::Vector3d>> tips(kNumFingers);  // in M, without a wrist in W
  for (int f = 0; f < kNumFingers; ++f) {
    if (!known[f]) continue;
    Points points(n);
    for (std::size_t i = 0; i < n; ++i) {
      points[i] = recording.samples[i].p_WF[f];
      if (points[i] && X_WM) points[i] = (*X_WM)[i].inverse() * *points[i];
    }
    tips[f] = Bridged(t, points);
  }
  KeepCapsApart(hand.size.cap_radius, known, tips);
  std::vector<Pose> X_WH(n);
  std::vector<KnownTips> p_HF(n);
  if (X_WM) {
    human.rest = hand.relaxed;
    const Pose X_MH = FitHandInMarkers(human, tips, known);
    const auto offset = X_MH.translation();
    motion.comments.push_back(fmt::format(
        "assumed: wrist centre at {:.3f} {:.3f} {:.3f} m of the recorded hand frame, turned {:.0f} "
        "degrees",
        offset.x(), offset.y(), offset.z(),
        LogRotation(Eigen::Quaterniond(X_MH.linear())).norm() * 180 / M_PI));
    for (std::size_t i = 0; i < n; ++i) {
      X_WH[i] = (*X_WM)[i] * X_MH;
      p_HF[i] = TipsIn(X_MH, tips, known, i);
    }
  } else {
    X_WH = SolveHandPath(human, t, tips, known, ComputeHandShape(hand, pinch.q), motion.up);
    motion.comments.push_back("assumed: hand pose solved from thumb and index, not recorded");
    for (std::size_t i = 0; i < n; ++i) p_HF[i] = TipsIn(X_WH[i], tips, known, i);
  }
  const std::vector<Eigen::VectorXd> q = SolveHandMotion(human, p_HF);
  for (std::size_t i = 0; i < n; ++i) {
    HandMotionSample sample;
    sample.t = t[i];
    sample.X_WH = X_WH[i];
    sample.q = q[i];
    const DemonstrationSample& recorded = recording.samples[i];
    sample.wrist_recorded = recorded.p_WH.has_value() && recorded.R_WH.has_value();
    for (int f = 0; f < kNumFingers; ++f) sample.recorded[f] = recorded.p_WF[f].has_value();
    motion.samples.push_back(sample);
  }
  NoteMisses(hand, recording, motion);
  return motion;
}

}  // namespace springgrasp
