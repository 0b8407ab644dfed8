// Inside of the fingertip tracker, shared by its sources only.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numbers>
#include <optional>

#include "base/error.h"
#include "vision/fingertip_tracker.h"
#include "vision/mean_shift.h"
#include "vision/skin_mask.h"

namespace springgrasp {
namespace tracker_internal {

// One camera's instance of the paper's tracker.
struct View {
  cv::Mat likelihood, bins;  // whole picture; valid in `roi`
  cv::Mat sums;              // integral of the likelihood over `roi`
  cv::Rect roi;
  ParticleSet particles;
  Regions region;  // mode of each finger, px
  Regions motion;  // last displacement, px per frame
  PerFinger<bool> active = {};
  PerFinger<double> mass = {};        // found over expected cap pixels
  PerFinger<double> similarity = {};  // of the colour
};

inline constexpr double kReturning =
    1.8;                                  // of TrackerOptions::min_mass, for a finger that was lost
inline constexpr double kOneCap = 1.2;    // two regions with no more pixels than this share a cap
inline constexpr int kRadiusFrames = 20;  // over which a cap's size is averaged

inline constexpr double kHintShare = 0.5;     // of the hand fit in a finger's direction
inline constexpr double kUsualDepth = -0.45;  // of a finger's direction along the optical axis

// Adds the time since the last lap to a stage.
class StageClock {
 public:
  explicit StageClock(TrackerTimes& times) : times_(times) {}
  void Lap(std::size_t stage) {
    const auto now = std::chrono::steady_clock::now();
    times_.seconds[stage] += std::chrono::duration<double>(now - last_).count();
    last_ = now;
  }

 private:
  TrackerTimes& times_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

// A pair of blobs that may be a finger's cap.
struct Choice {
  int left, right;
  Eigen::Vector3d off;  // m, from where the finger should be
  double cost;
};

// Five pairs of blobs that may be the caps of a hand.
struct StartingCaps {
  std::array<std::vector<MarkerBlob>, 2> blobs;
  PerFinger<MarkerPair> chosen;
  bool as_gated = true;      // by the widest gate
  MarkerColourOptions gate;  // the widest one
};

// What a search needs, kept so that no frame allocates.
struct SearchMemory {
  std::array<cv::Mat, 2> rest;  // cap pixels that no trusted finger claims
  std::array<std::vector<MarkerBlob>, 2> blobs;
  PerFinger<std::vector<Choice>> choices;
  MarkerScratch scratch;
};

// A finger's state between the views.
struct FingerState {
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();
  Eigen::Vector3d v_W = Eigen::Vector3d::Zero();  // m per frame
  Eigen::Vector3d axis_W = Eigen::Vector3d::UnitX();
  int lost_frames = 0;
  bool was_lost = false;  // since it was last seen in order
  double radius = 0;      // m, of this cap
  int radius_count = 0;
};

}  // namespace tracker_internal

struct FingertipTracker::Impl {
  StereoCameras cameras;
  TrackerOptions options;
  MarkerColour colour;
  CapShape cap;
  SkinModel skin;
  bool started = false;
  std::array<tracker_internal::View, 2> views;
  tracker_internal::SearchMemory memory;
  PerFinger<tracker_internal::FingerState> fingers;
  Eigen::Vector3d p_WPalm = Eigen::Vector3d::Zero();
  std::array<int, 2> turn = {0, 0};
  TrackerTimes times;
  int disordered_frames = 0;  // for how long both views have seen the fingers out of order

  Impl(const StereoCameras& c, const TrackerOptions& o)
      : cameras(c), options(o), colour(MakeMarkerColour(o.colour)), cap(o.cap) {
    for (int v = 0; v < 2; ++v) {
      const CameraModel& camera = cameras.view(v);
      views[v].likelihood = cv::Mat::zeros(camera.height, camera.width, CV_8UC1);
      views[v].bins = cv::Mat::zeros(camera.height, camera.width, CV_8UC1);
      views[v].sums = cv::Mat::zeros(camera.height + 1, camera.width + 1, CV_32SC1);
      memory.rest[v] = cv::Mat::zeros(camera.height, camera.width, CV_8UC1);
      memory.blobs[v].reserve(512);
    }
    for (auto& choices : memory.choices) choices.reserve(64);
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

  // Pixels of a whole cap seen along its axis as expected, over those of a disc of its radius.
  double CapArea(int v, int f) const {
    const double along = cameras.view(v).X_WC.linear().col(2).dot(fingers[f].axis_W);
    const double straight = cap.full_length() - 2 * cap.radius;
    return 1 + 2 * straight * std::sqrt(std::max(0.0, 1 - along * along)) /
                   (std::numbers::pi * cap.radius);
  }

  // The shape of finger f's cap: caps of one kind differ a little in size.
  CapShape ShapeOf(int f) const {
    CapShape shape = cap;
    shape.radius = fingers[f].radius;
    return shape;
  }

  std::optional<TrackedFrame> Start(const cv::Mat& left, const cv::Mat& right, int choice);
  std::optional<tracker_internal::StartingCaps> FindCaps(
      const std::array<const cv::Mat*, 2>& pictures, int choice);
  void Relabel(const PerFinger<int>& order, const Eigen::Vector3d& palm);
  TrackedFrame Update(const cv::Mat& left, const cv::Mat& right, RandomEngine& engine);
  void Map(int v, const cv::Mat& bgr);
  void TrackView(int v, RandomEngine& engine);
  void Judge(int v);
  void Settle(int v);
  void Search();
  PerFinger<bool> FindDoubtful() const;
  void Reseed(const PerFinger<bool>& doubtful);
  void DropCollisions();
  void DropShared(TrackedFrame& frame);
  void DropJumps(TrackedFrame& frame);
  void RestoreOrder();
  void Permute(const PerFinger<int>& order, bool with_past = true);
  void Untangle();
  void MoveTogether();
  static double Covered(const tracker_internal::View& view, const Eigen::Vector2d& at,
                        double radius);
  void Label(const PerFinger<Eigen::Vector3d>& p_WCaps, const PerFinger<int>& order);
  TrackedFrame Measure(const std::array<const cv::Mat*, 2>& pictures);
  Eigen::Vector2d PalmPixel(int v) const;
  Eigen::Vector3d ExpectedAxis(const std::array<const cv::Mat*, 2>& pictures, int f) const;
};

}  // namespace springgrasp
