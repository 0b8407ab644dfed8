#include "vision/fingertip_tracker.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "vision/mean_shift.h"
#include "vision/skin_mask.h"

namespace springgrasp {
namespace {

// One camera's instance of the paper's tracker.
struct View {
  cv::Mat likelihood, bins;  // whole picture; valid in `roi`
  cv::Rect roi;
  ParticleSet particles;
  Regions region;  // mode of each finger, px
  Regions motion;  // last displacement, px per frame
  PerFinger<bool> active = {};
  PerFinger<double> mass = {};        // found over expected cap pixels
  PerFinger<double> similarity = {};  // of the colour
};

constexpr int kRadiusFrames = 20;  // over which a cap's size is averaged

constexpr double kHintShare = 0.5;     // of the hand fit in a finger's direction
constexpr double kUsualDepth = -0.45;  // of a finger's direction along the optical axis

// A finger's state between the views.
struct FingerState {
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();
  Eigen::Vector3d v_W = Eigen::Vector3d::Zero();  // m per frame
  Eigen::Vector3d axis_W = Eigen::Vector3d::UnitX();
  int lost_frames = 0;
  double radius = 0;  // m, of this cap
  int radius_count = 0;
};

}  // namespace

int TrackedFrame::num_seen() const {
  int seen = 0;
  for (const TrackedFinger& finger : fingers) seen += finger.p_W.has_value();
  return seen;
}

struct FingertipTracker::Impl {
  StereoCameras cameras;
  TrackerOptions options;
  MarkerColour colour;
  CapShape cap;
  SkinModel skin;
  bool started = false;
  std::array<View, 2> views;
  PerFinger<FingerState> fingers;
  Eigen::Vector3d p_WPalm = Eigen::Vector3d::Zero();
  std::array<int, 2> turn = {0, 0};

  // The search after a violation: what is left of the likelihood once found caps are cut out.
  struct Candidate {
    MarkerBlob blob;
  };

  Impl(const StereoCameras& c, const TrackerOptions& o)
      : cameras(c), options(o), colour(MakeMarkerColour(o.colour)), cap(o.cap) {
    for (int v = 0; v < 2; ++v) {
      const CameraModel& camera = cameras.view(v);
      views[v].likelihood = cv::Mat::zeros(camera.height, camera.width, CV_8UC1);
      views[v].bins = cv::Mat::zeros(camera.height, camera.width, CV_8UC1);
    }
  }

  void CheckSize(const cv::Mat& picture, int v) const {
    const CameraModel& camera = cameras.view(v);
    ThrowUnless(
        picture.type() == CV_8UC3 && picture.cols == camera.width && picture.rows == camera.height,
        "{} picture is {}x{}, expected {}x{} BGR as its camera is calibrated for",
        v == 0 ? "left" : "right", picture.cols, picture.rows, camera.width, camera.height);
  }

  cv::Rect Whole(int v) const { return {0, 0, cameras.view(v).width, cameras.view(v).height}; }

  double DepthOf(int v, const Eigen::Vector3d& p_W) const {
    const Pose& X_WC = cameras.view(v).X_WC;
    return std::max(0.05, X_WC.linear().col(2).dot(p_W - X_WC.translation()));
  }

  double RadiusPx(int v, const Eigen::Vector3d& p_W) const {
    return cameras.view(v).fx * cap.radius / DepthOf(v, p_W);
  }

  // The shape of finger f's cap: caps of one kind differ a little in size.
  CapShape ShapeOf(int f) const {
    CapShape shape = cap;
    shape.radius = fingers[f].radius;
    return shape;
  }

