// Five capped fingertips in a stereo pair (section III-B): per view a particle filter over the set
// of regions and mean shift; between the views epipolar geometry; on top the outline fit of
// cap_fit.h, which the paper does not have.
//
// What the paper leaves open, and the choice here (motion and weights: particle_filter.h):
//  - first frame: pixels within a gate of hue, saturation and value; where things of that
//    colour run together with the caps, closer gates one after the other. Of all pairs of
//    blobs that the epipolar line allows, the five that look most like one hand;
//  - labels: by polar angle about the palm (widest place of the skin), from the widest gap
//    on, which is where the wrist is. With a model of the hand, its shape decides
//    (hand_follower.h);
//  - colour model: hue and saturation of these caps against the rest of the picture; value is
//    left out, since lamps change it. It is not adapted later: that would follow whatever
//    covers a cap;
//  - mean shift: all fingers at once, a pixel counts for the nearest region only;
//  - a region is lost when it holds too few cap pixels or another colour, or when the views
//    disagree by more than `max_epipolar_px`. Two regions with no more pixels than one cap:
//    the finger that should be elsewhere is lost, not both kept;
//  - search: first from where the finger should be (the hand's common motion, or the fit of
//    the whole hand), then among unclaimed blobs (kOutline: parted where caps touch), all
//    lost fingers at once, by distance, by agreement of their offsets and by finger order;
//  - sudden motion of the whole hand (kOutline): the set of regions is first shifted as one;
//  - labels (kOutline): where other labels explain all fingers' pasts much better, they are
//    taken; a finger that alone jumps out of a hand seen well is not reported;
//  - order about the palm: a violation starts a search; labels that both views see exchanged
//    for long are restored, but only of fingers that were lost since (fingers do pass each
//    other).
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string_view>

#include "base/fingers.h"
#include "base/random.h"
#include "vision/camera_model.h"
#include "vision/cap_fit.h"
#include "vision/hand_pose.h"
#include "vision/marker_colour.h"
#include "vision/marker_segmentation.h"
#include "vision/particle_filter.h"
#include "vision/skin_mask.h"

namespace springgrasp {

// kPaper: section III-B and no more, fingertips are the triangulated regions, followed on their
// own. kOutline: positions by the outline fit, and what the fit of the whole hand says is used.
enum class TrackerKind { kOutline, kPaper };
inline constexpr std::array<std::string_view, 2> kTrackerKinds = {"outline", "paper"};

struct TrackerOptions {
  TrackerKind kind = TrackerKind::kOutline;
  CapShape cap;  // radius 0: found in the first frame
  MarkerColourOptions colour;
  Handedness hand = Handedness::kRight;  // that shows its palm
  ParticleOptions particles;
  double max_epipolar_px = 3;   // beyond: the two regions are not the same cap
  double min_mass = 0.25;       // cap pixels over those expected; below: lost
  double min_similarity = 0.6;  // Bhattacharyya with the model; below: lost
  double search_radius = 0.04;  // m, about where a finger was lost; grows with time
};

struct TrackedFinger {
  std::array<std::optional<Eigen::Vector2d>, 2> pixel;  // left, right: centre of the cap, px
  std::optional<Eigen::Vector3d> p_W;     // centre of the whole cap, m; only if seen in both views
  std::optional<Eigen::Vector3d> axis_W;  // along the finger towards the tip, unit; a rough guess
  double confidence = 0;                  // 0..1: pixels found, colour, agreement of the views
  double residual_px = 0;                 // reprojection of the two regions (epipolar consistency)
};

struct TrackedFrame {
  PerFinger<TrackedFinger> fingers;
  int num_seen() const;  // fingers with p_W
};

// What a frame costs, for benchmarks; decides nothing.
inline constexpr std::array<std::string_view, 5> kTrackerStages = {"colours", "particles", "modes",
                                                                   "search", "outlines"};
struct TrackerTimes {
  std::array<double, kTrackerStages.size()> seconds = {};  // in each stage, since the start
  TrackerTimes& operator+=(const TrackerTimes& other) {
    for (std::size_t i = 0; i < seconds.size(); ++i) seconds[i] += other.seconds[i];
    return *this;
  }
};

// Owns the filters' state. Deterministic: all randomness comes from the engine.
class FingertipTracker {
 public:
  FingertipTracker(const StereoCameras& cameras, const TrackerOptions& options);
  ~FingertipTracker();
  FingertipTracker(FingertipTracker&&) noexcept;

  // Segments and labels the caps of the first frame. Nothing (and the tracker not started) if the
  // caps cannot be told: call again with the next frame. Throws Error if a picture has not the
  // camera's size. With `choice` that many likelier sets of caps are passed over: what else is
  // known of hands may tell against them.
  std::optional<TrackedFrame> Start(const cv::Mat& left, const cv::Mat& right, int choice = 0);
  // After a start: finger f's cap is that of finger order[f]; the palm lies at p_WPalm.
  void Relabel(const PerFinger<int>& order, const Eigen::Vector3d& p_WPalm);

  // The next frame. Requires Start.
  TrackedFrame Update(const cv::Mat& left, const cv::Mat& right, RandomEngine& engine);

  bool started() const;
  // What a fit of the whole hand says: palm (about which finger order is checked), directions of
  // the fingers, and where lost ones should be. Used by the next update.
  void SetHint(const HandModel& model, const HandFit& fit);
  const CapShape& cap() const;  // as given or found
  const MarkerColour& colour() const;
  const SkinModel& skin() const;                 // learned in the first frame
  const ParticleSet& particles(int view) const;  // after the last update
  const TrackerTimes& times() const;             // of all updates
  // Part of the picture looked at in the last update.
  cv::Rect region_of_interest(int view) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace springgrasp
