#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "vision/hand_fit_problem.h"

// What the masks of one frame ask of a fit.
namespace springgrasp {
namespace {

void MarkCuts(const ObjectDepth* object, MaskField& field) {
  field.cut.assign(field.samples.size(), false);
  if (object == nullptr) return;
  const double step = 1.5 * field.mask->step;
  for (std::size_t k = 0; k < field.samples.size(); ++k) {
    for (const Eigen::Vector2d& side : {Eigen::Vector2d(step, 0), Eigen::Vector2d(-step, 0),
                                        Eigen::Vector2d(0, step), Eigen::Vector2d(0, -step)}) {
      if (object->Covers(field.samples[k] + side)) field.cut[k] = true;
    }
  }
}

}  // namespace

MaskField MakeField(const HandMask& mask, int wanted, const Eigen::Vector2d& middle,
                    double reach_px) {
  MaskField field;
  field.mask = &mask;
  cv::Mat inverse;
  cv::bitwise_not(mask.mask, inverse);
  cv::distanceTransform(inverse, field.outside, cv::DIST_L2, 3);
  field.outside *= mask.step;
  cv::distanceTransform(mask.mask, field.inside, cv::DIST_L2, 3);
  field.inside *= mask.step;
  int total = 0;
  const auto visit = [&](auto&& keep) {
    for (int i = 0; i < mask.mask.rows; ++i) {
      const std::uint8_t* row = mask.mask.ptr(i);
      for (int j = 0; j < mask.mask.cols; ++j) {
        if (row[j] == 0) continue;
        // On the outline, but not where the region cuts the mask.
        if (i == 0 || j == 0 || i + 1 == mask.mask.rows || j + 1 == mask.mask.cols) continue;
        if (row[j - 1] != 0 && row[j + 1] != 0 && mask.mask.at<std::uint8_t>(i - 1, j) != 0 &&
            mask.mask.at<std::uint8_t>(i + 1, j) != 0) {
          continue;
        }
        const Eigen::Vector2d pixel = mask.ToPixel(Eigen::Vector2d(j, i));
        if ((pixel - middle).norm() < reach_px) keep(pixel);
      }
    }
  };
  visit([&](const Eigen::Vector2d&) { ++total; });
  const int stride = std::max(1, total / std::max(1, wanted));
  int index = 0;
  visit([&](const Eigen::Vector2d& pixel) {
    if (index++ % stride == 0 && static_cast<int>(field.samples.size()) < wanted) {
      field.samples.push_back(pixel);
    }
  });
  return field;
}

HandFields MakeFields(const StereoCameras& cameras, const HandObservation& observation,
                      const HandPoseOptions& options) {
  HandFields fields;
  Eigen::Vector3d middle_W = Eigen::Vector3d::Zero();
  int tips = 0;
  for (const auto& tip : observation.tip_W) {
    if (tip) middle_W += *tip, ++tips;
  }
  if (tips == 0) return fields;
  middle_W /= tips;
  for (int v = 0; v < 2; ++v) {
    if (observation.masks[v] == nullptr || observation.masks[v]->mask.empty()) continue;
    const auto middle = Project(cameras.view(v), middle_W);
    if (!middle) continue;
    const double depth =
        cameras.view(v).X_WC.linear().col(2).dot(middle_W - cameras.view(v).X_WC.translation());
    fields.masks[v] = MakeField(*observation.masks[v], options.mask_samples, *middle,
                                cameras.view(v).fx * 0.2 / std::max(0.1, depth));
    MarkCuts(observation.object != nullptr ? &observation.object->depth[v] : nullptr,
             fields.masks[v]);
  }
  return fields;
}

}  // namespace springgrasp
