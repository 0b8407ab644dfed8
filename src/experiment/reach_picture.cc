#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>

#include "experiment/reach_report.h"

namespace springgrasp {
namespace {

constexpr int kCell = 22;                        // px
constexpr int kLeft = 46, kTop = 30, kGap = 34;  // px, about a panel

// White (none) to deep green (all).
cv::Scalar ColourOf(double part) {
  if (part <= 0) return {238, 238, 238};
  return {190 - 150 * part, 225 - 95 * part, 200 - 170 * part};
}

void Write(cv::Mat& picture, const std::string& text, cv::Point at) {
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.42, {30, 30, 30}, 1, cv::LINE_AA);
}

struct Panel {
  const ReachReport& report;
  cv::Point corner;
  int rows;
  cv::Point2d At(double x, double y) const {
    const ReachMapOptions& o = report.options;
    return {corner.x + kCell * ((x - o.x_from) / o.cell + 0.5),
            corner.y + kCell * (rows - 0.5 - (y - o.y_from) / o.cell)};
  }
};

void DrawPanel(const ReachReport& report, const Scene& scene, const ReachMap& map,
               const std::vector<int>& counts, const std::string& title, cv::Point corner,
               cv::Mat& picture) {
  const ReachMapOptions& o = report.options;
  const Panel panel{report, corner, map.rows};
  Write(picture, title, {corner.x, corner.y - 8});
  for (int row = 0; row < map.rows; ++row) {
    for (int column = 0; column < map.columns; ++column) {
      const int count = counts[static_cast<std::size_t>(row * map.columns + column)];
      const cv::Rect cell(corner.x + kCell * column, corner.y + kCell * (map.rows - 1 - row), kCell,
                          kCell);
      cv::rectangle(picture, cell, ColourOf(static_cast<double>(count) / o.directions), cv::FILLED);
      cv::rectangle(picture, cell, {255, 255, 255}, 1);
    }
  }
  const cv::Rect frame(corner.x, corner.y, kCell * map.columns, kCell * map.rows);
  cv::Mat inside = picture(frame);
  // The table's edge, then the objects.
  const auto local = [&](double x, double y) {
    const cv::Point2d p = panel.At(x, y);
    return cv::Point(static_cast<int>(p.x) - corner.x, static_cast<int>(p.y) - corner.y);
  };
  const Eigen::Vector2d half = 0.5 * scene.table.size.head<2>(), centre = scene.table.position;
  cv::rectangle(inside, local(centre.x() - half.x(), centre.y() - half.y()),
                local(centre.x() + half.x(), centre.y() + half.y()), {60, 60, 60}, 1, cv::LINE_AA);
  for (const ObjectReach& object : report.objects) {
    cv::circle(inside, local(object.p_WO.x(), object.p_WO.y()), 6, {40, 40, 210}, 2, cv::LINE_AA);
  }
  for (int column = 0; column < map.columns; column += 4) {
    Write(picture, fmt::format("{:.1f}", o.x_from + o.cell * column),
          {corner.x + kCell * column + 2, corner.y + kCell * map.rows + 15});
  }
  for (int row = 0; row < map.rows; row += 4) {
    Write(picture, fmt::format("{:.1f}", o.y_from + o.cell * row),
          {corner.x - 28, corner.y + kCell * (map.rows - row) - 6});
  }
}

}  // namespace

cv::Mat DrawReachReport(const ReachReport& report, const Scene& scene) {
  const ReachMap& first = report.maps.front();
  const int width = kLeft + kCell * first.columns, height = kTop + kCell * first.rows + kGap;
  const int panels = static_cast<int>(report.maps.size());
  cv::Mat picture(height * panels + 56, 2 * width + kGap, CV_8UC3, cv::Scalar(255, 255, 255));
  for (int i = 0; i < panels; ++i) {
    const ReachMap& map = report.maps[static_cast<std::size_t>(panels - 1 - i)];
    const std::string at = fmt::format("z {:.2f} m, ", map.z);
    const int top = kTop + i * height;
    DrawPanel(report, scene, map, map.side, at + "from the side", {kLeft, top}, picture);
    DrawPanel(report, scene, map, map.above, at + "from above", {kLeft + width, top}, picture);
  }
  const int y = height * panels + 22;
  Write(picture, "directions reached:", {kLeft, y});
  for (int i = 0; i <= 4; ++i) {
    const cv::Rect box(kLeft + 160 + 80 * i, y - 13, 18, 18);
    cv::rectangle(picture, box, ColourOf(i / 4.0), cv::FILLED);
    Write(picture, fmt::format("{} %", 25 * i), {box.x + 24, y});
  }
  Write(picture, "line: table, ring: object; x and y in m, robot at the origin, looking up",
        {kLeft, y + 20});
  return picture;
}

}  // namespace springgrasp
