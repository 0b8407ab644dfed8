#include "vision/cap_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace springgrasp {
namespace {

// Bilinear colour at a place, which must be inside the picture by one pixel.
Eigen::Vector3f ColourAt(const cv::Mat& bgr, const Eigen::Vector2d& place) {
  const int u = static_cast<int>(place.x()), v = static_cast<int>(place.y());
  const auto a = static_cast<float>(place.x() - u), b = static_cast<float>(place.y() - v);
  const std::uint8_t* top = bgr.ptr(v) + 3 * u;
  const std::uint8_t* bottom = bgr.ptr(v + 1) + 3 * u;
  Eigen::Vector3f colour;
  for (int c = 0; c < 3; ++c) {
    colour[c] = (1 - b) * ((1 - a) * top[c] + a * top[c + 3]) +
                b * ((1 - a) * bottom[c] + a * bottom[c + 3]);
  }
  return colour;
}

// Directions of the rays, even about the circle.
using Rays = std::array<std::array<double, 2>, kContourRays>;
const Rays kRays = [] {
  Rays rays;
  for (int k = 0; k < kContourRays; ++k) {
    const double angle = 2 * std::numbers::pi * k / kContourRays;
    rays[k] = {std::cos(angle), std::sin(angle)};
  }
  return rays;
}();

// A capsule in a picture: segment between two pixels with a radius at each end.
struct ImageCapsule {
  Eigen::Vector2d end[2];
  double radius[2];
  Eigen::Matrix<double, 2, 3> J[2];  // d end / d its point in W
};

std::optional<ImageCapsule> ProjectCapsule(const CameraModel& camera, const Eigen::Vector3d& p_W,
                                           const Eigen::Vector3d& axis_W, const CapShape& shape) {
  ImageCapsule capsule;
  for (int e = 0; e < 2; ++e) {
    const Eigen::Vector3d p_WE = p_W + (e == 0 ? shape.back() : shape.front()) * axis_W;
    const auto pixel = Project(camera, p_WE, &capsule.J[e]);
    if (!pixel) return std::nullopt;
    capsule.end[e] = *pixel;
    const double depth = camera.X_WC.linear().col(2).dot(p_WE - camera.X_WC.translation());
    capsule.radius[e] = camera.fx * shape.radius / depth;
  }
  return capsule;
}

// Signed distance of a point from the outline (positive outside); `t` in [0, 1] is where on the
// segment it is nearest, `normal` points outwards.
double OutlineDistance(const ImageCapsule& capsule, const Eigen::Vector2d& point, double& t,
                       Eigen::Vector2d& normal) {
  const Eigen::Vector2d along = capsule.end[1] - capsule.end[0];
  const double length2 = along.squaredNorm();
  t = length2 > 1e-9 ? std::clamp((point - capsule.end[0]).dot(along) / length2, 0.0, 1.0) : 0.5;
  const Eigen::Vector2d away = point - (capsule.end[0] + t * along);
  const double distance = away.norm();
  normal = distance > 1e-9 ? Eigen::Vector2d(away / distance) : Eigen::Vector2d(1, 0);
  return distance - ((1 - t) * capsule.radius[0] + t * capsule.radius[1]);
}

}  // namespace

CapContour TraceCap(const cv::Mat& bgr, const MarkerColour& colour, const Eigen::Vector2d& inside,
                    double reach_px) {
  CapContour contour;
  const auto in_picture = [&](const Eigen::Vector2d& p) {
    return p.x() >= 0 && p.y() >= 0 && p.x() < bgr.cols - 1 && p.y() < bgr.rows - 1;
  };
  // Purity: chroma over brightness, which shading leaves alone. First along whole pixels.
  constexpr int kMaxWalk = 64;   // px
  constexpr double kStep = 0.5;  // px, of the profile across the edge
  const int wanted = std::min(kMaxWalk, static_cast<int>(reach_px) + 1);
  std::array<Eigen::Vector3f, 10> profile;
  for (int k = 0; k < kContourRays; ++k) {
    const Eigen::Vector2d direction(kRays[k][0], kRays[k][1]);
    // Walk outwards until the colour has left for three pixels.
    int edge = -1, outside = 0;
    float full = 0;
    for (int n = 0; n < wanted; ++n) {
      const Eigen::Vector2d at = inside + n * direction;
      if (!in_picture(at)) break;
      const std::uint8_t* pixel =
          bgr.ptr(static_cast<int>(at.y() + 0.5)) + 3 * static_cast<int>(at.x() + 0.5);
      const float chroma = colour.Chroma(pixel);
      const auto sum = static_cast<float>(pixel[0] + pixel[1] + pixel[2] + 12);
      if (chroma > full * sum) full = chroma / sum;
      if (chroma < 0.5F * full * sum) {
        if (outside++ == 0) edge = n;
      } else {
        outside = 0;
      }
      if (outside >= 3) break;
    }
    if (outside < 3 || edge < 2 || full < 0.08F) continue;
    const double first = edge - 2.5;
    const Eigen::Vector2d ends[2] = {inside + first * direction,
                                     inside + (first + 9 * kStep) * direction};
    if (!in_picture(ends[0]) || !in_picture(ends[1])) continue;
    for (int i = 0; i < 10; ++i) profile[i] = ColourAt(bgr, ends[0] + i * kStep * direction);
    // Unmix: share of cap along the step between the colours either side, integrated.
    const Eigen::Vector3f rest = profile[9], step = profile[0] - rest;
    const float scale = step.squaredNorm();
    if (scale < 100) continue;
    double share = 0;
    for (const Eigen::Vector3f& sample : profile) {
      share += std::clamp((sample - rest).dot(step) / scale, 0.0F, 1.0F);
    }
    contour.point[k] = ends[0] + (share - 0.5) * kStep * direction;
    contour.valid[k] = true;
    ++contour.count;
  }
  return contour;
}

