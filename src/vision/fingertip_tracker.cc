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

std::optional<TrackedFrame> FingertipTracker::Impl::Start(const cv::Mat& left,
                                                          const cv::Mat& right) {
  const std::array<const cv::Mat*, 2> pictures = {&left, &right};
  for (int v = 0; v < 2; ++v) CheckSize(*pictures[v], v);
  MarkerColourOptions gate = options.colour;
  if (!gate.hue_deg) gate.hue_deg = FindMarkerHue(left, gate);
  if (!gate.hue_deg) return std::nullopt;
  // Things of a similar colour behind the hand run together with its caps: closer gates part them.
  struct Closer {
    double hue, saturation, value;
  };
  constexpr std::array<Closer, 6> kCloser = {
      {{1, 0, 0}, {0.6, 0, 0}, {1, 0, 0.2}, {0.6, 0.2, 0.2}, {0.35, 0.2, 0}, {0.6, 0.2, 0.4}}};
  std::array<std::vector<MarkerBlob>, 2> blobs;
  std::optional<PerFinger<MarkerPair>> chosen;
  bool as_gated = true;  // by the first gate
  for (const Closer& closer : kCloser) {
    MarkerColourOptions tried = gate;
    tried.hue_tolerance_deg *= closer.hue;
    tried.min_saturation += closer.saturation;
    tried.min_value += closer.value;
    colour = MakeMarkerColour(tried);
    for (int v = 0; v < 2; ++v) {
      View& view = views[v];
      MapColours(*pictures[v], colour, Whole(v), view.likelihood, view.bins);
      // A cap of 9 mm radius at 1.5 m, half of it seen.
      const double radius = cameras.view(v).fx * 0.009 / 1.5;
      blobs[v] = SegmentMarkers(view.likelihood, std::max(6.0, 1.5 * radius * radius));
    }
    chosen = ChooseCaps(PairMarkers(cameras, blobs[0], blobs[1], options.max_epipolar_px),
                        options.cap.radius);
    if (chosen) break;
    as_gated = false;
  }
  if (!chosen) return std::nullopt;

  // Colour model from the chosen caps against the whole of the left picture.
  cv::Mat mask = cv::Mat::zeros(left.size(), CV_8UC1);
  double radius_px = 0, radius_by_area = 0;
  PerFinger<double> radii;
  std::vector<Eigen::Vector2d> cap_px;
  PerFinger<Eigen::Vector2d> caps_left, caps_right;
  for (int i = 0; i < kNumFingers; ++i) {
    const MarkerBlob& blob = blobs[0][(*chosen)[i].left];
    views[0].likelihood(blob.box).copyTo(mask(blob.box));
    radius_by_area += (*chosen)[i].radius / kNumFingers;
    radii[i] = 0;
    for (int v = 0; v < 2; ++v) {
      const cv::Rect& box = blobs[v][v == 0 ? (*chosen)[i].left : (*chosen)[i].right].box;
      radii[i] = std::max(radii[i], InscribedRadius(views[v].likelihood, box) *
                                        DepthOf(v, (*chosen)[i].point.p_WQ) / cameras.view(v).fx);
    }
    radius_px += std::sqrt(blob.area / std::numbers::pi) / kNumFingers;
    cap_px.push_back(blob.centre);
    caps_left[i] = blob.centre;
    caps_right[i] = blobs[1][(*chosen)[i].right].centre;
  }
  // A closer gate leaves only the middle of a cap: the size is then taken as usual.
  constexpr double kUsualRadius = 0.0095;  // m
  if (!as_gated) {
    colour = MakeMarkerColour(gate);
    radius_px = cameras.left.fx * kUsualRadius / DepthOf(0, (*chosen)[0].point.p_WQ);
  }
  LearnMarkerColour(left, mask, colour);
  // Some caps may be half hidden, and two that touch look like a larger one. A thimble seen from
  // somewhere between its side and its tip covers a fifth more than a disc.
  std::sort(radii.begin(), radii.end());
  if (cap.radius <= 0) {
    cap.radius = as_gated ? std::max(0.5 * (radii[2] + radii[3]), radius_by_area / std::sqrt(1.2))
                          : kUsualRadius;
    // What looks small is more likely half hidden than small.
    cap.radius += 0.6 * std::max(0.0, kUsualRadius - cap.radius);
  }

  // The palm: widest place of the skin near the caps, else the middle of the caps' arc.
  skin = LearnSkin(left, colour, cap_px, radius_px);
  HandMask hand;
  SegmentHand(left, skin, colour, cap_px, radius_px, Whole(0), 2, hand);
  Eigen::Vector2d palm =
      PalmCentre(hand, cap_px, radius_px, 16 * radius_px).value_or(PalmFromCaps(caps_left));
  const PerFinger<int> order = LabelFingers(caps_left, palm, options.hand);

  double depth = 0;
  for (int f = 0; f < kNumFingers; ++f) {
    const MarkerPair& pair = (*chosen)[order[f]];
    fingers[f] = FingerState();
    fingers[f].radius = cap.radius;
    fingers[f].p_W = pair.point.p_WQ;
    depth += DepthOf(0, pair.point.p_WQ) / kNumFingers;
    views[0].region[f] = blobs[0][pair.left].centre;
    views[1].region[f] = blobs[1][pair.right].centre;
  }
  const Eigen::Vector3d ray = PixelRay(cameras.left, palm);
  p_WPalm =
      cameras.left.X_WC.translation() + ray * (depth / cameras.left.X_WC.linear().col(2).dot(ray));
  for (int f = 0; f < kNumFingers; ++f) {
    fingers[f].axis_W =
        (fingers[f].p_W - p_WPalm).normalized() + kUsualDepth * cameras.left.X_WC.linear().col(2);
    fingers[f].axis_W.normalize();
  }
  for (int v = 0; v < 2; ++v) {
    View& view = views[v];
    MapColours(*pictures[v], colour, Whole(v), view.likelihood, view.bins);
    view.roi = Whole(v);
    view.motion.fill(Eigen::Vector2d::Zero());
    view.active.fill(true);
    view.particles = MakeParticles(view.region, options.particles.count);
    turn[v] = FingerTurn(view.region, PalmPixel(v));
    PerFinger<double> window;
    for (int f = 0; f < kNumFingers; ++f) window[f] = 1.3 * RadiusPx(v, fingers[f].p_W);
    const MeanShiftResult modes = MeanShift(view.likelihood, view.region, view.active, window);
    view.region = modes.centre;
    view.mass = modes.mass;
    Judge(v);
  }
  started = true;
  return Measure(pictures);
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

void FingertipTracker::Impl::TrackView(int v, const cv::Mat& bgr, RandomEngine& engine) {
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

  const Regions previous = view.region;
  PredictParticles(view.motion, options.particles, engine, view.particles);
  WeightParticles(view.bins, colour.model, previous, view.motion, view.active, radius,
                  options.particles, view.particles);
  Regions estimate = MeanRegions(view.particles);
  ResampleParticles(engine, view.particles);
  clock.Lap(1);
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
    TrackView(v, *pictures[v], engine);
  }
  StageClock clock(times);
  Search();
  RestoreOrder();
  clock.Lap(3);
  TrackedFrame frame = Measure(pictures);
  clock.Lap(4);
  DropShared(frame);

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

std::optional<TrackedFrame> FingertipTracker::Start(const cv::Mat& left, const cv::Mat& right) {
  return impl_->Start(left, right);
}

TrackedFrame FingertipTracker::Update(const cv::Mat& left, const cv::Mat& right,
                                      RandomEngine& engine) {
  return impl_->Update(left, right, engine);
}

bool FingertipTracker::started() const { return impl_->started; }

void FingertipTracker::SetHint(const HandModel& model, const HandFit& fit) {
  if (!fit.has_orientation || impl_->options.kind == TrackerKind::kPaper) return;
  // The palm's middle lies half way from the wrist to the knuckles, 4 cm along x.
  impl_->p_WPalm = fit.X_WH * Eigen::Vector3d(0.045 * fit.scale, 0, 0);
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
