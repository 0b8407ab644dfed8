#include "grasp/learn_segment.h"

#include <algorithm>
#include <cmath>

namespace springgrasp {
namespace {

constexpr double kSpeedFraction = 0.05;  // movement time: first to last 5 % of peak speed
constexpr double kMovement = 0.2;        // s; human reaches to grasp last 1.0 to 1.4 s
constexpr double kRest = 0.05;           // s, a hand that is slow for so long has stopped

struct Stop {
  int index = 0;
  bool reached = false;
};

// The first instant after `peak` from which the hand stays slow; if it never does, the slowest.
Stop FindStop(const std::vector<double>& speed, int peak, double dt, double slow) {
  const int n = static_cast<int>(speed.size());
  const int hold = std::max(1, static_cast<int>(std::lround(kRest / dt)));
  int slow_for = 0;
  for (int i = peak; i < n; ++i) {
    slow_for = speed[static_cast<std::size_t>(i)] <= slow ? slow_for + 1 : 0;
    if (slow_for == hold || (slow_for > 0 && i == n - 1)) return {i - slow_for + 1, true};
  }
  const auto slowest = std::min_element(speed.begin() + peak, speed.end());
  return {static_cast<int>(slowest - speed.begin()), false};
}

// The fastest instant up to `last` of the movement that is fastest over kMovement: a jump of one
// frame is not a movement.
int FindPeak(const std::vector<double>& speed, int last, double dt) {
  const int half = static_cast<int>(std::lround(0.5 * kMovement / dt));
  const auto window = [&](int i) {
    return std::pair(std::max(0, i - half), std::min(last, i + half));
  };
  int fastest = 0;
  double largest = -1;
  for (int i = 0; i <= last; ++i) {
    const auto [from, to] = window(i);
    double sum = 0;
    for (int k = from; k <= to; ++k) sum += speed[static_cast<std::size_t>(k)];
    // Windows cut by an end are as long as the others: what is not there stood still.
    if (sum <= largest) continue;
    largest = sum;
    fastest = i;
  }
  const auto [from, to] = window(fastest);
  return static_cast<int>(std::max_element(speed.begin() + from, speed.begin() + to + 1) -
                          speed.begin());
}

}  // namespace

ReachSegment FindReach(const std::vector<double>& speed, const std::vector<double>& span, double dt,
                       double speed_noise, double span_noise) {
  const int n = static_cast<int>(speed.size());
  const auto at = [](const auto& v, int i) { return v[static_cast<std::size_t>(i)]; };
  const auto threshold = [&](int peak) {
    return std::max(kSpeedFraction * at(speed, peak), speed_noise);
  };
  ReachSegment reach;

  // The fingers close after their widest opening before the hand stops; letting go comes later.
  reach.peak = FindPeak(speed, n - 1, dt);
  Stop stop = FindStop(speed, reach.peak, dt, threshold(reach.peak));
  const auto widest = std::max_element(span.begin(), span.begin() + stop.index + 1);
  const double closed = *std::min_element(widest, span.end());
  const double tolerance = std::max(0.002 + 2 * span_noise, 0.05 * (*widest - closed));
  int settled = static_cast<int>(widest - span.begin());
  while (settled < n - 1 && at(span, settled) > closed + tolerance) ++settled;

  // A faster movement after that (lifting) is not the reach.
  reach.peak = FindPeak(speed, settled, dt);
  const double slow = threshold(reach.peak);
  stop = FindStop(speed, reach.peak, dt, slow);
  reach.begin = reach.peak;
  while (reach.begin > 0 && at(speed, reach.begin - 1) > slow) --reach.begin;
  reach.cut_at_begin = reach.begin == 0 && at(speed, 0) > slow;
  reach.stop = stop.index;
  reach.cut_at_end = !stop.reached && stop.index == n - 1;
  reach.contact = std::max(stop.index, settled);
  return reach;
}

}  // namespace springgrasp
