#include "vision/wrist_depth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "vision/hand_pose.h"
#include "vision/skin_mask.h"

namespace springgrasp {
namespace {

constexpr double kReach = 0.06;    // m, each way
constexpr double kSleeve = 0.008;  // m, that a sleeve's rim, the usual edge there, stands off
constexpr int kSteps = 20;         // each way
constexpr double kStep = kReach / kSteps;

// A ball of palm or forearm as the left camera sees it.
struct Disc {
  Eigen::Vector2d pixel;
  double radius_px;
  double depth;  // m, of its centre
  double front;  // m, of its surface before that
  double lever;  // what its depth changes by, over the wrist's
};

// An entry of the left mask and where it would be in the right one, in entries.
struct Entry {
  float value;
  Eigen::Vector2f at;    // with the wrist where it is
  Eigen::Vector2f step;  // per step of the wrist
};

std::vector<Disc> DiscsOf(const HandModel& model, const CameraModel& camera, const HandFit& fit,
                          const Eigen::Vector3d& pivot_W) {
  std::vector<Disc> discs;
  const Eigen::Vector3d eye = camera.X_WC.translation(), forward = camera.X_WC.linear().col(2);
  const double arm = std::max(0.03, (fit.X_WH.translation() - pivot_W).norm());
  for (const HandBall& ball : model.balls) {
    if (ball.node != 0) continue;
    const Eigen::Vector3d p_W = fit.X_WH * Eigen::Vector3d(fit.scale * ball.p_B);
    const auto pixel = Project(camera, p_W);
    const double radius = fit.scale * ball.radius, depth = forward.dot(p_W - eye);
    if (!pixel || depth < 0.05) continue;
    const double front = radius + (ball.forearm ? kSleeve : 0);
    discs.push_back(
        {*pixel, camera.fx * radius / depth, depth, front, (p_W - pivot_W).norm() / arm});
  }
  return discs;
}

bool NearObject(const HandObservation& observation, int view, const Eigen::Vector2d& pixel,
                double margin) {
  if (observation.object == nullptr) return false;
  const ObjectDepth& object = observation.object->depth[static_cast<std::size_t>(view)];
  for (const double dx : {-margin, margin}) {
    for (const double dy : {-margin, margin}) {
      if (object.Covers(pixel + Eigen::Vector2d(dx, dy))) return true;
    }
  }
  return object.Covers(pixel);
}

cv::Mat Blurred(const cv::Mat& mask) {
  cv::Mat blurred;
  cv::GaussianBlur(mask, blurred, cv::Size(5, 5), 1);
  return blurred;
}

// Every other entry within 1.6 radii of a disc: skin and what is beside it.
std::vector<Entry> EntriesOf(const StereoCameras& cameras, const HandObservation& observation,
                             const cv::Mat& left, const std::vector<Disc>& discs) {
  constexpr double kBeside = 1.6;
  constexpr int kStride = 2;
  const HandMask &from = *observation.masks[0], &to = *observation.masks[1];
  // Of every entry looked at the nearest disc, by its distance in radii.
  struct Nearest {
    float off = static_cast<float>(kBeside);
    int disc = -1;
  };
  const int columns = left.cols / kStride, rows = left.rows / kStride;
  std::vector<Nearest> nearest(static_cast<std::size_t>(std::max(0, columns * rows)));
  for (std::size_t d = 0; d < discs.size(); ++d) {
    const Eigen::Vector2d middle = from.ToMask(discs[d].pixel) / kStride;
    const double radius = discs[d].radius_px / (from.step * kStride), reach = kBeside * radius;
    const int i1 = std::min(rows - 1, static_cast<int>(middle.y() + reach));
    const int j1 = std::min(columns - 1, static_cast<int>(middle.x() + reach));
    for (int i = std::max(0, static_cast<int>(std::ceil(middle.y() - reach))); i <= i1; ++i) {
      for (int j = std::max(0, static_cast<int>(std::ceil(middle.x() - reach))); j <= j1; ++j) {
        const auto off = static_cast<float>(std::hypot(j - middle.x(), i - middle.y()) / radius);
        Nearest& entry = nearest[static_cast<std::size_t>(i * columns + j)];
        if (off < entry.off) entry = {off, static_cast<int>(d)};
      }
    }
  }
  std::vector<Entry> entries;
  const Eigen::Vector3d eye = cameras.left.X_WC.translation();
  const Eigen::Vector3d forward = cameras.left.X_WC.linear().col(2);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const Nearest& found = nearest[static_cast<std::size_t>(i * columns + j)];
      if (found.disc < 0) continue;
      const Disc& disc = discs[static_cast<std::size_t>(found.disc)];
      const Eigen::Vector2d pixel = from.ToPixel(Eigen::Vector2d(kStride * j, kStride * i));
      if (NearObject(observation, 0, pixel, 3 * from.step)) continue;
      Eigen::Vector3d ray = PixelRay(cameras.left, pixel);
      ray /= ray.dot(forward);
      // Of the ball's surface, or at its outline of its centre.
      const double depth =
          disc.depth - disc.front * std::sqrt(std::max(0.0, 1.0 - found.off * found.off));
      const auto here = Project(cameras.right, eye + ray * depth);
      const auto beyond = Project(cameras.right, eye + ray * (depth + kStep * disc.lever));
      if (!here || !beyond || NearObject(observation, 1, *here, 3 * to.step)) continue;
      const Eigen::Vector2d at = to.ToMask(*here), step = to.ToMask(*beyond) - at;
      const Eigen::Vector2d ends[2] = {at - kSteps * step, at + kSteps * step};
      bool inside = true;
      for (const Eigen::Vector2d& end : ends) {
        inside = inside && end.x() >= 0 && end.y() >= 0 && end.x() < to.mask.cols - 1.001 &&
                 end.y() < to.mask.rows - 1.001;
      }
      if (!inside) continue;
      entries.push_back({float(left.at<std::uint8_t>(kStride * i, kStride * j)), at.cast<float>(),
                         step.cast<float>()});
    }
  }
  return entries;
}