std::optional<CapFit> FitCap(const StereoCameras& cameras,
                             const std::array<CapContour, 2>& contours, const CapShape& shape,
                             const Eigen::Vector3d& start_W, const Eigen::Vector3d& axis_W,
                             const CapFitOptions& options) {
  CapFit fit;
  fit.p_W = start_W;
  fit.axis_W = axis_W.normalized();
  for (int iteration = 0; iteration <= options.iterations; ++iteration) {
    const Eigen::Vector3d side = fit.axis_W.unitOrthogonal(), up = fit.axis_W.cross(side);
    Eigen::Matrix<double, 5, 5> H = Eigen::Matrix<double, 5, 5>::Zero();
    Eigen::Matrix<double, 5, 1> g = Eigen::Matrix<double, 5, 1>::Zero();
    double sum_squares = 0, sum_radius = 0, sum_weights = 0;
    int agreeing = 0;
    // Wide at first, so that a start some pixels off is pulled in.
    const double scale = iteration < 2 ? 3 * options.inlier_px : options.inlier_px;
    for (int view = 0; view < 2; ++view) {
      const auto capsule = ProjectCapsule(cameras.view(view), fit.p_W, fit.axis_W, shape);
      if (!capsule) return std::nullopt;
      int agreeing_here = 0;
      for (int k = 0; k < kContourRays; ++k) {
        if (!contours[view].valid[k]) continue;
        double t;
        Eigen::Vector2d normal;
        const double d = OutlineDistance(*capsule, contours[view].point[k], t, normal);
        if (std::abs(d) < 1.5 * options.inlier_px) {
          ++agreeing_here;
          sum_squares += d * d;
        }
        const double ratio = d / (d > 0 ? scale : scale * options.hidden_px / options.inlier_px),
                     shrink = 1 + ratio * ratio;
        const double weight = 1 / (shrink * shrink);
        sum_radius += weight * shape.radius * (1 + d / capsule->radius[0]);
        sum_weights += weight;
        const Eigen::Matrix<double, 1, 3> J0 = -(1 - t) * normal.transpose() * capsule->J[0];
        const Eigen::Matrix<double, 1, 3> J1 = -t * normal.transpose() * capsule->J[1];
        Eigen::Matrix<double, 1, 5> J;
        J.head<3>() = J0 + J1;
        const Eigen::Vector3d turn = shape.front() * J1 + shape.back() * J0;
        J[3] = turn.dot(side);
        J[4] = turn.dot(up);
        H += weight * J.transpose() * J;
        g += weight * d * J.transpose();
      }
      agreeing += agreeing_here;
      fit.agreement[view] = static_cast<double>(agreeing_here) / kContourRays;
      if (iteration == options.iterations && agreeing_here < 6) return std::nullopt;
    }
    fit.radius = sum_weights > 0 ? sum_radius / sum_weights : shape.radius;
    fit.rms_px = agreeing > 0 ? std::sqrt(sum_squares / agreeing) : 1e9;
    if (iteration == options.iterations) break;
    // Prior on the axis: small deviation from the expected one.
    const double prior = options.axis_prior * options.axis_prior * kContourRays;
    const Eigen::Vector3d deviation = fit.axis_W - axis_W.normalized();
    H(3, 3) += prior;
    H(4, 4) += prior;
    g[3] += prior * deviation.dot(side);
    g[4] += prior * deviation.dot(up);
    H.diagonal().array() += 1e-9;
    const Eigen::Matrix<double, 5, 1> step = -H.ldlt().solve(g);
    if (!step.allFinite()) return std::nullopt;
    fit.p_W += step.head<3>();
    fit.axis_W = (fit.axis_W + step[3] * side + step[4] * up).normalized();
  }
  return fit;
}

}  // namespace springgrasp
