#include "vision/fingertip_tracker.h"

#include "vision/fingertip_tracker_impl.h"

namespace springgrasp {

using namespace tracker_internal;  // NOLINT: the tracker's own names

int TrackedFrame::num_seen() const {
  int seen = 0;
  for (const TrackedFinger& finger : fingers) seen += finger.p_W.has_value();
  return seen;
}

Eigen::Vector2d FingertipTracker::Impl::PalmPixel(int v) const {
  return Project(cameras.view(v), p_WPalm).value_or(Eigen::Vector2d(0, 0));
}

// Regions at the modes: how much cap there is in each, and of what colour.
void FingertipTracker::Impl::Judge(int v) {
  View& view = views[v];
  for (int f = 0; f < kNumFingers; ++f) {
    if (!view.active[f]) {
      view.mass[f] = view.similarity[f] = 0;
      continue;
    }
    const double r = RadiusPx(v, fingers[f].p_W);
    view.mass[f] /= std::numbers::pi * r * r;
    const Histogram histogram = RegionHistogram(view.bins, view.region[f], 0.8 * r);
    view.similarity[f] = Bhattacharyya(histogram, colour.model);
    // After a while out of sight a sliver might as well be a neighbour's.
    const double least = options.min_mass * (fingers[f].lost_frames >= 3 ? kReturning : 1);
    view.active[f] = view.mass[f] >= least && view.similarity[f] >= options.min_similarity;
  }
}

// Colours of the part of the picture where the fingers may be.
void FingertipTracker::Impl::Map(int v, const cv::Mat& bgr) {
  StageClock clock(times);
  View& view = views[v];
  PerFinger<double> radius;
  double u0 = 1e9, v0 = 1e9, u1 = -1e9, v1 = -1e9;
  for (int f = 0; f < kNumFingers; ++f) {
    radius[f] = RadiusPx(v, fingers[f].p_W);
    const Eigen::Vector2d at = view.region[f] + view.motion[f];
    const double margin = 4 * radius[f] + 8;
    u0 = std::min(u0, at.x() - margin), u1 = std::max(u1, at.x() + margin);
    v0 = std::min(v0, at.y() - margin), v1 = std::max(v1, at.y() + margin);
  }
  const cv::Rect around(cv::Point(static_cast<int>(u0), static_cast<int>(v0)),
                        cv::Point(static_cast<int>(u1) + 1, static_cast<int>(v1) + 1));
  view.roi = around & Whole(v);
  if (view.roi.empty()) view.roi = Whole(v);
  // Bins outside are stale: clear the frame of the region that particles might still touch.
  MapColours(bgr, colour, view.roi, view.likelihood, view.bins);
  clock.Lap(0);
}

void FingertipTracker::Impl::TrackView(int v, RandomEngine& engine) {
  StageClock clock(times);
  View& view = views[v];
  PerFinger<double> radius;
  for (int f = 0; f < kNumFingers; ++f) radius[f] = RadiusPx(v, fingers[f].p_W);
  const Regions previous = view.region;
  PredictParticles(view.motion, options.particles, engine, view.particles);
  WeightParticles(view.bins, colour.model, previous, view.motion, view.active, radius,
                  options.particles, view.particles);
  Regions estimate = MeanRegions(view.particles);
  ResampleParticles(engine, view.particles);
  clock.Lap(1);
  // Particles may be led away by larger things of the caps' colour: a region that finds a cap where
  // it was going to be needs none of them.
  constexpr double kFound = 0.5;
  for (int f = 0; f < kNumFingers && options.kind == TrackerKind::kOutline; ++f) {
    const Eigen::Vector2d predicted = previous[f] + view.motion[f];
    if (Covered(view, predicted, radius[f]) > kFound) estimate[f] = predicted;
  }
  // Beside a neighbour the visible parts attract each other's regions: there the estimate is where
  // the point in space should be, moved as the rest of the hand was.
  Eigen::Vector2d common = Eigen::Vector2d::Zero();
  Regions expected = estimate;
  PerFinger<bool> crowded = {};
  int alone = 0;
  for (int f = 0; f < kNumFingers; ++f) {
    expected[f] = Project(cameras.view(v), fingers[f].p_W + fingers[f].v_W).value_or(estimate[f]);
    for (int g = 0; g < kNumFingers; ++g) {
      crowded[f] = crowded[f] || (g != f && (estimate[f] - estimate[g]).norm() < 2.6 * radius[f]);
    }
    if (crowded[f] || !view.active[f]) continue;
    common += estimate[f] - expected[f];
    ++alone;
  }
  if (alone > 0) common /= alone;
  for (int f = 0; f < kNumFingers; ++f) {
    if (crowded[f]) estimate[f] = expected[f] + common;
  }
  PerFinger<double> window;
  for (int f = 0; f < kNumFingers; ++f) window[f] = 1.3 * radius[f];
  const MeanShiftResult modes = MeanShift(view.likelihood, estimate, view.active, window);
  for (int f = 0; f < kNumFingers; ++f) view.mass[f] = modes.mass[f];
  view.region = modes.centre;
  Judge(v);
  for (int f = 0; f < kNumFingers; ++f) {
    if (view.active[f]) continue;
    view.region[f] = previous[f] + view.motion[f];
  }
  clock.Lap(2);
}

TrackedFrame FingertipTracker::Impl::Update(const cv::Mat& left, const cv::Mat& right,
                                            RandomEngine& engine) {
  ThrowUnless(started, "fingertip tracker was not started");
  const std::array<const cv::Mat*, 2> pictures = {&left, &right};
  std::array<Regions, 2> before = {views[0].region, views[1].region};
  std::array<PerFinger<bool>, 2> active_before = {views[0].active, views[1].active};
  for (int v = 0; v < 2; ++v) {
    CheckSize(*pictures[v], v);
    Map(v, *pictures[v]);
  }
  const bool outline = options.kind == TrackerKind::kOutline;
  if (outline) MoveTogether();
  for (int v = 0; v < 2; ++v) TrackView(v, engine);
  StageClock clock(times);
  Search();
  if (outline) Untangle();
  RestoreOrder();
  clock.Lap(3);
  TrackedFrame frame = Measure(pictures);
  clock.Lap(4);
  DropShared(frame);
  if (outline) DropJumps(frame);

  // The hand's common motion carries what is not seen.
  Eigen::Vector3d common = Eigen::Vector3d::Zero();
  int seen = 0;
  for (int f = 0; f < kNumFingers; ++f) {
    if (!frame.fingers[f].p_W || fingers[f].lost_frames > 0) continue;
    common += *frame.fingers[f].p_W - fingers[f].p_W;
    ++seen;
  }
  if (seen > 0) common /= seen;
  p_WPalm += common;
  for (int f = 0; f < kNumFingers; ++f) {
    FingerState& state = fingers[f];
    if (frame.fingers[f].p_W) {
      const Eigen::Vector3d moved = *frame.fingers[f].p_W - state.p_W;
      state.v_W = state.lost_frames > 0 ? common : Eigen::Vector3d(0.5 * state.v_W + 0.5 * moved);
      state.p_W = *frame.fingers[f].p_W;
      state.axis_W = *frame.fingers[f].axis_W;
      state.lost_frames = 0;
    } else {
      state.p_W += common;
      state.v_W = common;
      ++state.lost_frames;
    }
    for (int v = 0; v < 2; ++v) {
      View& view = views[v];
      if (view.active[f] && active_before[v][f]) {
        view.motion[f] = view.region[f] - before[v][f];
      } else if (!view.active[f]) {
        // Follow the point in space, so that the region comes back with it.
        if (const auto pixel = Project(cameras.view(v), state.p_W)) view.region[f] = *pixel;
        view.motion[f] = Eigen::Vector2d::Zero();
        for (Regions& particle : view.particles.regions) particle[f] = view.region[f];
      }
    }
  }
  return frame;
}

FingertipTracker::FingertipTracker(const StereoCameras& cameras, const TrackerOptions& options)
    : impl_(std::make_unique<Impl>(cameras, options)) {}
FingertipTracker::~FingertipTracker() = default;
FingertipTracker::FingertipTracker(FingertipTracker&&) noexcept = default;

std::optional<TrackedFrame> FingertipTracker::Start(const cv::Mat& left, const cv::Mat& right,
                                                    int choice) {
  return impl_->Start(left, right, choice);
}

void FingertipTracker::Relabel(const PerFinger<int>& order, const Eigen::Vector3d& p_WPalm) {
  impl_->Relabel(order, p_WPalm);
}

TrackedFrame FingertipTracker::Update(const cv::Mat& left, const cv::Mat& right,
                                      RandomEngine& engine) {
  return impl_->Update(left, right, engine);
}

bool FingertipTracker::started() const { return impl_->started; }

void FingertipTracker::SetHint(const HandModel& model, const HandFit& fit) {
  if (!fit.has_orientation || impl_->options.kind == TrackerKind::kPaper) return;
  impl_->p_WPalm = PalmOf(fit);
  for (int f = 0; f < kNumFingers; ++f) {
    FingerState& state = impl_->fingers[f];
    const Eigen::Vector3d axis_W = FittedAxis(model, fit, f);
    state.axis_W = (state.axis_W + kHintShare * (axis_W - state.axis_W)).normalized();
    if (state.lost_frames > 0) state.p_W = FittedTip(model, fit, f);
  }
}

const SkinModel& FingertipTracker::skin() const { return impl_->skin; }
const TrackerTimes& FingertipTracker::times() const { return impl_->times; }
const CapShape& FingertipTracker::cap() const { return impl_->cap; }
const MarkerColour& FingertipTracker::colour() const { return impl_->colour; }
const ParticleSet& FingertipTracker::particles(int view) const {
  return impl_->views[view].particles;
}
cv::Rect FingertipTracker::region_of_interest(int view) const { return impl_->views[view].roi; }

}  // namespace springgrasp
