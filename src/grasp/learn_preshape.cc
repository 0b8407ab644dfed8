#include "grasp/learn_preshape.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "grasp/aperture.h"

namespace springgrasp {

using Eigen::Vector3d;

std::size_t WidestInstant(const FitProblem& fit) {
  constexpr double kNear = 0.06;  // s
  const auto measured = [&](double t) {
    for (int i = 0; i < kNumFingers; ++i) {
      if (!fit.run.involved[i] || !fit.observed[i]) continue;
      bool near = false;
      for (std::size_t k = 0; k < fit.sample_t.size() && !near; ++k) {
        near = fit.sample_p_HF[k][i] && std::abs(fit.sample_t[k] - t) < kNear;
      }
      if (!near) return false;
    }
    return true;
  };
  std::size_t widest = 0;
  double aperture = 0;
  for (std::size_t n = 0; n < fit.p_HF.size(); ++n) {
    const double now = Aperture(fit.p_HF[n], fit.run.involved);
    if (now <= aperture || !measured(static_cast<double>(n) * fit.dt)) continue;
    aperture = now;
    widest = n;
  }
  return widest;
}

namespace {

constexpr double kLeast = 0.01;    // m, of a way that tells its shape and its time
constexpr double kMostBend = 1.0;  // bend times way: a quarter circle has 0.7

// The involved tips from their contacts while the hand opens, step by step, less what the auxiliary
// springs alone leave of the start.
std::vector<Fingertips> OpeningWays(const FitProblem& fit, std::size_t widest) {
  constexpr double kAfter = 0.08;  // of T: so far beyond the widest instant the hand stays open
  const double steps_per_T = fit.run.T / fit.dt;
  const double damped = fit.rule.omega_T * fit.rule.zeta;
  const double split =
      fit.rule.omega_T * std::sqrt(std::max(1e-6, fit.rule.zeta * fit.rule.zeta - 1));
  std::vector<Fingertips> ways;
  const auto end = std::min(
      fit.p_HF.size(), widest + static_cast<std::size_t>(std::lround(kAfter * steps_per_T)) + 1);
  for (std::size_t n = 0; n < end; ++n) {
    const double s = static_cast<double>(n) / steps_per_T;
    const double left =
        std::exp(-damped * s) * (std::cosh(split * s) + damped / split * std::sinh(split * s));
    Fingertips way;
    way.fill(Vector3d::Zero());
    for (int i = 0; i < kNumFingers; ++i) {
      if (!fit.run.involved[i]) continue;
      way[i] = fit.p_HF[n][i] - fit.run.p_HC[i] - left * (fit.run.p_HF[i] - fit.run.p_HC[i]);
    }
    ways.push_back(way);
  }
  return ways;
}

}  // namespace

Fingertips Preshape(const FitProblem& fit, std::size_t widest) {
  constexpr int kRounds = 5;
  const std::vector<Fingertips> ways = OpeningWays(fit, widest);
  // Their first principal component: how far the whole hand is along `opening` at every step, and
  // the opening that explains all steps best, by turns.
  Fingertips opening = ways[std::min(widest, ways.size() - 1)];
  const auto dot = [](const Fingertips& a, const Fingertips& b) {
    double sum = 0;
    for (int i = 0; i < kNumFingers; ++i) sum += a[i].dot(b[i]);
    return sum;
  };
  for (int round = 0; round < kRounds && dot(opening, opening) > 0; ++round) {
    Fingertips next;
    next.fill(Vector3d::Zero());
    double most = 0, squares = 0;
    for (const Fingertips& way : ways) {
      const double along = dot(way, opening) / dot(opening, opening);
      for (int i = 0; i < kNumFingers; ++i) next[i] += along * way[i];
      squares += along * along;
      most = std::max(most, along);
    }
    if (squares <= 0) break;
    for (int i = 0; i < kNumFingers; ++i) opening[i] = next[i] * (most / squares);
  }
  double mean = 0;
  for (const Vector3d& way : opening) mean += way.norm();
  // A hand that only closes: the way back to its start.
  if (mean > 0.01) return opening;
  for (int i = 0; i < kNumFingers; ++i) {
    if (fit.run.involved[i]) opening[i] = fit.run.p_HF[i] - fit.run.p_HC[i];
  }
  return opening;
}

Fingertips OpeningBend(const FitProblem& fit, std::size_t widest, Fingertips& opening) {
  Fingertips bend;
  bend.fill(Vector3d::Zero());
  const std::vector<Fingertips> ways = OpeningWays(fit, widest);
  for (int i = 0; i < kNumFingers; ++i) {
    const double length = opening[i].norm();
    if (!fit.run.involved[i] || !fit.observed[i] || length < kLeast) continue;
    const Vector3d chord = opening[i] / length;
    const Vector3d start = fit.run.p_HF[i] - fit.run.p_HC[i];
    double first = chord.dot(start), last = first;
    for (const Fingertips& tips : ways) last = std::max(last, chord.dot(tips[i] + start));
    if (last - first < kLeast) continue;
    // Across the chord the way is w = A + bend / 2 (x - middle)^2 where it is x along it.
    const double middle = 0.5 * (first + last);
    double square = 0, mean = 0;
    Vector3d w_mean = Vector3d::Zero(), w_square = Vector3d::Zero();
    const double part = 1 / static_cast<double>(ways.size());
    for (const Fingertips& tips : ways) {
      const Vector3d y = tips[i] + start;
      const double x = chord.dot(y), x2 = 0.5 * (x - middle) * (x - middle);
      const Vector3d w = y - x * chord;
      mean += part * x2;
      square += part * x2 * x2;
      w_mean += part * w;
      w_square += part * x2 * w;
    }
    const double variance = square - mean * mean;
    if (variance <= 1e-9 * square) continue;
    bend[i] = (w_square - mean * w_mean) / variance;
    const double limit = kMostBend / (last - first);
    if (bend[i].norm() > limit) bend[i] *= limit / bend[i].norm();
    opening[i] -= length * middle * bend[i];
  }
  return bend;
}

namespace {

// The way of finger i back to its contact.
struct Closing {
  std::size_t from = 0, half = 0;  // step at which it is farthest, and from which on within half
  double most = 0;                 // m, then
  Vector3d n = Vector3d::Zero();   // from the contact to there
};
Closing ClosingOf(const FitProblem& fit, int i) {
  Closing closing;
  const auto from_contact = [&](std::size_t k) -> Vector3d {
    return fit.p_HF[k][i] - fit.run.p_HC[i];
  };
  for (std::size_t k = 0; k < fit.p_HF.size(); ++k) {
    if (from_contact(k).norm() < closing.most) continue;
    closing.most = from_contact(k).norm();
    closing.from = k;
  }
  if (closing.most > 0) closing.n = from_contact(closing.from) / closing.most;
  closing.half = fit.p_HF.size() - 1;
  const auto within_half = [&](std::size_t k) {
    return closing.n.dot(from_contact(k)) < 0.5 * closing.most;
  };
  while (closing.half > closing.from && within_half(closing.half)) --closing.half;
  return closing;
}

}  // namespace

Fingertips ClosingBend(const FitProblem& fit) {
  Fingertips bend;
  bend.fill(Vector3d::Zero());
  for (int i = 0; i < kNumFingers; ++i) {
    if (!fit.run.involved[i] || !fit.observed[i]) continue;
    const Closing closing = ClosingOf(fit, i);
    if (closing.most < kLeast) continue;
    // Across n the way is w = C x - bend x^2 where it is x along n.
    double xx = 0, xxx = 0, xxxx = 0;
    Vector3d wx = Vector3d::Zero(), wxx = Vector3d::Zero();
    for (std::size_t k = closing.from; k < fit.p_HF.size(); ++k) {
      const Vector3d y = fit.p_HF[k][i] - fit.run.p_HC[i];
      const double x = closing.n.dot(y);
      const Vector3d w = y - x * closing.n;
      xx += x * x;
      xxx += x * x * x;
      xxxx += x * x * x * x;
      wx += x * w;
      wxx += x * x * w;
    }
    const double determinant = xx * xxxx - xxx * xxx;
    if (determinant <= 1e-9 * xx * xxxx) continue;
    bend[i] = -(xx * wxx - xxx * wx) / determinant;
    const double limit = kMostBend / closing.most;
    if (bend[i].norm() > limit) bend[i] *= limit / bend[i].norm();
  }
  return bend;
}

PerFinger<double> ClosingLag(const FitProblem& fit) {
  PerFinger<double> lag = {};
  const std::size_t widest = WidestInstant(fit);
  PerFinger<bool> known = {};
  double mean = 0;
  int count = 0;
  for (int i = 0; i < kNumFingers; ++i) {
    if (!fit.run.involved[i] || !fit.observed[i]) continue;
    const Closing closing = ClosingOf(fit, i);
    known[i] = closing.most >= kLeast && closing.half >= widest;
    if (!known[i]) continue;
    lag[i] = static_cast<double>(closing.half) * fit.dt;
    mean += lag[i];
    ++count;
  }
  for (int i = 0; i < kNumFingers; ++i) {
    if (known[i]) lag[i] -= mean / count;
  }
  return lag;
}

}  // namespace springgrasp
