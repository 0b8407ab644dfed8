#include "vision/fingertip_tracker_impl.h"

// Which finger a region is of, where that has gone wrong.
namespace springgrasp {

using namespace tracker_internal;  // NOLINT: the tracker's own names

// Caps that touch are two radii apart: fingers measured within one of each other stand on a single
// cap. The one farther from where it should be is lost, and sought again in the next frame.
void FingertipTracker::Impl::DropShared(TrackedFrame& frame) {
  const auto off = [&](int f) {
    return (*frame.fingers[f].p_W - fingers[f].p_W - fingers[f].v_W).norm();
  };
  for (int f = 0; f < kNumFingers; ++f) {
    for (int g = 0; g < f; ++g) {
      if (!frame.fingers[f].p_W || !frame.fingers[g].p_W) continue;
      if ((*frame.fingers[f].p_W - *frame.fingers[g].p_W).norm() > cap.radius) continue;
      const int loser = off(f) > off(g) ? f : g;
      frame.fingers[loser] = TrackedFinger();
      for (View& view : views) view.active[loser] = false;
    }
  }
}

// A finger of which only a sliver is seen, or that the views see in different places, and that is
// far from where it should be though it was seen right before, is not there: that cap is another
// one's.
void FingertipTracker::Impl::DropJumps(TrackedFrame& frame) {
  constexpr double kFar = 0.018, kWhole = 0.6, kDisagree = 1;  // m; of a cap's pixels; px
  constexpr int kShort = 2;                                    // frames
  PerFinger<Eigen::Vector3d> off;
  std::array<PerFinger<double>, 3> sorted;
  int seen = 0;
  for (int f = 0; f < kNumFingers; ++f) {
    if (!frame.fingers[f].p_W) continue;
    off[f] = *frame.fingers[f].p_W - fingers[f].p_W - fingers[f].v_W;
    for (int k = 0; k < 3; ++k) sorted[k][seen] = off[f][k];
    ++seen;
  }
  if (seen < 3) return;
  Eigen::Vector3d common;
  for (int k = 0; k < 3; ++k) {
    std::sort(sorted[k].begin(), sorted[k].begin() + seen);
    common[k] = sorted[k][seen / 2];
  }
  int steady = 0;  // fingers that moved as the hand did
  for (int f = 0; f < kNumFingers; ++f) {
    steady +=
        frame.fingers[f].p_W && fingers[f].lost_frames == 0 && (off[f] - common).norm() < kFar;
  }
  for (int f = 0; f < kNumFingers; ++f) {
    const int lost = fingers[f].lost_frames;
    if (!frame.fingers[f].p_W || lost > kShort) continue;
    const bool sliver = std::min(views[0].mass[f], views[1].mass[f]) < kWhole;
    const bool alone = steady >= 3 && (lost > 0 || frame.fingers[f].residual_px > kDisagree);
    if (!(sliver && lost == 0) && !alone) continue;
    if ((off[f] - common).norm() < (1 + 0.5 * lost) * kFar) continue;
    frame.fingers[f] = TrackedFinger();
    for (View& view : views) view.active[f] = false;
  }
}

// Fingers pass each other, but they do not stay crossed: where both views have seen the same
// wrong order about the palm, and since it was right all those concerned were lost at some time,
// the labels were exchanged then. Fingers that were seen all the time have indeed crossed.
void FingertipTracker::Impl::RestoreOrder() {
  constexpr int kLong = 2;  // frames
  const PerFinger<bool> four = {false, true, true, true, true};
  std::array<PerFinger<int>, 2> order;
  bool all_seen = true, crossed = true;
  for (int v = 0; v < 2; ++v) {
    const View& view = views[v];
    all_seen = all_seen && std::count(view.active.begin() + kIndex, view.active.end(), true) == 4;
    crossed = crossed && !InFingerOrder(view.region, four, PalmPixel(v), turn[v]);
    order[v] = OrderAboutPalm(view.region, PalmPixel(v), turn[v]);
  }
  crossed = crossed && all_seen && order[0] == order[1];
  for (int f = kIndex; f < kNumFingers; ++f) {
    FingerState& state = fingers[f];
    if (!views[0].active[f] || !views[1].active[f]) state.was_lost = true;
    if (all_seen && order[0][f] == f) state.was_lost = false;
    crossed = crossed && (order[0][f] == f || state.was_lost);
  }
  disordered_frames = crossed ? disordered_frames + 1 : 0;
  if (disordered_frames < kLong) return;
  disordered_frames = 0;
  Permute(order[0]);
}

// Regions and their state to other fingers: finger f gets those of order[f].
void FingertipTracker::Impl::Permute(const PerFinger<int>& order, bool with_past) {
  const auto permute = [&](auto& values) {
    const auto before = values;
    for (int f = 0; f < kNumFingers; ++f) values[f] = before[order[f]];
  };
  if (with_past) permute(fingers);
  for (View& view : views) {
    permute(view.region);
    permute(view.motion);
    permute(view.active);
    permute(view.mass);
    permute(view.similarity);
    for (Regions& particle : view.particles.regions) permute(particle);
  }
}

// Regions that together would fit the fingers' pasts much better under other labels, or with a
// finger unseen, are given those: a finger jumps to a neighbour's cap when its own is hidden, and
// all may jump when the hand turns suddenly.
void FingertipTracker::Impl::Untangle() {
  constexpr double kGate =
      0.015;  // m, off where a finger should be; beyond, it may as well be lost
  constexpr double kMargin = 0.012;  // m; what is gained squared must be more than its square
  constexpr double kWhole = 0.6;     // of a cap's pixels: slivers do not tell how the hand moved
  PerFinger<std::optional<Eigen::Vector3d>> seen;
  PerFinger<Eigen::Vector3d> expected;
  std::array<PerFinger<double>, 3> moved;
  int whole = 0;
  for (int f = 0; f < kNumFingers; ++f) {
    expected[f] = fingers[f].p_W + fingers[f].v_W;
    if (!views[0].active[f] || !views[1].active[f]) continue;
    const auto point = Triangulate(cameras, views[0].region[f], views[1].region[f]);
    if (!point) continue;
    seen[f] = point->p_WQ;
    if (std::min(views[0].mass[f], views[1].mass[f]) < kWhole) continue;
    for (int k = 0; k < 3; ++k) moved[k][whole] = (*seen[f] - expected[f])[k];
    ++whole;
  }
  Eigen::Vector3d common = Eigen::Vector3d::Zero();
  for (int k = 0; k < 3 && whole >= 3; ++k) {
    std::sort(moved[k].begin(), moved[k].begin() + whole);
    common[k] = moved[k][whole / 2];
  }
  const auto cost_of = [&](const PerFinger<int>& order) {
    double cost = 0;
    for (int f = 0; f < kNumFingers; ++f) {
      const int g = order[f];
      // A lost finger may well stay lost, and where it is expected says less.
      const int lost = std::min(10, fingers[f].lost_frames);
      const double unseen = std::pow(lost > 0 ? 0.6 * kGate : kGate, 2);
      const double off = seen[g] ? (*seen[g] - expected[f] - common).norm() / (1 + 0.2 * lost) : 1;
      cost += std::min(off * off, unseen);
    }
    return cost;
  };
  PerFinger<int> order = {0, 1, 2, 3, 4};
  const double as_labelled = cost_of(order);
  if (as_labelled < kMargin * kMargin) return;
  PerFinger<int> best = order;
  double best_cost = as_labelled - kMargin * kMargin;
  while (std::next_permutation(order.begin(), order.end())) {
    const double cost = cost_of(order);
    if (cost < best_cost) best_cost = cost, best = order;
  }
  Permute(best, false);
  for (int f = 0; f < kNumFingers; ++f) {
    const int g = best[f];
    const double gate = kGate * (1 + 0.2 * std::min(10, fingers[f].lost_frames));
    if (!seen[g] || (*seen[g] - expected[f] - common).norm() < 2 * gate) continue;
    for (View& view : views) view.active[f] = false;
  }
}

}  // namespace springgrasp
