#include "demonstration/steady_hand.h"

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "base/pose.h"
#include "motion/smoothing.h"

namespace springgrasp {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::VectorXd;

// Chosen on synthesised demonstrations of the four types with seeds 1 to 6, by the error of the
// hand pose against truth; factors of two hardly matter.
constexpr double kInvolvedSpeed = 0.2;       // m/s, of a finger in the hand
constexpr double kOtherSpeed = 0.03;         // m/s
constexpr double kMostError = 0.005;         // m, of a hand's position from its skin
constexpr double kNoiseRatio = 30;           // that error / the noise of a tip, below the most
constexpr double kLever = 0.07;              // m: error of position / error of orientation
constexpr double kCorrelation = 0.2;         // s, over which the error of a pose stays the same
constexpr double kSlow = 2, kSlowTurn = 15;  // m/s^2, rad/s^2, by which it changes
constexpr double kTipNoise = 0.0005;         // m, at least
constexpr double kRest = 0.001;              // m/s: the speed of a tip is known no better
constexpr int kEnough = 6;                   // samples from which something can be learned
constexpr int kRounds = 3;                   // of Gauss-Newton; corrections are small

// A sample with everything that the fit needs.
struct Frame {
  std::size_t sample = 0;
  double t = 0;
  Vector3d p_seen, p;  // hand as seen (or between its neighbours) and as fitted, in W
  Quaterniond R_seen, R;
  bool position = false, orientation = false;  // seen, not interpolated
  PerFinger<std::optional<double>> speed;      // of the tips that were seen in W, m/s

  Vector3d Turn() const { return LogRotation(R * R_seen.conjugate()); }
};

// Places in `known` (increasing) around n, and how far n is from the first to the second.
struct Neighbours {
  std::size_t before = 0, after = 0;
  double fraction = 0;
};
Neighbours Around(const std::vector<std::size_t>& known, std::size_t n,
                  const std::vector<DemonstrationSample>& samples) {
  const auto after = std::lower_bound(known.begin(), known.end(), n);
  if (*after == n) return {n, n, 0};
  const std::size_t a = *(after - 1), b = *after;
  return {a, b, (samples[n].t - samples[a].t) / (samples[b].t - samples[a].t)};
}

// The samples between the first and the last with a whole pose; poses between are interpolated.
std::vector<Frame> FramesOf(const std::vector<DemonstrationSample>& samples) {
  std::vector<std::size_t> positions, orientations;
  for (std::size_t n = 0; n < samples.size(); ++n) {
    if (samples[n].p_WH) positions.push_back(n);
    if (samples[n].R_WH) orientations.push_back(n);
  }
  std::vector<Frame> frames;
  if (positions.size() < kEnough || orientations.size() < kEnough) return frames;
  const std::size_t first = std::max(positions.front(), orientations.front());
  const std::size_t last = std::min(positions.back(), orientations.back());
  for (std::size_t n = first; n <= last; ++n) {
    Frame frame;
    frame.sample = n;
    frame.t = samples[n].t;
    frame.position = samples[n].p_WH.has_value();
    frame.orientation = samples[n].R_WH.has_value();
    const Neighbours p = Around(positions, n, samples);
    const Neighbours R = Around(orientations, n, samples);
    frame.p = frame.p_seen =
        (1 - p.fraction) * *samples[p.before].p_WH + p.fraction * *samples[p.after].p_WH;
    frame.R = frame.R_seen = samples[R.before].R_WH->slerp(R.fraction, *samples[R.after].R_WH);
    frames.push_back(frame);
  }
  return frames;
}

// Fills in the speeds of the tips; returns the median of their noise, m.
double FindSpeeds(const std::vector<DemonstrationSample>& samples, std::vector<Frame>& frames) {
  const double rate = static_cast<double>(samples.size() - 1) / (samples.back().t - samples[0].t);
  std::vector<double> noises;
  for (int i = 0; i < kNumFingers; ++i) {
    std::vector<Frame*> seen;
    for (Frame& frame : frames) {
      if (samples[frame.sample].p_WF[i]) seen.push_back(&frame);
    }
    if (seen.size() < kEnough) continue;
    MatrixXd x(static_cast<Eigen::Index>(seen.size()), 3);
    VectorXd t(x.rows());
    for (Eigen::Index n = 0; n < x.rows(); ++n) {
      const Frame& frame = *seen[static_cast<std::size_t>(n)];
      x.row(n) = samples[frame.sample].p_WF[i]->transpose();
      t[n] = frame.t;
    }
    noises.push_back(EstimateNoise(t, x));
    const MotionSamples smooth = SmoothSamples(t, x, ChooseCutoff(noises.back(), rate), t);
    for (Eigen::Index n = 0; n < x.rows(); ++n) {
      seen[static_cast<std::size_t>(n)]->speed[i] = smooth.v.row(n).norm();
    }
  }
  if (noises.empty()) return 0;
  const auto middle = noises.begin() + static_cast<std::ptrdiff_t>(noises.size() / 2);
  std::nth_element(noises.begin(), middle, noises.end());
  return *middle;
}

// Rows of the linear least-squares problem for changes of position and turn (6 a frame), each
// in units of its deviation.
struct Rows {
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<double> right;

