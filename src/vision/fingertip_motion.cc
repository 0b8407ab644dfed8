#include <opencv2/imgproc.hpp>

#include "vision/fingertip_tracker_impl.h"

// How the hand as a whole has moved.
namespace springgrasp {

using namespace tracker_internal;  // NOLINT: the tracker's own names

// Mean likelihood, 0..1, in the square of 0.8 radii about a place.
double FingertipTracker::Impl::Covered(const View& view, const Eigen::Vector2d& at, double radius) {
  const double x = at.x() - view.roi.x + 0.5, y = at.y() - view.roi.y + 0.5, half = 0.8 * radius;
  const int x0 = std::max(0, static_cast<int>(std::lround(x - half)));
  const int y0 = std::max(0, static_cast<int>(std::lround(y - half)));
  const int x1 = std::min(view.roi.width, static_cast<int>(std::lround(x + half)));
  const int y1 = std::min(view.roi.height, static_cast<int>(std::lround(y + half)));
  if (x1 <= x0 || y1 <= y0) return 0;
  const int inside = view.sums.at<int>(y1, x1) - view.sums.at<int>(y0, x1) -
                     view.sums.at<int>(y1, x0) + view.sums.at<int>(y0, x0);
  return inside / (255.0 * 4 * half * half);
}

// Where the whole hand speeds up by more than a region reaches, the set of regions is shifted as
// one to where it covers most cap pixels of both views: five together are not mistaken for each
// other.
void FingertipTracker::Impl::MoveTogether() {
  constexpr int kSteps = 9;          // each way
  constexpr double kStep = 1.0 / 3;  // cap radii
  constexpr double kDrag = 0.03;     // regions' worth per cap radius of shift
  constexpr double kGain = 0.12;     // of the regions must be gained for a shift
  constexpr double kLeast = 0.6;     // of the regions must be covered after it
  struct Window {
    int v;
    Eigen::Vector2d at;
    double radius;
  };
  std::array<Window, 2 * kNumFingers> windows;
  int count = 0;
  double radius = 0;
  for (int v = 0; v < 2; ++v) {
    View& view = views[v];
    cv::Mat sums = view.sums(cv::Rect(0, 0, view.roi.width + 1, view.roi.height + 1));
    cv::integral(view.likelihood(view.roi), sums, CV_32S);
    for (int f = 0; f < kNumFingers; ++f) {
      if (!view.active[f]) continue;
      const double r = RadiusPx(v, fingers[f].p_W);
      const Eigen::Vector2d at = view.region[f] + view.motion[f];
      windows[count++] = {v, at, r};
      radius += r;
    }
  }
  if (count < 6) return;
  radius /= count;
  const auto covered = [&](double dx, double dy) {
    double sum = 0;
    for (int i = 0; i < count; ++i) {
      const Window& w = windows[i];
      sum += Covered(views[w.v], w.at + Eigen::Vector2d(dx, dy), w.radius);
    }
    return sum / count;
  };
  const double step = std::max(1.0, kStep * radius);
  const double here = covered(0, 0);
  double best = here + kGain, best_x = 0, best_y = 0;
  for (int j = -kSteps; j <= kSteps; ++j) {
    for (int i = -kSteps; i <= kSteps; ++i) {
      const double score =
          covered(i * step, j * step) - kDrag * std::hypot(i * step, j * step) / radius;
      if (score > best) best = score, best_x = i * step, best_y = j * step;
    }
  }
  if ((best_x == 0 && best_y == 0) || best < kLeast) return;
  for (View& view : views) {
    for (Eigen::Vector2d& motion : view.motion) motion += Eigen::Vector2d(best_x, best_y);
  }
  for (FingerState& finger : fingers) {
    const double scale = DepthOf(0, finger.p_W) / cameras.left.fx;
    finger.v_W += scale * (cameras.left.X_WC.linear() * Eigen::Vector3d(best_x, best_y, 0));
  }
}

}  // namespace springgrasp