  std::optional<TrackedFrame> Start(const cv::Mat& left, const cv::Mat& right);
  TrackedFrame Update(const cv::Mat& left, const cv::Mat& right, RandomEngine& engine);
  void TrackView(int v, const cv::Mat& bgr, RandomEngine& engine);
  void Judge(int v);
  void Search(const std::array<const cv::Mat*, 2>& pictures);
  void Label(const PerFinger<Eigen::Vector3d>& p_WCaps, const PerFinger<int>& order);
  TrackedFrame Measure(const std::array<const cv::Mat*, 2>& pictures);
  Eigen::Vector2d PalmPixel(int v) const;
  Eigen::Vector3d ExpectedAxis(const std::array<const cv::Mat*, 2>& pictures, int f) const;
};

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
  colour = MakeMarkerColour(gate);
  std::array<std::vector<MarkerBlob>, 2> blobs;
  for (int v = 0; v < 2; ++v) {
    View& view = views[v];
    MapColours(*pictures[v], colour, Whole(v), view.likelihood, view.bins);
    // A cap of 9 mm radius at 1.5 m, half of it seen.
    const double radius = cameras.view(v).fx * 0.009 / 1.5;
    blobs[v] = SegmentMarkers(view.likelihood, std::max(6.0, 1.5 * radius * radius));
  }
  const auto pairs = PairMarkers(cameras, blobs[0], blobs[1], options.max_epipolar_px);
  const auto chosen = ChooseCaps(pairs, options.cap.radius);
  if (!chosen) return std::nullopt;

  // Colour model from the chosen caps against the whole of the left picture.
  cv::Mat mask = cv::Mat::zeros(left.size(), CV_8UC1);
  double radius = 0, radius_px = 0;
  std::vector<Eigen::Vector2d> cap_px;
  PerFinger<Eigen::Vector2d> caps_left, caps_right;
  for (int i = 0; i < kNumFingers; ++i) {
    const MarkerBlob& blob = blobs[0][(*chosen)[i].left];
    views[0].likelihood(blob.box).copyTo(mask(blob.box));
    radius += (*chosen)[i].radius / kNumFingers;
    radius_px += std::sqrt(blob.area / std::numbers::pi) / kNumFingers;
    cap_px.push_back(blob.centre);
    caps_left[i] = blob.centre;
    caps_right[i] = blobs[1][(*chosen)[i].right].centre;
  }
  LearnMarkerColour(left, mask, colour);
  if (cap.radius <= 0) cap.radius = radius;

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
    view.mass[f] = std::min(1.0, view.mass[f] / (std::numbers::pi * r * r));
    const Histogram histogram = RegionHistogram(view.bins, view.region[f], 0.8 * r);
    view.similarity[f] = Bhattacharyya(histogram, colour.model);
    view.active[f] =
        view.mass[f] >= options.min_mass && view.similarity[f] >= options.min_similarity;
  }
}

void FingertipTracker::Impl::TrackView(int v, const cv::Mat& bgr, RandomEngine& engine) {
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

  const Regions previous = view.region;
  PredictParticles(view.motion, options.particles, engine, view.particles);
  WeightParticles(view.bins, colour.model, previous, view.motion, view.active, radius,
                  options.particles, view.particles);
  Regions estimate = MeanRegions(view.particles);
  PerFinger<double> window;
  for (int f = 0; f < kNumFingers; ++f) window[f] = 1.3 * radius[f];
  const MeanShiftResult modes = MeanShift(view.likelihood, estimate, view.active, window);
  for (int f = 0; f < kNumFingers; ++f) view.mass[f] = modes.mass[f];
  view.region = modes.centre;
  ResampleParticles(engine, view.particles);
  Judge(v);
  for (int f = 0; f < kNumFingers; ++f) {
    if (view.active[f]) continue;
    view.region[f] = previous[f] + view.motion[f];
  }
}