  // `weight` times sum of factor times part `part` (0 position, 3 turn) of frames is -residual.
  void Add(std::initializer_list<std::pair<std::size_t, double>> factors, int part, double weight,
           const Vector3d& residual) {
    for (int c = 0; c < 3; ++c) {
      for (const auto& [frame, factor] : factors) {
        entries.emplace_back(right.size(), 6 * static_cast<int>(frame) + part + c, weight * factor);
      }
      right.push_back(-weight * residual[c]);
    }
  }
};

void AddSeenPoses(const std::vector<Frame>& frames, double error, double rate, Rows& rows) {
  const double weight = 1 / (error * std::sqrt(std::max(1.0, kCorrelation * rate)));
  for (std::size_t n = 0; n < frames.size(); ++n) {
    const Frame& frame = frames[n];
    if (frame.position) rows.Add({{n, 1}}, 0, weight, frame.p - frame.p_seen);
    if (frame.orientation) rows.Add({{n, 1}}, 3, weight * kLever, frame.Turn());
  }
}

void AddSlowness(const std::vector<Frame>& frames, Rows& rows) {
  for (std::size_t n = 1; n + 1 < frames.size(); ++n) {
    const Frame &a = frames[n - 1], &b = frames[n], &c = frames[n + 1];
    const double dt = 0.5 * (c.t - a.t);
    const Vector3d bend = (a.p - a.p_seen) - 2 * (b.p - b.p_seen) + (c.p - c.p_seen);
    const Vector3d turn = a.Turn() - 2 * b.Turn() + c.Turn();
    rows.Add({{n - 1, 1}, {n, -2}, {n + 1, 1}}, 0, 1 / (kSlow * dt * dt), bend);
    rows.Add({{n - 1, 1}, {n, -2}, {n + 1, 1}}, 3, 1 / (kSlowTurn * dt * dt), turn);
  }
}

Matrix3d CrossMatrix(const Vector3d& a) {
  Matrix3d m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

// A finger's way in the hand from one sample in which it was seen to the next.
void AddFinger(const std::vector<Frame>& frames, const std::vector<DemonstrationSample>& samples,
               int finger, double own_speed, double tip_noise, Rows& rows) {
  std::optional<std::size_t> last;
  for (std::size_t n = 0; n < frames.size(); ++n) {
    if (!frames[n].speed[finger]) continue;
    if (last) {
      const double seen = 0.5 * (*frames[n].speed[finger] + *frames[*last].speed[finger]) + kRest;
      const double speed = own_speed * seen / std::hypot(own_speed, seen);
      const double dt = frames[n].t - frames[*last].t;
      const double weight = 1 / std::hypot(speed * dt, std::sqrt(2.0) * tip_noise);
      Vector3d way = Vector3d::Zero();
      for (const auto& [k, sign] : {std::pair(*last, -1.0), std::pair(n, 1.0)}) {
        const Frame& frame = frames[k];
        const Vector3d arm = *samples[frame.sample].p_WF[finger] - frame.p;
        const Matrix3d R_HW = frame.R.conjugate().toRotationMatrix();
        const Matrix3d by_turn = R_HW * CrossMatrix(arm);
        way += sign * R_HW * arm;
        for (int c = 0; c < 3; ++c) {
          const auto row = rows.right.size() + static_cast<std::size_t>(c);
          for (int q = 0; q < 3; ++q) {
            const int column = 6 * static_cast<int>(k) + q;
            rows.entries.emplace_back(row, column, -weight * sign * R_HW(c, q));
            rows.entries.emplace_back(row, column + 3, weight * sign * by_turn(c, q));
          }
        }
      }
      for (int c = 0; c < 3; ++c) rows.right.push_back(-weight * way[c]);
    }
    last = n;
  }
}

}  // namespace

Demonstration WithSteadyHand(const Demonstration& demonstration, const PerFinger<bool>& involved) {
  Demonstration out = demonstration;
  std::vector<Frame> frames = FramesOf(demonstration.samples);
  if (frames.size() < kEnough) return out;
  const double noise = FindSpeeds(demonstration.samples, frames);
  if (noise <= 0) return out;
  const double error = std::min(kMostError, kNoiseRatio * noise);
  const double rate = static_cast<double>(frames.size() - 1) / (frames.back().t - frames.front().t);
  for (int round = 0; round < kRounds; ++round) {
    Rows rows;
    AddSeenPoses(frames, error, rate, rows);
    AddSlowness(frames, rows);
    for (int i = 0; i < kNumFingers; ++i) {
      AddFinger(frames, demonstration.samples, i, involved[i] ? kInvolvedSpeed : kOtherSpeed,
                std::max(kTipNoise, noise), rows);
    }
    const auto count = static_cast<Eigen::Index>(rows.right.size());
    Eigen::SparseMatrix<double> J(count, 6 * static_cast<Eigen::Index>(frames.size()));
    J.setFromTriplets(rows.entries.begin(), rows.entries.end());
    const Eigen::SparseMatrix<double> normal = J.transpose() * J;
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(normal);
    if (factor.info() != Eigen::Success) return out;
    const VectorXd step = factor.solve(J.transpose() * VectorXd::Map(rows.right.data(), count));
    for (std::size_t n = 0; n < frames.size(); ++n) {
      const auto at = 6 * static_cast<Eigen::Index>(n);
      frames[n].p += step.segment<3>(at);
      frames[n].R = (ExpRotation(step.segment<3>(at + 3)) * frames[n].R).normalized();
    }
  }
  for (const Frame& frame : frames) {
    out.samples[frame.sample].p_WH = frame.p;
    out.samples[frame.sample].R_WH = frame.R;
  }
  return out;
}

}  // namespace springgrasp
