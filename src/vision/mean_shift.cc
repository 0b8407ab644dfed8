#include "vision/mean_shift.h"

#include <algorithm>
#include <cmath>

namespace springgrasp {

MeanShiftResult MeanShift(const cv::Mat& likelihood, const PerFinger<Eigen::Vector2d>& start,
                          const PerFinger<bool>& active, const PerFinger<double>& radius_px,
                          int max_iterations, double tolerance_px) {
  MeanShiftResult result;
  result.centre = start;
  for (result.iterations = 0; result.iterations < max_iterations;) {
    ++result.iterations;
    double largest_move = 0;
    PerFinger<Eigen::Vector2d> next = result.centre;
    for (int f = 0; f < kNumFingers; ++f) {
      result.mass[f] = 0;
      if (!active[f]) continue;
      const Eigen::Vector2d& c = result.centre[f];
      const double r = radius_px[f];
      // Only these can compete for pixels of this window.
      PerFinger<int> rivals;
      int num_rivals = 0;
      for (int g = 0; g < kNumFingers; ++g) {
        if (g == f || !active[g]) continue;
        if ((result.centre[g] - c).norm() < r + radius_px[g]) rivals[num_rivals++] = g;
      }
      const int u0 = std::max(0, static_cast<int>(std::ceil(c.x() - r)));
      const int u1 = std::min(likelihood.cols - 1, static_cast<int>(std::floor(c.x() + r)));
      const int v0 = std::max(0, static_cast<int>(std::ceil(c.y() - r)));
      const int v1 = std::min(likelihood.rows - 1, static_cast<int>(std::floor(c.y() + r)));
      double sum = 0, sum_u = 0, sum_v = 0;
      for (int v = v0; v <= v1; ++v) {
        const std::uint8_t* row = likelihood.ptr(v);
        for (int u = u0; u <= u1; ++u) {
          if (row[u] == 0) continue;
          const double du = u - c.x(), dv = v - c.y();
          const double own = (du * du + dv * dv) / (r * r);
          if (own > 1) continue;
          bool mine = true;
          for (int k = 0; k < num_rivals && mine; ++k) {
            const int g = rivals[k];
            const double gu = u - result.centre[g].x(), gv = v - result.centre[g].y();
            mine = own <= (gu * gu + gv * gv) / (radius_px[g] * radius_px[g]);
          }
          if (!mine) continue;
          sum += row[u];
          sum_u += row[u] * du;
          sum_v += row[u] * dv;
        }
      }
      result.mass[f] = sum / 255;
      if (sum <= 0) continue;
      const Eigen::Vector2d move(sum_u / sum, sum_v / sum);
      next[f] += move;
      largest_move = std::max(largest_move, move.norm());
    }
    result.centre = next;
    if (largest_move < tolerance_px) break;
  }
  return result;
}

}  // namespace springgrasp
