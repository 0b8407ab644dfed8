#include "vision/marker_segmentation.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <tuple>

namespace springgrasp {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

double PolarAngle(const Eigen::Vector2d& point, const Eigen::Vector2d& centre) {
  return std::atan2(point.y() - centre.y(), point.x() - centre.x());
}

// Disagreement of five pairs: spread of log radius, and their distance from the known one.
std::optional<double> HandCost(const std::array<const MarkerPair*, kNumFingers>& set,
                               double cap_radius) {
  double mean = 0, cost = 0;
  for (const MarkerPair* pair : set) mean += std::log(pair->radius) / kNumFingers;
  double spread = 0;
  for (int i = 0; i < kNumFingers; ++i) {
    cost += std::abs(std::log(set[i]->radius) - mean) + 0.1 * set[i]->point.residual_px;
    if (cap_radius > 0) cost += std::abs(std::log(set[i]->radius / cap_radius));
    for (int j = 0; j < i; ++j) {
      if (set[i]->left == set[j]->left || set[i]->right == set[j]->right) return std::nullopt;
      const double distance = (set[i]->point.p_WQ - set[j]->point.p_WQ).norm();
      if (distance > 0.26 || distance < 0.008) return std::nullopt;
      spread += distance;
    }
  }
  return cost + spread;  // ten distances of decimetres: about 1, as the radii
}

// Parts a region into `count` by k-means, begun at equal steps along its longest extent.
void PartBlob(const cv::Mat& labels, int label, const cv::Rect& region, const MarkerBlob& whole,
              int count, std::vector<MarkerBlob>& blobs) {
  constexpr int kMost = 5, kRounds = 6;
  count = std::min(count, kMost);
  const cv::Rect box = whole.box - region.tl();
  const auto each = [&](auto&& visit) {
    for (int y = box.y; y < box.y + box.height; ++y) {
      const int* row = labels.ptr<int>(y);
      for (int x = box.x; x < box.x + box.width; ++x) {
        if (row[x] == label) visit(Eigen::Vector2d(x + region.x, y + region.y));
      }
    }
  };
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  each([&](const Eigen::Vector2d& at) {
    spread += (at - whole.centre) * (at - whole.centre).transpose() / whole.area;
  });
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(spread);
  const Eigen::Vector2d along = solver.eigenvectors().col(1);
  // A rod of that spread is the square root of twelve deviations long.
  const double length = std::sqrt(12 * solver.eigenvalues()[1]);
  std::array<MarkerBlob, kMost> parts;
  for (int k = 0; k < count; ++k) {
    parts[k].centre = whole.centre + along * length * ((k + 0.5) / count - 0.5);
  }
  for (int round = 0; round < kRounds; ++round) {
    std::array<Eigen::Vector2d, kMost> sum;
    sum.fill(Eigen::Vector2d::Zero());
    std::array<cv::Rect, kMost> boxes = {};
    std::array<int, kMost> area = {};
    each([&](const Eigen::Vector2d& at) {
      int nearest = 0;
      for (int k = 1; k < count; ++k) {
        if ((at - parts[k].centre).squaredNorm() < (at - parts[nearest].centre).squaredNorm()) {
          nearest = k;
        }
      }
      sum[nearest] += at;
      ++area[nearest];
      const cv::Rect pixel(static_cast<int>(at.x()), static_cast<int>(at.y()), 1, 1);
      boxes[nearest] = boxes[nearest].empty() ? pixel : boxes[nearest] | pixel;
    });
    for (int k = 0; k < count; ++k) {
      if (area[k] == 0) continue;
      parts[k] = {sum[k] / area[k], static_cast<double>(area[k]), boxes[k]};
    }
  }
  blobs.insert(blobs.end(), parts.begin(), parts.begin() + count);
}

}  // namespace

std::vector<MarkerBlob> SegmentMarkers(const cv::Mat& likelihood, double min_area,
                                       cv::Rect region) {
  MarkerScratch scratch;
  std::vector<MarkerBlob> blobs;
  SegmentMarkers(likelihood, min_area, region, scratch, blobs);
  return blobs;
}

