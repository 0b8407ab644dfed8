#include "grasp/learn_track.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "motion/smoothing.h"

namespace springgrasp {
namespace {

using Eigen::MatrixXd;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr int kEnough = 6;        // samples from which a signal can be learned
constexpr double kOutlier = 5.0;  // deviations from the neighbours' median

// A point over time, where it was seen.
struct Signal {
  std::vector<double> t;
  std::vector<Vector3d> x;
};

double Median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Drops samples far from the median of their five neighbours: exchanged labels, wild matches.
Signal WithoutOutliers(const Signal& signal, double noise) {
  const double limit = std::max(0.015, kOutlier * noise);
  Signal out;
  const int n = static_cast<int>(signal.t.size());
  for (int i = 0; i < n; ++i) {
    const int from = std::clamp(i - 2, 0, std::max(0, n - 5));
    const int to = std::min(n, from + 5);
    Vector3d median;
    for (int c = 0; c < 3; ++c) {
      std::vector<double> values;
      for (int j = from; j < to; ++j) values.push_back(signal.x[static_cast<std::size_t>(j)][c]);
      median[c] = Median(values);
    }
    const auto k = static_cast<std::size_t>(i);
    // Ends of the recording move past their one-sided median: only the inside is judged.
    const bool inside = i >= 2 && i < n - 2;
    if (inside && (signal.x[k] - median).cwiseAbs().maxCoeff() > limit) continue;
    out.t.push_back(signal.t[k]);
    out.x.push_back(signal.x[k]);
  }
  return out;
}

MatrixXd Rows(const Signal& signal) {
  MatrixXd x(static_cast<Eigen::Index>(signal.x.size()), 3);
  for (std::size_t i = 0; i < signal.x.size(); ++i) {
    x.row(static_cast<Eigen::Index>(i)) = signal.x[i].transpose();
  }
  return x;
}
VectorXd Times(const Signal& signal) {
  return VectorXd::Map(signal.t.data(), static_cast<Eigen::Index>(signal.t.size()));
}

double Noise(const Signal& signal) { return EstimateNoise(Times(signal), Rows(signal)); }

// Smoothed by its noise and rate at even times.
std::vector<Vector3d> Smooth(const Signal& signal, double noise, double period,
                             const VectorXd& times, double most_cutoff = 1e3) {
  const double cutoff = std::min(most_cutoff, ChooseCutoff(noise, 1 / period));
  const MotionSamples smooth = SmoothSamples(Times(signal), Rows(signal), cutoff, times);
  std::vector<Vector3d> out;
  for (Eigen::Index n = 0; n < smooth.x.rows(); ++n) out.push_back(smooth.x.row(n).transpose());
  return out;
}

// The orientation of the hand: smoothed as rotation vectors about a middle one, which is safe as
// long as the hand turns by less than 180 degrees from it.
std::vector<Quaterniond> SmoothRotation(const Demonstration& demonstration, double period,
                                        const VectorXd& times, double most_cutoff) {
  // A rotation moves the tips, 0.15 m away: its noise in metres there chooses the smoothing.
  constexpr double kLever = 0.15;
  std::vector<Quaterniond> R;
  Signal signal;
  for (const DemonstrationSample& sample : demonstration.samples) {
    if (!sample.R_WH) continue;
    signal.t.push_back(sample.t);
    R.push_back(*sample.R_WH);
  }
  const Quaterniond middle = R[R.size() / 2];
  for (const Quaterniond& rotation : R) {
    signal.x.push_back(kLever * LogRotation(middle.conjugate() * rotation));
  }
  const double noise = Noise(signal);
  signal = WithoutOutliers(signal, noise);
  std::vector<Quaterniond> out;
  for (const Vector3d& x : Smooth(signal, noise, period, times, most_cutoff)) {
    out.push_back(middle * ExpRotation(x / kLever));
  }
  return out;
}

// Typical time between samples of the recording, s.
double SamplePeriod(const Demonstration& demonstration) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < demonstration.samples.size(); ++i) {
    steps.push_back(demonstration.samples[i].t - demonstration.samples[i - 1].t);
  }
  return Median(steps);
}

}  // namespace

