#include "vision/track_demonstration.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "vision/skin_mask.h"

namespace springgrasp {
namespace {

// Follows H beside the fingertips.
class HandFollower {
 public:
  HandFollower(const KinematicTree& tree, const StereoCameras& cameras,
               const HandPoseOptions& options, const std::optional<DemonstratedObject>& object)
      : model_(MakeHandModel(tree)), cameras_(cameras), options_(options) {
    if (!object) return;
    object_ =
        KnownObject{*object, {SeeObject(cameras.left, *object), SeeObject(cameras.right, *object)}};
  }

  // Nothing as long as the hand was not found.
  const HandFit* Follow(const StereoFrame& frame, const TrackedFrame& tracked,
                        const FingertipTracker& tracker, bool fit_scale) {
    HandObservation observation;
    if (object_) observation.object = &*object_;
    for (int f = 0; f < kNumFingers; ++f) {
      observation.tip_W[f] = tracked.fingers[f].p_W;
      observation.confidence[f] = tracked.fingers[f].confidence;
    }
    for (int v = 0; v < 2; ++v) {
      if (Segment(v, v == 0 ? frame.left : frame.right, tracked, tracker)) {
        observation.masks[v] = &masks_[v];
      }
    }
    if (!fit_) {
      fit_ = StartHandFit(model_, cameras_, observation, options_);
      return fit_ ? &*fit_ : nullptr;
    }
    const Pose before = fit_->X_WH;
    fit_ = UpdateHandFit(model_, cameras_, observation, *fit_, step_, fit_scale, options_);
    step_.position = 0.5 * step_.position + 0.5 * (fit_->X_WH.translation() - before.translation());
    step_.rotation = 0.5 * step_.rotation +
                     0.5 * LogRotation(Eigen::Quaterniond(
                               Eigen::Matrix3d(fit_->X_WH.linear() * before.linear().transpose())));
    if (fit_scale) {
      CountForearm();
    } else if (forearm_frames_ > 0) {
      std::vector<bool> bare;
      for (const int seen : forearm_seen_) bare.push_back(2 * seen > forearm_frames_);
      KeepBareForearm(bare, model_);
      if (sleeve_x_.size() >= 4) {
        std::nth_element(sleeve_x_.begin(), sleeve_x_.begin() + sleeve_x_.size() / 2,
                         sleeve_x_.end());
        model_.sleeve_x = sleeve_x_[sleeve_x_.size() / 2];
      }
      forearm_frames_ = 0;
    }
    return &*fit_;
  }

  const HandModel& model() const { return model_; }

 private:
  bool Segment(int v, const cv::Mat& bgr, const TrackedFrame& tracked,
               const FingertipTracker& tracker) {
    std::vector<Eigen::Vector2d> caps;
    double radius = 0;
    const CameraModel& camera = cameras_.view(v);
    for (const TrackedFinger& finger : tracked.fingers) {
      if (!finger.pixel[v] || !finger.p_W) continue;
      caps.push_back(*finger.pixel[v]);
      const double depth = camera.X_WC.linear().col(2).dot(*finger.p_W - camera.X_WC.translation());
      radius += camera.fx * tracker.cap().radius / std::max(0.05, depth);
    }
    if (caps.empty()) return false;
    radius /= static_cast<double>(caps.size());
    // As far as a hand reaches from its tips.
    double u0 = 1e9, v0 = 1e9, u1 = -1e9, v1 = -1e9;
    for (const auto& cap : caps) {
      u0 = std::min(u0, cap.x()), u1 = std::max(u1, cap.x());
      v0 = std::min(v0, cap.y()), v1 = std::max(v1, cap.y());
    }
    const double reach = 17 * radius;
    const cv::Rect region =
        cv::Rect(cv::Point(static_cast<int>(u0 - reach), static_cast<int>(v0 - reach)),
                 cv::Point(static_cast<int>(u1 + reach), static_cast<int>(v1 + reach))) &
        cv::Rect(0, 0, bgr.cols, bgr.rows);
    if (region.area() < 100) return false;
    const int step = std::max(1, static_cast<int>(std::lround(options_.mask_step * radius)));
    SegmentHand(bgr, tracker.skin(), tracker.colour(), caps, radius, region, step, masks_[v]);
    return true;
  }

  // Which balls of the forearm lie on skin, in both pictures.
  void CountForearm() {
    forearm_seen_.resize(model_.balls.size());
    ++forearm_frames_;
    for (std::size_t i = 0; i < model_.balls.size(); ++i) {
      const HandBall& ball = model_.balls[i];
      if (!ball.forearm) continue;
      int views = 0;
      for (int v = 0; v < 2; ++v) {
        const auto pixel = Project(cameras_.view(v), fit_->X_WH * (fit_->scale * ball.p_B));
        views += pixel && OnSkin(masks_[v], *pixel);
      }
      forearm_seen_[i] += views == 2;
    }
    // Where the skin ends on the way up the forearm, if both pictures show it.
    constexpr double kStep = 0.002, kMost = 0.11;  // m
    double sum = 0;
    for (int v = 0; v < 2; ++v) {
      double x = 0;
      std::optional<Eigen::Vector2d> pixel;
      for (; x > -kMost; x -= kStep) {
        pixel = Project(cameras_.view(v), fit_->X_WH * Eigen::Vector3d(fit_->scale * x, 0, 0));
        if (!pixel || !OnSkin(masks_[v], *pixel)) break;
      }
      const CameraModel& camera = cameras_.view(v);
      if (x == 0 || x <= -kMost || !pixel || pixel->x() < 12 || pixel->y() < 12 ||
          pixel->x() > camera.width - 13 || pixel->y() > camera.height - 13) {
        return;
      }
      sum += x + 0.5 * kStep;
    }
    sleeve_x_.push_back(sum / 2);
  }

  HandModel model_;
  std::vector<int> forearm_seen_;
  std::vector<double> sleeve_x_;  // m, of the frames of the lead-in in which it was seen
  int forearm_frames_ = 0;
  StereoCameras cameras_;
  HandPoseOptions options_;
  std::array<HandMask, 2> masks_;
  std::optional<KnownObject> object_;
  std::optional<HandFit> fit_;
  HandStep step_;
};

}  // namespace

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
  int frames = 0, kept = 0;
  double scale = 0;
  while (const std::optional<StereoFrame> frame = source()) {
    if (!t_first) t_first = frame->t;
    const double t = frame->t - *t_first;
    TrackedFrame tracked;
    if (tracker.started()) {
      tracked = tracker.Update(frame->left, frame->right, engine);
    } else if (auto start = tracker.Start(frame->left, frame->right)) {
      tracked = *start;
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