void SegmentMarkers(const cv::Mat& likelihood, double min_area, cv::Rect region,
                    MarkerScratch& scratch, std::vector<MarkerBlob>& blobs, double cap_area) {
  if (region.empty()) region = {0, 0, likelihood.cols, likelihood.rows};
  if (scratch.binary.size() != likelihood.size()) {
    scratch.binary.create(likelihood.size(), CV_8UC1);
    scratch.labels.create(likelihood.size(), CV_32SC1);
  }
  const cv::Rect corner(0, 0, region.width, region.height);
  cv::Mat binary = scratch.binary(corner), labels = scratch.labels(corner);
  cv::Mat &stats = scratch.stats, &centroids = scratch.centroids;
  cv::threshold(likelihood(region), binary, 127, 255, cv::THRESH_BINARY);
  const int count = cv::connectedComponentsWithStats(binary, labels, stats, centroids, 8, CV_32S);
  blobs.clear();
  for (int i = 1; i < count; ++i) {
    MarkerBlob blob;
    blob.area = stats.at<int>(i, cv::CC_STAT_AREA);
    if (blob.area < min_area) continue;
    blob.centre = {centroids.at<double>(i, 0) + region.x, centroids.at<double>(i, 1) + region.y};
    blob.box = {stats.at<int>(i, cv::CC_STAT_LEFT) + region.x,
                stats.at<int>(i, cv::CC_STAT_TOP) + region.y, stats.at<int>(i, cv::CC_STAT_WIDTH),
                stats.at<int>(i, cv::CC_STAT_HEIGHT)};
    const int caps = cap_area > 0 ? static_cast<int>(std::lround(blob.area / cap_area)) : 1;
    if (caps >= 2) {
      PartBlob(labels, i, region, blob, caps, blobs);
    } else {
      blobs.push_back(blob);
    }
  }
  std::sort(blobs.begin(), blobs.end(), [](const MarkerBlob& a, const MarkerBlob& b) {
    return std::tie(b.area, a.box.y, a.box.x) < std::tie(a.area, b.box.y, b.box.x);
  });
}