HandTrack MakeHandTrack(const Demonstration& demonstration, double most_hand_cutoff) {
  HandTrack track;
  Signal wrist, midpoint;
  PerFinger<Signal> tips;
  int rotations = 0;
  for (const DemonstrationSample& sample : demonstration.samples) {
    if (sample.p_WH) {
      wrist.t.push_back(sample.t);
      wrist.x.push_back(*sample.p_WH);
    }
    if (sample.R_WH) ++rotations;
    for (int i = 0; i < kNumFingers; ++i) {
      if (!sample.p_WF[i]) continue;
      tips[i].t.push_back(sample.t);
      tips[i].x.push_back(*sample.p_WF[i]);
    }
    if (sample.p_WF[kThumb] && sample.p_WF[kIndex]) {
      midpoint.t.push_back(sample.t);
      midpoint.x.push_back(0.5 * (*sample.p_WF[kThumb] + *sample.p_WF[kIndex]));
    }
  }
  const double period = SamplePeriod(demonstration);
  int fingers = 0;
  std::vector<double> noises;
  for (int i = 0; i < kNumFingers; ++i) {
    track.observed[i] = tips[i].t.size() >= kEnough;
    if (!track.observed[i]) continue;
    const double noise = Noise(tips[i]);
    tips[i] = WithoutOutliers(tips[i], noise);
    track.observed[i] = tips[i].t.size() >= kEnough;
    if (!track.observed[i]) continue;
    noises.push_back(noise);
    if (i != kThumb) ++fingers;
  }
  ThrowUnless(track.observed[kThumb] && fingers > 0,
              "{}: thumb seen in {} samples, and {} other fingers in at least {}; learning needs "
              "the thumb and one more finger",
              demonstration.source, tips[kThumb].t.size(), fingers, kEnough);
  track.wrist = wrist.t.size() >= kEnough;
  track.orientation = track.wrist && rotations >= kEnough;
  ThrowUnless(track.wrist || midpoint.t.size() >= kEnough,
              "{}: neither the wrist nor thumb and index finger together were seen in at least {} "
              "samples",
              demonstration.source, kEnough);
  track.tip_noise = Median(noises);
  track.t0 = demonstration.samples.front().t;
  const double length = demonstration.samples.back().t - track.t0;
  const int count = static_cast<int>(std::floor(length / track.dt + 1e-9)) + 1;
  const VectorXd times = VectorXd::LinSpaced(count, track.t0, track.t0 + (count - 1) * track.dt);

  // The hand.
  Signal hand = track.wrist ? wrist : midpoint;
  track.hand_noise = Noise(hand);
  hand = WithoutOutliers(hand, track.hand_noise);
  const auto p_WH = Smooth(hand, track.hand_noise, period, times, most_hand_cutoff);
  std::vector<Quaterniond> R_WH(p_WH.size(), Quaterniond::Identity());
  if (track.orientation) R_WH = SmoothRotation(demonstration, period, times, most_hand_cutoff);
  for (std::size_t n = 0; n < p_WH.size(); ++n) track.X_WH.push_back(MakePose(p_WH[n], R_WH[n]));

  // The fingertips from the hand, each seen sample by the hand's smoothed pose at that time; gaps
  // are bridged there, where fingers move least.
  Fingertips nowhere;
  nowhere.fill(Vector3d::Zero());
  track.p_HF.assign(p_WH.size(), nowhere);
  for (const DemonstrationSample& sample : demonstration.samples) {
    track.sample_t.push_back(sample.t - track.t0);
  }
  track.sample_p_HF.resize(track.sample_t.size());
  for (int i = 0; i < kNumFingers; ++i) {
    if (!track.observed[i]) continue;
    Signal p_HF;
    std::size_t row = 0;
    for (std::size_t k = 0; k < tips[i].t.size(); ++k) {
      const double t = tips[i].t[k] - track.t0;
      p_HF.t.push_back(tips[i].t[k]);
      p_HF.x.push_back(PoseAlong(track.X_WH, t / track.dt).inverse() * tips[i].x[k]);
      while (track.sample_t[row] < t) ++row;
      track.sample_p_HF[row][i] = p_HF.x.back();
    }
    const auto smooth = Smooth(p_HF, Noise(p_HF), period, times);
    for (std::size_t n = 0; n < smooth.size(); ++n) track.p_HF[n][i] = smooth[n];
  }
  return track;
}

HandTrack WithHandFrame(const HandTrack& track, const Pose& X_HHnew) {
  HandTrack out = track;
  const Pose back = X_HHnew.inverse();
  for (Pose& X_WH : out.X_WH) X_WH = X_WH * X_HHnew;
  for (Fingertips& tips : out.p_HF) {
    for (Vector3d& p : tips) p = back * p;
  }
  for (auto& tips : out.sample_p_HF) {
    for (auto& p : tips) {
      if (p) *p = back * *p;
    }
  }
  return out;
}

std::vector<double> HandSpeed(const HandTrack& track) {
  std::vector<double> speed(static_cast<std::size_t>(track.size()), 0.0);
  for (std::size_t n = 0; n < speed.size(); ++n) {
    const std::size_t a = n == 0 ? 0 : n - 1;
    const std::size_t b = std::min(n + 1, speed.size() - 1);
    if (a == b) continue;
    const Vector3d d = track.X_WH[b].translation() - track.X_WH[a].translation();
    speed[n] = d.norm() / (static_cast<double>(b - a) * track.dt);
  }
  return speed;
}

std::vector<double> ThumbFingerSpan(const HandTrack& track, const PerFinger<bool>& involved) {
  std::vector<double> span;
  for (const Fingertips& tips : track.p_HF) {
    Vector3d sum = Vector3d::Zero();
    int count = 0;
    for (int i = kIndex; i < kNumFingers; ++i) {
      if (!involved[i] || !track.observed[i]) continue;
      sum += tips[i];
      ++count;
    }
    span.push_back(count > 0 ? (sum / count - tips[kThumb]).norm() : 0.0);
  }
  return span;
}

}  // namespace springgrasp
