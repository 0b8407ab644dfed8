// Pictures of fingers with green caps, drawn by casting rays at capsules: tests without a renderer.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "vision/camera_model.h"

namespace springgrasp {

// A capsule of one colour (BGR).
struct DrawnCapsule {
  Eigen::Vector3d a, b;  // m, ends of the segment, in W
  double radius = 0.009;
  Eigen::Vector3d bgr{20, 160, 20};
};

// Ray parameter of the first hit of o + s d (unit d) with a capsule, and the normal there.
inline std::optional<double> HitCapsule(const DrawnCapsule& c, const Eigen::Vector3d& o,
                                        const Eigen::Vector3d& d, Eigen::Vector3d& normal) {
  const Eigen::Vector3d ba = c.b - c.a, oa = o - c.a;
  const double baba = ba.squaredNorm(), bad = ba.dot(d), baoa = ba.dot(oa);
  std::optional<double> best;
  const auto consider = [&](double s, const Eigen::Vector3d& axis_point) {
    if (s > 0 && (!best || s < *best)) {
      best = s;
      normal = (o + s * d - axis_point) / c.radius;
    }
  };
  // The tube.
  const double qa = baba - bad * bad, qb = baba * d.dot(oa) - baoa * bad,
               qc = baba * oa.squaredNorm() - baoa * baoa - c.radius * c.radius * baba;
  const double h = qb * qb - qa * qc;
  if (qa > 1e-12 && h > 0) {
    const double s = (-qb - std::sqrt(h)) / qa, along = baoa + s * bad;
    if (along > 0 && along < baba) consider(s, c.a + ba * (along / baba));
  }
  // The end balls.
  for (const Eigen::Vector3d& centre : {c.a, c.b}) {
    const Eigen::Vector3d oc = o - centre;
    const double b = d.dot(oc), k = b * b - oc.squaredNorm() + c.radius * c.radius;
    if (k > 0) consider(-b - std::sqrt(k), centre);
  }
  return best;
}

// Grey-brown texture that depends on the pixel only.
inline Eigen::Vector3d Background(double u, double v) {
  const double wave = 12 * std::sin(u / 9.0) * std::cos(v / 13.0) + 8 * std::sin((u + 2 * v) / 5.0);
  return {140 + wave, 150 + wave, 155 + 0.7 * wave};
}

// 3 x 3 rays per pixel, light from above the camera.
inline cv::Mat DrawCapsules(const CameraModel& camera, const std::vector<DrawnCapsule>& capsules) {
  cv::Mat picture(camera.height, camera.width, CV_8UC3);
  cv::Mat touched = cv::Mat::zeros(camera.height, camera.width, CV_8UC1);
  for (const DrawnCapsule& c : capsules) {
    double u0 = 1e9, v0 = 1e9, u1 = -1e9, v1 = -1e9;
    for (const Eigen::Vector3d& end : {c.a, c.b}) {
      const auto pixel = Project(camera, end);
      if (!pixel) continue;
      const double depth = (camera.X_WC.inverse() * end).z();
      const double r = 1.15 * camera.fx * c.radius / depth + 2;
      u0 = std::min(u0, pixel->x() - r), u1 = std::max(u1, pixel->x() + r);
      v0 = std::min(v0, pixel->y() - r), v1 = std::max(v1, pixel->y() + r);
    }
    if (u1 < u0) continue;
    const cv::Rect box = cv::Rect(cv::Point(static_cast<int>(u0), static_cast<int>(v0)),
                                  cv::Point(static_cast<int>(u1) + 1, static_cast<int>(v1) + 1)) &
                         cv::Rect(0, 0, camera.width, camera.height);
    if (!box.empty()) touched(box).setTo(1);
  }
  const Eigen::Vector3d o = camera.X_WC.translation();
  const Eigen::Vector3d light =
      camera.X_WC.linear() * Eigen::Vector3d(0.3, -0.5, -0.8).normalized();
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      Eigen::Vector3d colour = Background(u, v);
      if (touched.at<std::uint8_t>(v, u) != 0) {
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        for (int k = 0; k < 9; ++k) {
          const Eigen::Vector3d d =
              PixelRay(camera, {u + (k % 3 - 1) / 3.0, v + (k / 3 - 1) / 3.0});
          double nearest = 1e9;
          Eigen::Vector3d seen = colour;
          for (const DrawnCapsule& c : capsules) {
            Eigen::Vector3d normal = Eigen::Vector3d::Zero();
            const auto s = HitCapsule(c, o, d, normal);
            if (!s || *s >= nearest) continue;
            nearest = *s;
            seen = c.bgr * (0.45 + 0.55 * std::max(0.0, normal.dot(light)));
          }
          sum += seen / 9;
        }
        colour = sum;
      }
      for (int c = 0; c < 3; ++c) {
        picture.at<cv::Vec3b>(v, u)[c] =
            static_cast<std::uint8_t>(std::clamp(std::lround(colour[c]), 0L, 255L));
      }
    }
  }
  return picture;
}

// Two cameras 93 mm apart looking along z, slightly turned to each other.
inline StereoCameras TestEyes() {
  StereoCameras eyes;
  eyes.right.X_WC.translation() = Eigen::Vector3d(0.093, 0.001, -0.002);
  eyes.right.X_WC.linear() = Eigen::AngleAxisd(-0.06, Eigen::Vector3d::UnitY()).toRotationMatrix();
  return eyes;
}

inline constexpr double kCapRadius = 0.009, kCapLength = 0.025;
inline const Eigen::Vector3d kSkin{130, 165, 215};  // BGR

// A right hand's fingers, palm to the cameras, thumb to the right of the picture: tips on an arc
// about the palm, each with its cap (centre `tips[f]`) and a finger from it towards the palm.
struct DrawnHand {
  std::vector<Eigen::Vector3d> tips, axes;
  std::vector<DrawnCapsule> capsules;
};

inline DrawnHand MakeDrawnHand(const Eigen::Vector3d& palm, double close) {
  DrawnHand hand;
  // Polar angles as one sees the picture, counter-clockwise from the right, and distances.
  const double angle_deg[5] = {20, 70, 92, 112, 134};
  const double reach[5] = {0.085, 0.105, 0.11, 0.10, 0.085};
  for (int f = 0; f < 5; ++f) {
    const double a = angle_deg[f] * M_PI / 180, r = reach[f] * (1 - 0.45 * close);
    const Eigen::Vector3d out(std::cos(a), -std::sin(a), 0);
    const Eigen::Vector3d tip = palm + r * out + Eigen::Vector3d(0, 0, -0.02 - 0.03 * close);
    const Eigen::Vector3d axis = (out + Eigen::Vector3d(0, 0, -0.3 - 0.5 * close)).normalized();
    hand.tips.push_back(tip);
    hand.axes.push_back(axis);
    const double half = 0.5 * kCapLength - kCapRadius;
    hand.capsules.push_back({tip - half * axis, tip + half * axis, kCapRadius, {20, 160, 20}});
    hand.capsules.push_back({tip - 0.004 * axis, tip - 0.035 * axis, 0.0078, kSkin});
    hand.capsules.push_back({tip - 0.035 * axis, palm, 0.0085, kSkin});
  }
  hand.capsules.push_back({palm, palm + Eigen::Vector3d(0, 0.03, 0), 0.033, kSkin});
  hand.capsules.push_back({palm, palm + Eigen::Vector3d(0, 0.25, 0.03), 0.026, kSkin});
  return hand;
}

}  // namespace springgrasp