double InscribedRadius(const cv::Mat& likelihood, const cv::Rect& box) {
  cv::Mat binary, distance;
  cv::threshold(likelihood(box), binary, 127, 255, cv::THRESH_BINARY);
  cv::copyMakeBorder(binary, binary, 1, 1, 1, 1, cv::BORDER_CONSTANT, 0);
  cv::distanceTransform(binary, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  double largest = 0;
  cv::minMaxLoc(distance, nullptr, &largest);
  // To the middle of the nearest pixel outside, which lies a little beyond the edge.
  return std::max(0.0, largest - 0.1);
}

std::vector<MarkerPair> PairMarkers(const StereoCameras& cameras,
                                    const std::vector<MarkerBlob>& left,
                                    const std::vector<MarkerBlob>& right, double max_epipolar_px) {
  std::vector<MarkerPair> pairs;
  for (int i = 0; i < static_cast<int>(left.size()); ++i) {
    for (int j = 0; j < static_cast<int>(right.size()); ++j) {
      const double ratio = left[i].area / right[j].area;
      if (ratio > 2 || ratio < 0.5) continue;
      const double off = EpipolarDistance(cameras, left[i].centre, right[j].centre);
      if (off > max_epipolar_px) continue;
      const auto point = Triangulate(cameras, left[i].centre, right[j].centre);
      if (!point) continue;
      const double depth = (cameras.left.X_WC.inverse() * point->p_WQ).z();
      if (depth < 0.15 || depth > 3) continue;
      const double area = 0.5 * (left[i].area + right[j].area);
      pairs.push_back({i, j, *point, std::sqrt(area / std::numbers::pi) * depth / cameras.left.fx});
    }
  }
  return pairs;
}

std::vector<PerFinger<MarkerPair>> ChooseCaps(const std::vector<MarkerPair>& pairs,
                                              double cap_radius, int count) {
  // With clutter only the pairs of the likeliest size are tried: at most 4368 sets of 16.
  std::vector<const MarkerPair*> candidates;
  for (const MarkerPair& pair : pairs) {
    if (pair.radius > 0.003 && pair.radius < 0.025) candidates.push_back(&pair);
  }
  const double expected = cap_radius > 0 ? cap_radius : 0.009;
  std::stable_sort(candidates.begin(), candidates.end(), [&](auto* a, auto* b) {
    return std::abs(std::log(a->radius / expected)) < std::abs(std::log(b->radius / expected));
  });
  if (candidates.size() > 16) candidates.resize(16);
  const int n = static_cast<int>(candidates.size());
  struct Set {
    double cost;
    PerFinger<int> members;
  };
  std::vector<Set> sets;
  for (int a = 0; a < n; ++a)
    for (int b = a + 1; b < n; ++b)
      for (int c = b + 1; c < n; ++c)
        for (int d = c + 1; d < n; ++d)
          for (int e = d + 1; e < n; ++e) {
            const auto cost = HandCost(
                {candidates[a], candidates[b], candidates[c], candidates[d], candidates[e]},
                cap_radius);
            if (cost) sets.push_back({*cost, {a, b, c, d, e}});
          }
  std::stable_sort(sets.begin(), sets.end(),
                   [](const Set& x, const Set& y) { return x.cost < y.cost; });
  std::vector<PerFinger<MarkerPair>> chosen;
  for (const Set& set : sets) {
    if (static_cast<int>(chosen.size()) == count) break;
    auto& pair_of = chosen.emplace_back();
    for (int i = 0; i < kNumFingers; ++i) pair_of[i] = *candidates[set.members[i]];
  }
  return chosen;
}

PerFinger<int> LabelFingers(const PerFinger<Eigen::Vector2d>& caps, const Eigen::Vector2d& palm,
                            Handedness hand) {
  PerFinger<int> order = {0, 1, 2, 3, 4};
  PerFinger<double> angle;
  for (int i = 0; i < kNumFingers; ++i) angle[i] = PolarAngle(caps[i], palm);
  std::sort(order.begin(), order.end(), [&](int a, int b) { return angle[a] < angle[b]; });
  // The wrist is in the widest gap.
  int first = 0;
  double widest = -1;
  for (int i = 0; i < kNumFingers; ++i) {
    const int before = order[(i + kNumFingers - 1) % kNumFingers];
    double gap = angle[order[i]] - angle[before];
    if (gap <= 0) gap += kTurn;
    if (gap > widest) {
      widest = gap;
      first = i;
    }
  }
  std::rotate(order.begin(), order.begin() + first, order.end());
  // `order` has growing atan2(v, u): clockwise as seen, since v points down.
  bool reverse = hand == Handedness::kRight;
  if (hand == Handedness::kEither) {
    reverse = (caps[order[0]] - caps[order[1]]).norm() < (caps[order[4]] - caps[order[3]]).norm();
  }
  if (reverse) std::reverse(order.begin(), order.end());
  return order;
}

int FingerTurn(const PerFinger<Eigen::Vector2d>& caps, const Eigen::Vector2d& palm) {
  double turn = 0;
  for (int i = 1; i < kNumFingers; ++i) {
    turn += std::remainder(PolarAngle(caps[i], palm) - PolarAngle(caps[i - 1], palm), kTurn);
  }
  return turn > 0 ? 1 : -1;
}

bool InFingerOrder(const PerFinger<Eigen::Vector2d>& caps, const PerFinger<bool>& seen,
                   const Eigen::Vector2d& palm, int turn) {
  // Neighbours must follow each other by less than half a turn, with 10 degrees of slack: two
  // fingers one above the other are no violation.
  constexpr double kSlack = 10 * std::numbers::pi / 180;
  int previous = -1;
  for (int i = 0; i < kNumFingers; ++i) {
    if (!seen[i]) continue;
    if (previous >= 0) {
      const double step =
          turn *
          std::remainder(PolarAngle(caps[i], palm) - PolarAngle(caps[previous], palm), kTurn);
      if (step < -kSlack) return false;
    }
    previous = i;
  }
  return true;
}

PerFinger<int> OrderAboutPalm(const PerFinger<Eigen::Vector2d>& caps, const Eigen::Vector2d& palm,
                              int turn) {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (int f = kIndex; f < kNumFingers; ++f) middle += caps[f] / 4;
  const auto angle = [&](int f) {
    return turn * std::remainder(PolarAngle(caps[f], palm) - PolarAngle(middle, palm), kTurn);
  };
  PerFinger<int> order = {0, 1, 2, 3, 4};
  PerFinger<double> angles;
  for (int f = kIndex; f < kNumFingers; ++f) angles[f] = angle(f);
  std::sort(order.begin() + kIndex, order.end(), [&](int a, int b) {
    return angles[a] < angles[b] || (angles[a] == angles[b] && a < b);
  });
  return order;
}

Eigen::Vector2d PalmFromCaps(const PerFinger<Eigen::Vector2d>& caps) {
  // |p|^2 = 2 c.p + d, linear in c and d.
  Eigen::Matrix<double, kNumFingers, 3> A;
  Eigen::Matrix<double, kNumFingers, 1> b;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const auto& cap : caps) mean += cap / kNumFingers;
  double spread = 0;
  for (int i = 0; i < kNumFingers; ++i) {
    const Eigen::Vector2d p = caps[i] - mean;
    A.row(i) << 2 * p.x(), 2 * p.y(), 1;
    b[i] = p.squaredNorm();
    spread = std::max(spread, p.norm());
  }
  Eigen::Vector2d centre = A.colPivHouseholderQr().solve(b).head<2>();
  if (!centre.allFinite()) centre.setZero();
  if (centre.norm() > 2 * spread) centre *= 2 * spread / centre.norm();
  return mean + centre;
}

}  // namespace springgrasp