// Fingers that are lost, out of order, or differ between the views are sought anew, each within
// reach of where it should be, among the cap pixels that no other finger claims.
void FingertipTracker::Impl::Search(const std::array<const cv::Mat*, 2>&) {
  PerFinger<bool> doubtful = {};
  bool any = false;
  for (int f = 0; f < kNumFingers; ++f) {
    doubtful[f] = !views[0].active[f] || !views[1].active[f];
    if (!doubtful[f]) {
      const auto point = Triangulate(cameras, views[0].region[f], views[1].region[f]);
      const double reach = 0.03 + 3 * fingers[f].v_W.norm();
      doubtful[f] = !point ||
                    EpipolarDistance(cameras, views[0].region[f], views[1].region[f]) >
                        options.max_epipolar_px ||
                    (point->p_WQ - fingers[f].p_W - fingers[f].v_W).norm() > reach;
    }
  }
  for (int v = 0; v < 2; ++v) {
    // Out of order: neighbours that are on the wrong sides of each other.
    for (int f = 1; f < kNumFingers; ++f) {
      PerFinger<bool> pair = {};
      pair[f - 1] = views[v].active[f - 1];
      pair[f] = views[v].active[f];
      if (!InFingerOrder(views[v].region, pair, PalmPixel(v), turn[v])) {
        doubtful[f - 1] = doubtful[f] = true;
      }
    }
  }
  for (int f = 0; f < kNumFingers; ++f) any = any || doubtful[f];
  if (!any) return;

  // Cap pixels that no trusted finger claims.
  std::array<std::vector<MarkerBlob>, 2> blobs;
  for (int v = 0; v < 2; ++v) {
    cv::Mat rest = cv::Mat::zeros(views[v].likelihood.size(), CV_8UC1);
    views[v].likelihood(views[v].roi).copyTo(rest(views[v].roi));
    double smallest = 1e9;
    for (int f = 0; f < kNumFingers; ++f) {
      const double r = RadiusPx(v, fingers[f].p_W);
      smallest = std::min(smallest, std::numbers::pi * r * r);
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
    blobs[v] = SegmentMarkers(rest, 0.5 * options.min_mass * smallest, views[v].roi);
    if (blobs[v].size() > 8) blobs[v].resize(8);
  }

  // All ways to give the doubtful fingers a pair of blobs, or none; the cheapest.
  struct Choice {
    int left, right;
    Eigen::Vector3d p_W;
    double cost;
  };
  PerFinger<std::vector<Choice>> choices;
  for (int f = 0; f < kNumFingers; ++f) {
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
        const double distance = (point->p_WQ - expected).norm() / reach;
        if (distance > 1) continue;
        choices[f].push_back({i, j, point->p_WQ, distance * distance + 0.05 * off * off});
      }
    }
  }
  PerFinger<const Choice*> current = {}, best = {};
  double best_cost = 1e9;
  const auto assign = [&](auto&& self, int f, double cost) -> void {
    if (cost >= best_cost) return;
    if (f == kNumFingers) {
      for (int v = 0; v < 2; ++v) {
        Regions regions = views[v].region;
        PerFinger<bool> seen = {};
        for (int g = 0; g < kNumFingers; ++g) {
          seen[g] = doubtful[g] ? current[g] != nullptr : true;
          if (current[g] != nullptr) {
            regions[g] = blobs[v][v == 0 ? current[g]->left : current[g]->right].centre;
          }
        }
        if (!InFingerOrder(regions, seen, PalmPixel(v), turn[v])) cost += 1;
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
    PerFinger<double> window;
    for (int f = 0; f < kNumFingers; ++f) {
      window[f] = 1.3 * RadiusPx(v, fingers[f].p_W);
      if (!doubtful[f]) continue;
      view.active[f] = best[f] != nullptr;
      if (best[f] == nullptr) continue;
      view.region[f] = blobs[v][v == 0 ? best[f]->left : best[f]->right].centre;
      view.motion[f].setZero();
      for (Regions& particle : view.particles.regions) particle[f] = view.region[f];
    }
    const MeanShiftResult modes = MeanShift(view.likelihood, view.region, view.active, window);
    for (int f = 0; f < kNumFingers; ++f) {
      if (view.active[f]) view.region[f] = modes.centre[f];
      view.mass[f] = modes.mass[f];
    }
    Judge(v);
  }
}

// The finger's direction: in the picture plane away from the skin next to the cap, in depth as
// before.
Eigen::Vector3d FingertipTracker::Impl::ExpectedAxis(const std::array<const cv::Mat*, 2>& pictures,
                                                     int f) const {
  const Eigen::Vector3d& before = fingers[f].axis_W;
  Eigen::Vector3d across = Eigen::Vector3d::Zero();
  for (int v = 0; v < 2; ++v) {
    if (!views[v].active[f]) continue;
    const double r = RadiusPx(v, fingers[f].p_W);
    const Eigen::Vector2d away = -SkinDirection(*pictures[v], skin, views[v].region[f], r);
    across += 0.5 * cameras.view(v).X_WC.linear() * Eigen::Vector3d(away.x(), away.y(), 0);
  }
  const double strength = across.norm();
  if (strength < 0.2) return before;
  const Eigen::Vector3d forward = cameras.left.X_WC.linear().col(2);
  // Fingers of a palm that faces the camera bend towards it: a weak pull, which outlines overrule.
  const double depth = 0.85 * before.dot(forward) + 0.15 * kUsualDepth;
  const Eigen::Vector3d flat = across - across.dot(forward) * forward;
  const Eigen::Vector3d seen =
      depth * forward + std::sqrt(std::max(0.0, 1 - depth * depth)) * flat.normalized();
  return (before + std::min(1.0, 1.5 * strength) * seen).normalized();
}

// Positions in space from the regions of both views.
TrackedFrame FingertipTracker::Impl::Measure(const std::array<const cv::Mat*, 2>& pictures) {
  TrackedFrame frame;
  for (int f = 0; f < kNumFingers; ++f) {
    TrackedFinger& out = frame.fingers[f];
    for (int v = 0; v < 2; ++v) {
      if (views[v].active[f]) out.pixel[v] = views[v].region[f];
    }
    if (!out.pixel[0] || !out.pixel[1]) continue;
    const auto point = Triangulate(cameras, *out.pixel[0], *out.pixel[1]);
    if (!point) continue;
    out.residual_px = EpipolarDistance(cameras, *out.pixel[0], *out.pixel[1]);
    if (out.residual_px > options.max_epipolar_px) continue;
    out.p_W = point->p_WQ;
    out.axis_W = fingers[f].axis_W;
    double agreement = 1;
    if (options.fit_outlines) {
      std::array<CapContour, 2> contours;
      for (int v = 0; v < 2; ++v) {
        const double r = RadiusPx(v, *out.p_W);
        contours[v] = TraceCap(*pictures[v], colour, *out.pixel[v],
                               1.1 * r * cap.full_length() / cap.radius + 4);
      }
      const auto fit = FitCap(cameras, contours, ShapeOf(f), *out.p_W, ExpectedAxis(pictures, f));
      // A fit that wanders off was led by something else than this cap.
      if (fit && (fit->p_W - *out.p_W).norm() < 0.025) {
        out.p_W = fit->p_W;
        out.axis_W = fit->axis_W;
        agreement = std::min(1.0, 1.6 * std::min(fit->agreement[0], fit->agreement[1]));
        for (int v = 0; v < 2; ++v) out.pixel[v] = Project(cameras.view(v), fit->p_W);
        // A running mean over the first frames in which nearly the whole outline is seen.
        FingerState& state = fingers[f];
        if (agreement > 0.9 && state.radius_count < kRadiusFrames) {
          const double radius = std::clamp(fit->radius, 0.85 * cap.radius, 1.15 * cap.radius);
          state.radius += (radius - state.radius) / (2 + state.radius_count++);
        }
      } else {
        agreement = 0.3;
      }
    }
    const double mass = std::min(views[0].mass[f], views[1].mass[f]);
    const double similarity = std::min(views[0].similarity[f], views[1].similarity[f]);
    const double together = std::exp(-0.5 * std::pow(out.residual_px / options.max_epipolar_px, 2));
    out.confidence = std::min(1.0, 1.2 * mass) * similarity * together * (0.4 + 0.6 * agreement);
  }
  return frame;
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
  Search(pictures);
  const TrackedFrame frame = Measure(pictures);

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
  if (!fit.has_orientation) return;
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
const CapShape& FingertipTracker::cap() const { return impl_->cap; }
const MarkerColour& FingertipTracker::colour() const { return impl_->colour; }
const ParticleSet& FingertipTracker::particles(int view) const {
  return impl_->views[view].particles;
}
cv::Rect FingertipTracker::region_of_interest(int view) const { return impl_->views[view].roi; }

}  // namespace springgrasp
