#include "vision/track_demonstration.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "vision/hand_follower.h"

namespace springgrasp {

Demonstration TrackStereo(const FrameSource& source, const StereoCameras& cameras,
                          const KinematicTree* hand, const TrackDemonstrationOptions& options,
                          RandomEngine& engine, const InstantCallback& on_frame,
                          TrackingSummary* summary) {
  FingertipTracker tracker(cameras, options.tracker);
  std::optional<HandFollower> follower;
  if (hand != nullptr) follower.emplace(*hand, cameras, options.hand_pose, options.object);

  Demonstration demonstration;
  demonstration.frame = options.frame;
  std::vector<HandSample> hand_track;
  std::vector<double> residuals;
  PerFinger<int> located = {};
  std::optional<double> t_first;
  // The paper's tracker labels by the palm alone.
  const bool by_hand = follower && options.tracker.kind != TrackerKind::kPaper;
  bool started = false;
  int frames = 0, kept = 0;
  constexpr int kAllLost = 3;  // frames, after which the hand is sought as in the first one
  int all_lost = 0;
  double scale = 0;
  while (const std::optional<StereoFrame> frame = source()) {
    if (!t_first) t_first = frame->t;
    const double t = frame->t - *t_first;
    TrackedFrame tracked;
    if (started) {
      tracked = tracker.Update(frame->left, frame->right, engine);
      all_lost = tracked.num_seen() == 0 ? all_lost + 1 : 0;
      if (by_hand && all_lost >= kAllLost) {
        if (const auto again = follower->Start(tracker, *frame, false)) tracked = *again;
      }
    } else if (auto start = by_hand ? follower->Start(tracker, *frame, t > options.max_wait / 2)
                                    : tracker.Start(frame->left, frame->right)) {
      tracked = *start;
      started = true;
    } else {
      if (t >= options.max_wait) {
        throw NotTracked(fmt::format(
            "no five fingertip markers of one hand found in both views in the first {} s",
            options.max_wait));
      }
      continue;
    }
    ++frames;
    const HandFit* fit = nullptr;
    if (follower) {
      fit = follower->Follow(*frame, tracked, tracker, t < options.scale_time);
      if (fit != nullptr && by_hand) {
        if (const auto order = follower->BetterLabels(*frame, tracker, tracked)) {
          tracker.Relabel(*order, PalmOf(*fit));
        }
      }
      if (fit != nullptr) {
        scale = fit->scale;
        tracker.SetHint(follower->model(), *fit);
      }
    }
    if (on_frame) on_frame({*frame, tracked, fit, tracker});
    // Half a microsecond of slack: times are sums of frame intervals.
    if (t < options.lead_in - 5e-7) continue;
    ++kept;
    DemonstrationSample sample;
    sample.t = t - options.lead_in;
    for (int f = 0; f < kNumFingers; ++f) {
      sample.p_WF[f] = tracked.fingers[f].p_W;
      sample.confidence[f] = tracked.fingers[f].p_W ? tracked.fingers[f].confidence : 0;
      if (!tracked.fingers[f].p_W) continue;
      ++located[f];
      residuals.push_back(tracked.fingers[f].residual_px);
    }
    demonstration.samples.push_back(sample);
    HandSample hand_sample;
    hand_sample.t = sample.t;
    if (fit != nullptr && fit->tips_used > 0) {
      hand_sample.p_WH = fit->X_WH.translation();
      if (fit->has_orientation) hand_sample.R_WH = Eigen::Quaterniond(fit->X_WH.linear());
    }
    hand_track.push_back(hand_sample);
  }
  ThrowUnless(t_first.has_value(), "no frame to track: the video is empty");
  if (frames == 0) {
    throw NotTracked(
        "no five fingertip markers of one hand found in both views in any of the frames");
  }

  if (options.smoothing > 0) hand_track = SmoothHandTrack(hand_track, options.smoothing);
  for (std::size_t i = 0; i < demonstration.samples.size(); ++i) {
    demonstration.samples[i].p_WH = hand_track[i].p_WH;
    demonstration.samples[i].R_WH = hand_track[i].R_WH;
  }
  if (summary != nullptr) {
    summary->frames = frames;
    for (int f = 0; f < kNumFingers; ++f) {
      summary->coverage[f] = kept > 0 ? static_cast<double>(located[f]) / kept : 0;
    }
    if (!residuals.empty()) {
      std::nth_element(residuals.begin(), residuals.begin() + residuals.size() / 2,
                       residuals.end());
      summary->epipolar_px = residuals[residuals.size() / 2];
    }
    summary->hand_scale = scale;
    summary->cap = tracker.cap();
  }
  return demonstration;
}

}  // namespace springgrasp
