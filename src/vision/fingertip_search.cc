#include "vision/fingertip_tracker_impl.h"

namespace springgrasp {

using namespace tracker_internal;  // NOLINT: the tracker's own names

// Lost, not where its past says, seen by the views in places that do not belong together, or on the
// wrong side of a neighbour.
PerFinger<bool> FingertipTracker::Impl::FindDoubtful() const {
  PerFinger<bool> doubtful = {};
  PerFinger<double> jump = {};  // m, from where the past says
  for (int f = 0; f < kNumFingers; ++f) {
    doubtful[f] = !views[0].active[f] || !views[1].active[f];
    if (doubtful[f]) continue;
    const auto point = Triangulate(cameras, views[0].region[f], views[1].region[f]);
    jump[f] = point ? (point->p_WQ - fingers[f].p_W - fingers[f].v_W).norm() : 1;
    doubtful[f] =
        jump[f] > 0.015 + fingers[f].v_W.norm() ||
        EpipolarDistance(cameras, views[0].region[f], views[1].region[f]) > options.max_epipolar_px;
  }
  // A thumb may well pass behind the index: order is held only against fingers that moved oddly.
  constexpr double kOdd = 0.008;  // m
  for (int v = 0; v < 2; ++v) {
    for (int f = 1; f < kNumFingers; ++f) {
      if (jump[f] < kOdd && jump[f - 1] < kOdd) continue;
      PerFinger<bool> pair = {};
      pair[f - 1] = views[v].active[f - 1];
      pair[f] = views[v].active[f];
      if (!InFingerOrder(views[v].region, pair, PalmPixel(v), turn[v])) {
        doubtful[f - 1] = doubtful[f - 1] || jump[f - 1] >= kOdd;
        doubtful[f] = doubtful[f] || jump[f] >= kOdd;
      }
    }
  }
  return doubtful;
}

// Lets all regions compete again, the doubtful ones from where their points in space should be now.
void FingertipTracker::Impl::Reseed(const PerFinger<bool>& doubtful) {
  for (int v = 0; v < 2; ++v) {
    View& view = views[v];
    for (int f = 0; f < kNumFingers; ++f) {
      if (!doubtful[f]) continue;
      const auto pixel = Project(cameras.view(v), fingers[f].p_W + fingers[f].v_W);
      view.active[f] = pixel && view.roi.contains(cv::Point(static_cast<int>(pixel->x()),
                                                            static_cast<int>(pixel->y())));
      if (view.active[f]) view.region[f] = *pixel;
    }
    Settle(v);
  }
  DropCollisions();
}

// All active regions to their modes, and judged there.
void FingertipTracker::Impl::Settle(int v) {
  View& view = views[v];
  PerFinger<double> window;
  for (int f = 0; f < kNumFingers; ++f) window[f] = 1.3 * RadiusPx(v, fingers[f].p_W);
  const MeanShiftResult modes = MeanShift(view.likelihood, view.region, view.active, window);
  view.mass = modes.mass;
  view.region = modes.centre;
  Judge(v);
}

// Two regions that share one cap's pixels: the finger whose cap it is not is hidden. That is the
// one that should be elsewhere; where both should be here, the one farther from the camera. The
// other takes the pixels over.
void FingertipTracker::Impl::DropCollisions() {
  constexpr double kElsewhere = 0.35;  // cap radii
  std::array<bool, 2> dropped = {};
  for (int v = 0; v < 2; ++v) {
    View& view = views[v];
    for (int f = 0; f < kNumFingers; ++f) {
      for (int g = 0; g < f; ++g) {
        if (!view.active[f] || !view.active[g]) continue;
        const int front = DepthOf(v, fingers[f].p_W) < DepthOf(v, fingers[g].p_W) ? f : g;
        const double r = RadiusPx(v, fingers[front].p_W);
        if ((view.region[f] - view.region[g]).norm() > 1.5 * r) continue;
        const auto area = [&](int finger) {
          const double own = RadiusPx(v, fingers[finger].p_W);
          return view.mass[finger] * own * own / (r * r);
        };
        const double both = area(f) + area(g);
        if (both > kOneCap * CapArea(v, front)) continue;
        const Eigen::Vector2d cap_px =
            (area(f) * view.region[f] + area(g) * view.region[g]) / std::max(1e-9, both);
        const auto off = [&](int finger) {
          const auto expected = Project(cameras.view(v), fingers[finger].p_W + fingers[finger].v_W);
          const double lost = 0.5 * std::min(5, fingers[finger].lost_frames);
          return (expected ? (*expected - cap_px).norm() / r : 1e9) + lost;
        };
        const double more = off(f) - off(g);
        const int loser = more > kElsewhere ? f : more < -kElsewhere ? g : front == f ? g : f;
        view.active[loser] = false;
        view.mass[loser] = view.similarity[loser] = 0;
        dropped[v] = true;
      }
    }
  }
  for (int v = 0; v < 2; ++v) {
    if (dropped[v]) Settle(v);
  }
}

// Fingers that are lost, out of order, or differ between the views are sought anew: first from
// where they should be, then among the cap pixels that no other finger claims.
void FingertipTracker::Impl::Search() {
  DropCollisions();
  PerFinger<bool> doubtful = FindDoubtful();
  const auto any = [&] { return std::count(doubtful.begin(), doubtful.end(), true) > 0; };
  if (!any()) return;
  Reseed(doubtful);
  doubtful = FindDoubtful();
  if (!any()) return;

  // Cap pixels that no trusted finger claims.
  auto& blobs = memory.blobs;
  for (int v = 0; v < 2; ++v) {
    cv::Mat& rest = memory.rest[v];
    views[v].likelihood(views[v].roi).copyTo(rest(views[v].roi));
    double smallest = 1e9, cap_area = 0;
    for (int f = 0; f < kNumFingers; ++f) {
      const double r = RadiusPx(v, fingers[f].p_W);
      smallest = std::min(smallest, std::numbers::pi * r * r);
      cap_area += std::numbers::pi * r * r * CapArea(v, f) / kNumFingers;
      if (doubtful[f]) continue;
      const Eigen::Vector2d& c = views[v].region[f];
      const int reach = static_cast<int>(std::ceil(1.45 * r));
      const cv::Rect box = cv::Rect(static_cast<int>(c.x()) - reach,
                                    static_cast<int>(c.y()) - reach, 2 * reach + 1, 2 * reach + 1) &
                           Whole(v);
      for (int y = box.y; y < box.y + box.height; ++y) {
        for (int x = box.x; x < box.x + box.width; ++x) {
          if (std::hypot(x - c.x(), y - c.y()) <= 1.45 * r) rest.at<std::uint8_t>(y, x) = 0;
        }
      }
    }
    SegmentMarkers(rest, 0.5 * options.min_mass * smallest, views[v].roi, memory.scratch, blobs[v],
                   options.kind == TrackerKind::kOutline ? cap_area : 0);
    if (blobs[v].size() > 8) blobs[v].resize(8);
  }

  // All ways to give the doubtful fingers a pair of blobs, or none; the cheapest.
  auto& choices = memory.choices;
  for (int f = 0; f < kNumFingers; ++f) {
    choices[f].clear();
    if (!doubtful[f]) continue;
    const Eigen::Vector3d expected = fingers[f].p_W + fingers[f].v_W;
    const double reach = options.search_radius * (1 + 0.25 * std::min(12, fingers[f].lost_frames)) +
                         2 * fingers[f].v_W.norm();
    for (int i = 0; i < static_cast<int>(blobs[0].size()); ++i) {
      for (int j = 0; j < static_cast<int>(blobs[1].size()); ++j) {
        const Eigen::Vector2d &l = blobs[0][i].centre, &r = blobs[1][j].centre;
        const double off = EpipolarDistance(cameras, l, r);
        if (off > options.max_epipolar_px) continue;
        const auto point = Triangulate(cameras, l, r);
        if (!point) continue;
        const Eigen::Vector3d away = point->p_WQ - expected;
        if (away.norm() > reach) continue;
        choices[f].push_back({i, j, away, away.squaredNorm() / (reach * reach) + 0.05 * off * off});
      }
    }
  }
  // Fingers that come back together are off in the same way: their differences tell more than how
  // far they are off. Two neighbours are some 20 mm apart.
  constexpr double kApart = 0.012;  // m
  const auto disagreement = [&](const PerFinger<const Choice*>& chosen) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    int count = 0;
    const auto counts = [&](int f) { return chosen[f] != nullptr && fingers[f].lost_frames > 0; };
    for (int f = 0; f < kNumFingers; ++f) {
      if (counts(f)) mean += chosen[f]->off, ++count;
    }
    double sum = 0;
    for (int f = 0; f < kNumFingers; ++f) {
      if (counts(f)) sum += (chosen[f]->off - mean / count).squaredNorm();
    }
    return sum / (kApart * kApart);
  };
  // Where fingers should cross, their crossing costs nothing.
  std::array<bool, 2> in_order;
  for (int v = 0; v < 2; ++v) {
    Regions expected;
    for (int f = 0; f < kNumFingers; ++f) {
      expected[f] =
          Project(cameras.view(v), fingers[f].p_W + fingers[f].v_W).value_or(views[v].region[f]);
    }
    in_order[v] = InFingerOrder(expected, {true, true, true, true, true}, PalmPixel(v), turn[v]);
  }
  PerFinger<const Choice*> current = {}, best = {};
  double best_cost = 1e9;
  const auto assign = [&](auto&& self, int f, double cost) -> void {
    if (cost >= best_cost) return;
    if (f == kNumFingers) {
      cost += disagreement(current);
      for (int v = 0; v < 2; ++v) {
        Regions regions = views[v].region;
        PerFinger<bool> seen = {};
        for (int g = 0; g < kNumFingers; ++g) {
          seen[g] = doubtful[g] ? current[g] != nullptr : true;
          if (current[g] != nullptr) {
            regions[g] = blobs[v][v == 0 ? current[g]->left : current[g]->right].centre;
          }
        }
        if (in_order[v] && !InFingerOrder(regions, seen, PalmPixel(v), turn[v])) cost += 0.3;
      }
      if (cost < best_cost) {
        best_cost = cost;
        best = current;
      }
      return;
    }
    if (!doubtful[f]) return self(self, f + 1, cost);
    for (const Choice& choice : choices[f]) {
      bool taken = false;
      for (int g = 0; g < f; ++g) {
        taken = taken || (current[g] != nullptr &&
                          (current[g]->left == choice.left || current[g]->right == choice.right));
      }
      if (taken) continue;
      current[f] = &choice;
      self(self, f + 1, cost + choice.cost);
    }
    current[f] = nullptr;
    self(self, f + 1, cost + 2);  // left unseen
  };
  assign(assign, 0, 0);

  for (int v = 0; v < 2; ++v) {
    View& view = views[v];
    for (int f = 0; f < kNumFingers; ++f) {
      if (!doubtful[f]) continue;
      view.active[f] = best[f] != nullptr;
      if (best[f] == nullptr) continue;
      view.region[f] = blobs[v][v == 0 ? best[f]->left : best[f]->right].centre;
      view.motion[f].setZero();
      for (Regions& particle : view.particles.regions) particle[f] = view.region[f];
    }
    Settle(v);
  }
  DropCollisions();
}

}  // namespace springgrasp
