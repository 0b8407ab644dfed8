#include "vision/hand_follower.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "vision/hand_labels.h"
#include "vision/skin_mask.h"

namespace springgrasp {
namespace {

constexpr int kLongAgo = 1000;  // frames

}  // namespace

HandFollower::HandFollower(const KinematicTree& tree, const StereoCameras& cameras,
                           const HandPoseOptions& options,
                           const std::optional<DemonstratedObject>& object)
    : model_(MakeHandModel(tree)), cameras_(cameras), options_(options) {
  if (!object) return;
  object_ =
      KnownObject{*object, {SeeObject(cameras.left, *object), SeeObject(cameras.right, *object)}};
}

// Starts tracker and fit with the set of caps and the labels that look most like a hand. Nothing
// (and the tracker not started) if no set looks like one, as long as `must` is not set.
std::optional<TrackedFrame> HandFollower::Start(FingertipTracker& tracker, const StereoFrame& frame,
                                                bool must) {
  constexpr int kChoices = 12;
  constexpr double kSure = 80, kNoHand = 160;  // of the fit's cost
  struct Best {
    int choice;
    PerFinger<int> order;
    HandFit fit;
  };
  std::optional<Best> best;
  for (int choice = 0; choice < kChoices && (!best || best->fit.cost > kSure); ++choice) {
    const auto tracked = tracker.Start(frame.left, frame.right, choice);
    if (!tracked) break;
    HandObservation observation = Observe(frame, *tracked, tracker);
    for (const PerFinger<int>& order : LikelyLabels(*tracked)) {
      const HandObservation as_found = observation;
      for (int f = 0; f < kNumFingers; ++f) {
        observation.tip_W[f] = as_found.tip_W[order[f]];
        observation.confidence[f] = as_found.confidence[order[f]];
      }
      const auto fit = StartHandFit(model_, cameras_, observation, options_);
      observation = as_found;
      if (fit && (!best || fit->cost < best->fit.cost)) best = {choice, order, *fit};
    }
  }
  if (!must && (!best || best->fit.cost > kNoHand)) return std::nullopt;
  std::optional<TrackedFrame> tracked =
      tracker.Start(frame.left, frame.right, best ? best->choice : 0);
  if (!tracked || !best) return tracked;
  const TrackedFrame as_found = *tracked;
  for (int f = 0; f < kNumFingers; ++f) tracked->fingers[f] = as_found.fingers[best->order[f]];
  tracker.Relabel(best->order, PalmOf(best->fit));
  fit_ = best->fit;
  fresh_ = true;
  back_since_.fill(kLongAgo);
  return tracked;
}

const HandFit* HandFollower::Follow(const StereoFrame& frame, const TrackedFrame& tracked,
                                    const FingertipTracker& tracker, bool fit_scale) {
  if (std::exchange(fresh_, false)) return &*fit_;
  const HandObservation observation = Observe(frame, tracked, tracker);
  if (!fit_) {
    fit_ = StartHandFit(model_, cameras_, observation, options_);
    return fit_ ? &*fit_ : nullptr;
  }
  fit_before_ = fit_;
  step_before_ = step_;
  for (int f = 0; f < kNumFingers; ++f) {
    if (!tracked.fingers[f].p_W) {
      ++lost_for_[f];
      back_since_[f] = 0;
    } else {
      lost_for_[f] = 0;
      ++back_since_[f];
    }
  }
  fit_ = UpdateHandFit(model_, cameras_, observation, *fit_, step_, fit_scale, options_);
  Advance();
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

// What is to be expected of the next frame, from the last one's fit to this one's.
void HandFollower::Advance() {
  constexpr double kComesToRest = 0.93;  // of its speed per frame
  const Pose& before = fit_before_->X_WH;
  step_.position =
      0.5 * step_before_.position + 0.5 * (fit_->X_WH.translation() - before.translation());
  step_.rotation = 0.5 * step_before_.rotation +
                   0.5 * LogRotation(Eigen::Quaterniond(
                             Eigen::Matrix3d(fit_->X_WH.linear() * before.linear().transpose())));
  // A hidden finger goes on as it did, and comes to rest.
  step_.joints = step_before_.joints;
  if (step_.joints.size() == 0) step_.joints.setZero(fit_->q.size());
  for (int j = 0; j < static_cast<int>(fit_->q.size()); ++j) {
    const bool seen = lost_for_[model_.finger[j]] == 0;
    step_.joints[j] = seen ? 0.7 * step_.joints[j] + 0.3 * (fit_->q[j] - fit_before_->q[j])
                           : kComesToRest * step_.joints[j];
  }
}

void HandFollower::Restart(const HandObservation& seen) {
  astray_frames_ = 0;
  const auto anew = RestartHandFit(model_, cameras_, seen, *fit_, options_);
  if (!anew) return;
  fit_ = anew;
  step_ = {};
}

HandFit HandFollower::Refit(const HandObservation& seen, const PerFinger<int>& order,
                            const HandFit& last, const HandStep& step,
                            const HandPoseOptions& options) const {
  HandObservation observation = seen;
  for (int f = 0; f < kNumFingers; ++f) {
    observation.tip_W[f] = seen.tip_W[order[f]];
    observation.confidence[f] = seen.confidence[order[f]];
  }
  return UpdateHandFit(model_, cameras_, observation, last, step, false, options);
}

// Of fingers that were lost together some come back first, and which ones only the whole hand
// tells. They come in the order in which they lie across it.
HandFollower::Returning HandFollower::LabelsOfReturning(const HandObservation& seen) {
  constexpr int kSettled = 4, kAwaiting = 15;  // frames; while others of them are still lost
  constexpr double kBetter = 8, kSure = 8;     // of the cost
  const PerFinger<int> as_labelled = {0, 1, 2, 3, 4};
  Returning result{as_labelled, {}};
  const bool awaiting =
      std::any_of(lost_for_.begin() + kIndex, lost_for_.end(), [](int lost) { return lost > 0; });
  std::vector<int> fingers, caps, unseen;  // that were lost; of them those seen and those not
  for (int f = kIndex; f < kNumFingers; ++f) {
    if (back_since_[f] > (awaiting ? kAwaiting : kSettled)) continue;
    fingers.push_back(f);
    (seen.tip_W[f] ? caps : unseen).push_back(f);
  }
  if (!fit_before_ || caps.empty() || fingers.size() < 2) return result;
  // One or two caps of three or four may be anybody's: the fit follows them wherever they are put.
  if (fingers.size() >= 3 && caps.size() <= 2) {
    HandObservation without = seen;
    for (const int f : caps) {
      without.tip_W[f].reset();
      result.unsure[f] = true;
    }
    fit_ = Refit(without, as_labelled, *fit_before_, step_before_, options_);
    Advance();
    return result;
  }
  const Eigen::Vector3d across = fit_->X_WH.linear().col(1);
  const double side =
      across.dot(FittedTip(model_, *fit_, kIndex) - FittedTip(model_, *fit_, kPinkie));
  std::sort(caps.begin(), caps.end(), [&](int a, int b) {
    return side * across.dot(*seen.tip_W[a]) > side * across.dot(*seen.tip_W[b]);
  });
  struct Labelling {
    PerFinger<int> order;
    HandFit fit;
  };
  std::vector<Labelling> labellings = {
      {as_labelled, Refit(seen, as_labelled, *fit_before_, step_before_, options_)}};
  const auto n = static_cast<unsigned>(fingers.size());
  for (unsigned chosen = 0; chosen < 1U << n; ++chosen) {
    if (std::popcount(chosen) != static_cast<int>(caps.size())) continue;
    PerFinger<int> order = as_labelled;
    std::size_t next_cap = 0, next_unseen = 0;
    for (unsigned i = 0; i < n; ++i) {
      order[fingers[i]] = chosen >> i & 1 ? caps[next_cap++] : unseen[next_unseen++];
    }
    if (order == as_labelled) continue;
    labellings.push_back({order, Refit(seen, order, *fit_before_, step_before_, options_)});
  }
  std::size_t best = 0;
  double least = labellings[0].fit.cost - kBetter;
  for (std::size_t i = 1; i < labellings.size(); ++i) {
    if (labellings[i].fit.cost < least) least = labellings[i].fit.cost, best = i;
  }
  if (best != 0) {
    fit_ = labellings[best].fit;
    Advance();
  }
  result.order = labellings[best].order;
  for (const Labelling& other : labellings) {
    if (other.fit.cost > labellings[best].fit.cost + kSure) continue;
    for (const int f : fingers) {
      const int cap = result.order[f];
      if (seen.tip_W[cap] && other.order[f] != cap) result.unsure[f] = true;
    }
  }
  return result;
}

std::optional<PerFinger<int>> HandFollower::BetterLabels(const StereoFrame& frame,
                                                         const FingertipTracker& tracker,
                                                         TrackedFrame& tracked) {
  constexpr double kUnfit = 0.005;  // m, of the tips off the fit
  constexpr int kLong = 2;          // frames
  constexpr double kFar = 20;       // of the cost
  constexpr double kFree = 10;      // as much as usual may pose and joints change
  if (!fit_) return std::nullopt;
  const auto take_over = [&](const PerFinger<int>& order) {
    const TrackedFrame as_found = tracked;
    const PerFinger<int> lost_for = lost_for_, back_since = back_since_;
    for (int f = 0; f < kNumFingers; ++f) {
      tracked.fingers[f] = as_found.fingers[order[f]];
      lost_for_[f] = lost_for[order[f]];
      back_since_[f] = back_since[order[f]];
    }
    return order;
  };
  const bool returning = std::any_of(back_since_.begin() + kIndex, back_since_.end(),
                                     [](int since) { return 1 <= since && since <= 4; });
  if (returning) {
    const Returning found = LabelsOfReturning(Observe(frame, tracked, tracker));
    const bool changed = found.order != PerFinger<int>{0, 1, 2, 3, 4};
    if (changed) take_over(found.order);
    for (int f = 0; f < kNumFingers; ++f) {
      if (found.unsure[f]) tracked.fingers[f] = TrackedFinger();
    }
    if (changed) return found.order;
  }
  constexpr double kAstray = 60;  // of the cost: three times the usual one
  astray_frames_ = fit_->tips_used >= 4 && fit_->cost > kAstray ? astray_frames_ + 1 : 0;
  if (fit_->tips_used < 3 || fit_->tip_rms < kUnfit) {
    unfit_frames_ = 0;
    if (astray_frames_ >= kLong) Restart(Observe(frame, tracked, tracker));
    return std::nullopt;
  }
  if (++unfit_frames_ < kLong) return std::nullopt;
  unfit_frames_ = 0;
  HandPoseOptions free = options_;
  free.pose_sigma *= kFree;
  free.turn_sigma *= kFree;
  free.joint_sigma *= kFree;
  const HandObservation seen = Observe(frame, tracked, tracker);
  PerFinger<int> best = {0, 1, 2, 3, 4};
  HandFit fit = Refit(seen, best, *fit_, {}, free);
  const double rms = fit.tip_rms;
  double cost = fit.cost - kFar;
  bool found = false;
  for (int f = 0; f < kNumFingers; ++f) {
    for (int g = 0; g < f; ++g) {
      PerFinger<int> order = {0, 1, 2, 3, 4};
      std::swap(order[f], order[g]);
      if (!seen.tip_W[f] && !seen.tip_W[g]) continue;
      const HandFit other = Refit(seen, order, *fit_, {}, free);
      if (other.cost >= cost || other.tip_rms > 0.5 * rms) continue;
      cost = other.cost;
      fit = other;
      best = order;
      found = true;
    }
  }
  if (!found) {
    if (fit_->tips_used >= 4) Restart(seen);
    return std::nullopt;
  }
  fit_ = fit;
  return take_over(best);
}

HandObservation HandFollower::Observe(const StereoFrame& frame, const TrackedFrame& tracked,
                                      const FingertipTracker& tracker) {
  HandObservation observation;
  if (object_) observation.object = &*object_;
  for (int f = 0; f < kNumFingers; ++f) {
    observation.tip_W[f] = tracked.fingers[f].p_W;
    observation.confidence[f] = tracked.fingers[f].confidence;
  }
  // Skin is learned from the left picture.
  if (!white_balance_[0].has_reference()) {
    white_balance_[0].SetReference(frame.left);
    white_balance_[1].SetReference(frame.right, &frame.left);
  }
  for (int v = 0; v < 2; ++v) {
    if (Segment(v, v == 0 ? frame.left : frame.right, tracked, tracker)) {
      observation.masks[v] = &masks_[v];
    }
  }
  return observation;
}

// As the tracker has them, and two ways in which a hand fits the caps best.
std::vector<PerFinger<int>> HandFollower::LikelyLabels(const TrackedFrame& tracked) const {
  std::vector<PerFinger<int>> likely = {{0, 1, 2, 3, 4}};
  PerFinger<Eigen::Vector3d> caps;
  for (int f = 0; f < kNumFingers; ++f) {
    if (!tracked.fingers[f].p_W) return likely;
    caps[f] = *tracked.fingers[f].p_W;
  }
  const std::vector<HandLabels> ranked = RankLabels(model_, cameras_, caps);
  constexpr double kClear = 0.006;  // m
  for (int i = 0; i < 2; ++i) {
    if (ranked[i].order != likely[0]) likely.push_back(ranked[i].order);
    if (i == 0 && ranked[1].rms > ranked[0].rms + kClear) break;
  }
  return likely;
}

bool HandFollower::Segment(int v, const cv::Mat& bgr, const TrackedFrame& tracked,
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
  // Parts that an object cuts off from all caps: where the palm was last, moved on.
  std::vector<Eigen::Vector2d> palm;
  for (const HandBall& ball : model_.balls) {
    if (!fit_ || ball.node != 0) continue;
    const auto pixel =
        Project(camera, fit_->X_WH * Eigen::Vector3d(fit_->scale * ball.p_B) + step_.position);
    if (pixel) palm.push_back(*pixel);
  }
  SegmentHand(bgr, white_balance_[v].LevelsOf(bgr), tracker.skin(), tracker.colour(), caps, radius,
              palm, region, step, masks_[v]);
  return true;
}

// Which balls of the forearm lie on skin, in both pictures.
void HandFollower::CountForearm() {
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

}  // namespace springgrasp
