#include "vision/fingertip_tracker_impl.h"

// The first frame: caps found and labelled, colours learned.
namespace springgrasp {

using namespace tracker_internal;  // NOLINT: the tracker's own names

// The set of caps after `choice` likelier ones; `colour` and the likelihoods become those of its
// gate.
std::optional<StartingCaps> FingertipTracker::Impl::FindCaps(
    const std::array<const cv::Mat*, 2>& pictures, int choice) {
  MarkerColourOptions gate = options.colour;
  if (!gate.hue_deg) gate.hue_deg = FindMarkerHue(*pictures[0], gate);
  if (!gate.hue_deg) return std::nullopt;
  // Things of a similar colour behind the hand run together with its caps: closer gates part them.
  struct Closer {
    double hue, saturation, value;
  };
  constexpr std::array<Closer, 6> kCloser = {
      {{1, 0, 0}, {0.6, 0, 0}, {1, 0, 0.2}, {0.6, 0.2, 0.2}, {0.35, 0.2, 0}, {0.6, 0.2, 0.4}}};
  constexpr int kSetsOfGate = 3;  // beyond, sets of a gate differ in what is no cap
  for (std::size_t i = 0; i < kCloser.size(); ++i) {
    MarkerColourOptions tried = gate;
    tried.hue_tolerance_deg *= kCloser[i].hue;
    tried.min_saturation += kCloser[i].saturation;
    tried.min_value += kCloser[i].value;
    colour = MakeMarkerColour(tried);
    StartingCaps caps;
    for (int v = 0; v < 2; ++v) {
      View& view = views[v];
      MapColours(*pictures[v], colour, Whole(v), view.likelihood, view.bins);
      // A cap of 9 mm radius at 1.5 m, half of it seen.
      const double radius = cameras.view(v).fx * 0.009 / 1.5;
      caps.blobs[v] = SegmentMarkers(view.likelihood, std::max(6.0, 1.5 * radius * radius));
    }
    const std::vector<PerFinger<MarkerPair>> sets =
        ChooseCaps(PairMarkers(cameras, caps.blobs[0], caps.blobs[1], options.max_epipolar_px),
                   options.cap.radius, kSetsOfGate);
    if (choice >= static_cast<int>(sets.size())) {
      choice -= static_cast<int>(sets.size());
      continue;
    }
    caps.chosen = sets[choice];
    caps.as_gated = i == 0;
    caps.gate = gate;
    return caps;
  }
  return std::nullopt;
}

std::optional<TrackedFrame> FingertipTracker::Impl::Start(const cv::Mat& left, const cv::Mat& right,
                                                          int choice) {
  const std::array<const cv::Mat*, 2> pictures = {&left, &right};
  for (int v = 0; v < 2; ++v) CheckSize(*pictures[v], v);
  const std::optional<StartingCaps> caps = FindCaps(pictures, choice);
  if (!caps) return std::nullopt;
  const auto& blobs = caps->blobs;
  const auto* const chosen = &caps->chosen;
  const bool as_gated = caps->as_gated;
  cap = options.cap;

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
    colour = MakeMarkerColour(caps->gate);
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
  SegmentHand(left, SameLevels(), skin, colour, cap_px, radius_px, {}, Whole(0), 2, hand);
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
    Settle(v);
  }
  started = true;
  return Measure(pictures);
}

void FingertipTracker::Impl::Relabel(const PerFinger<int>& order, const Eigen::Vector3d& palm) {
  Permute(order);
  p_WPalm = palm;
  for (int v = 0; v < 2; ++v) turn[v] = FingerTurn(views[v].region, PalmPixel(v));
}

}  // namespace springgrasp
