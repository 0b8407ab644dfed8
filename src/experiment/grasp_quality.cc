#include "experiment/grasp_quality.h"

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace springgrasp {
namespace {

constexpr int kConeEdges = 8;

void AddWrench(const Eigen::Vector3d& force, const Eigen::Vector3d& torque, double radius,
               std::vector<double>& points) {
  for (int i = 0; i < 3; ++i) points.push_back(force[i]);
  for (int i = 0; i < 3; ++i) points.push_back(torque[i] / radius);
}

// Qhull wants a stream for its messages; ours goes nowhere.
std::FILE* DevNull() {
  static std::FILE* const file = std::fopen("/dev/null", "w");
  return file;
}

}  // namespace

GraspQuality6d EvaluateGraspQuality(const std::vector<QualityContact>& contacts,
                                    double object_radius,
                                    const std::vector<Eigen::Matrix<double, 6, 1>>& tasks) {
  GraspQuality6d quality;
  if (contacts.size() < 2) return quality;
  std::vector<double> points;
  for (const QualityContact& c : contacts) {
    const Eigen::Vector3d n = c.n.normalized();
    const Eigen::Vector3d t1 = n.unitOrthogonal();
    const Eigen::Vector3d t2 = n.cross(t1);
    for (int e = 0; e < kConeEdges; ++e) {
      const double angle = 2 * std::numbers::pi * e / kConeEdges;
      const Eigen::Vector3d f = n + c.friction * (std::cos(angle) * t1 + std::sin(angle) * t2);
      AddWrench(f, c.p.cross(f), object_radius, points);
    }
    for (const double sign : {-1.0, 1.0}) {
      AddWrench(n, c.p.cross(n) + sign * c.torsion * n, object_radius, points);
    }
  }
  // Qhull refuses flat sets: the wrenches span no volume, so there is no closure.
  qhT qhull;
  qh_zero(&qhull, nullptr);
  char command[] = "qhull Qt Pp";
  const int count = static_cast<int>(points.size() / 6);
  if (qh_new_qhull(&qhull, 6, count, points.data(), 0, command, nullptr, DevNull()) == 0) {
    qh_getarea(&qhull, qhull.facet_list);
    quality.volume = qhull.totvol;
    quality.epsilon = 1e300;
    std::vector<double> reach(tasks.size(), 1e300);
    for (const facetT* facet = qhull.facet_list; facet != nullptr && facet->next != nullptr;
         facet = facet->next) {
      // Outward unit normal and offset: the origin lies -offset below the facet's plane.
      quality.epsilon = std::min(quality.epsilon, -facet->offset);
      const Eigen::Map<const Eigen::Matrix<double, 6, 1>> normal(facet->normal);
      for (std::size_t i = 0; i < tasks.size(); ++i) {
        const double along = -normal.dot(tasks[i]);
        // With the origin outside, whatever lies beyond it is no way of withstanding.
        if (along > 1e-12) reach[i] = std::min(reach[i], -facet->offset / along);
      }
    }
    if (!tasks.empty()) quality.task = *std::min_element(reach.begin(), reach.end());
    if (quality.epsilon <= 0) quality.task = std::min(quality.task, 0.0);
  }
  qh_freeqhull(&qhull, True);
  int current = 0, total = 0;
  qh_memfreeshort(&qhull, &current, &total);
  return quality;
}

}  // namespace springgrasp