double MeanSquare(const std::vector<Entry>& entries, const cv::Mat& right, int steps) {
  double sum = 0;
  for (const Entry& entry : entries) {
    const Eigen::Vector2f at = entry.at + static_cast<float>(steps) * entry.step;
    const int j = static_cast<int>(at.x()), i = static_cast<int>(at.y());
    const float a = at.x() - static_cast<float>(j), b = at.y() - static_cast<float>(i);
    const std::uint8_t *top = right.ptr(i) + j, *bottom = right.ptr(i + 1) + j;
    const float value =
        (1 - b) * ((1 - a) * top[0] + a * top[1]) + b * ((1 - a) * bottom[0] + a * bottom[1]);
    sum += (value - entry.value) * (value - entry.value);
  }
  return sum / static_cast<double>(entries.size());
}

}  // namespace

std::optional<WristDepth> MeasureWristDepth(const HandModel& model, const StereoCameras& cameras,
                                            const HandObservation& observation,
                                            const HandFit& about) {
  for (const HandMask* mask : observation.masks) {
    if (mask == nullptr || mask->mask.empty()) return std::nullopt;
  }
  Eigen::Vector3d pivot = Eigen::Vector3d::Zero();
  int tips = 0;
  for (const auto& tip : observation.tip_W) {
    if (tip) pivot += *tip, ++tips;
  }
  if (tips == 0) return std::nullopt;
  const std::vector<Disc> discs = DiscsOf(model, cameras.left, about, pivot / tips);
  const cv::Mat left = Blurred(observation.masks[0]->mask);
  const cv::Mat right = Blurred(observation.masks[1]->mask);
  const std::vector<Entry> entries = EntriesOf(cameras, observation, left, discs);
  constexpr std::size_t kFew = 40;
  if (entries.size() < kFew) return std::nullopt;
  std::array<double, 2 * kSteps + 1> cost;
  int best = 0;
  for (int i = 0; i <= 2 * kSteps; ++i) {
    cost[i] = MeanSquare(entries, right, i - kSteps);
    if (cost[i] < cost[best]) best = i;
  }
  if (best == 0 || best == 2 * kSteps) return std::nullopt;
  const double before = cost[best - 1], least = cost[best], after = cost[best + 1];
  const double curvature = before - 2 * least + after;
  if (curvature <= 0) return std::nullopt;
  // Entries at an edge err together.
  constexpr double kTogether = 8, kFloor = 30, kMost = 0.02;
  const double sigma = kStep * std::sqrt(2 * kTogether * std::max(kFloor, least) /
                                         (curvature * static_cast<double>(entries.size())));
  if (sigma > kMost) return std::nullopt;
  const double offset = (best - kSteps + 0.5 * (before - after) / curvature) * kStep;
  const Eigen::Vector3d forward = cameras.left.X_WC.linear().col(2);
  return WristDepth{
      forward.dot(about.X_WH.translation() - cameras.left.X_WC.translation()) + offset, sigma};
}

}  // namespace springgrasp
