// A recording of another renderer: looks that the tracker was not made for.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <opencv2/videoio.hpp>
#include <sstream>

#include "vision/track_demonstration.h"

namespace springgrasp {
namespace {

const std::string kFolder = std::string(SPRINGGRASP_SHARED_DIR) + "/stereo_sample/";

std::vector<std::vector<Eigen::Vector3d>> ReadTruth() {
  std::ifstream file(kFolder + "truth.csv");
  std::string line;
  std::getline(file, line);
  std::vector<std::vector<Eigen::Vector3d>> truth;
  while (std::getline(file, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream cells(line);
    double t;
    cells >> t;
    auto& row = truth.emplace_back(kNumFingers);
    for (auto& p : row) cells >> p.x() >> p.y() >> p.z();
  }
  return truth;
}

struct Result {
  std::string csv;
  double median = 0, p95 = 0, coverage = 0;
  int swaps = 0;
};

Result Track(const CapShape& cap) {
  const StereoCameras cameras =
      ReadStereoCalibration(kFolder + "intrinsics.yml", kFolder + "extrinsics.yml", 640, 480);
  cv::VideoCapture left(kFolder + "left.mp4"), right(kFolder + "right.mp4");
  int count = 0;
  const FrameSource source = [&]() -> std::optional<StereoFrame> {
    StereoFrame frame;
    frame.t = count++ / 30.0;
    if (!left.read(frame.left) || !right.read(frame.right)) return std::nullopt;
    return frame;
  };
  TrackDemonstrationOptions options;
  options.tracker.cap = cap;
  options.frame = "camera_left";
  RandomEngine engine = MakeStream(1, 0, "observation");
  const Demonstration demonstration = TrackStereo(source, cameras, nullptr, options, engine);
  const auto truth = ReadTruth();
  EXPECT_EQ(demonstration.samples.size(), truth.size());
  std::vector<double> errors;
  Result result;
  result.csv = FormatDemonstration(demonstration);
  for (std::size_t i = 0; i < demonstration.samples.size(); ++i) {
    for (int f = 0; f < kNumFingers; ++f) {
      const auto& p = demonstration.samples[i].p_WF[f];
      if (!p) continue;
      errors.push_back((*p - truth[i][f]).norm());
      for (int g = 0; g < kNumFingers; ++g) {
        if (g != f && (*p - truth[i][g]).norm() < 0.5 * errors.back()) ++result.swaps;
      }
    }
  }
  std::sort(errors.begin(), errors.end());
  result.median = errors[errors.size() / 2];
  result.p95 = errors[errors.size() * 95 / 100];
  result.coverage = static_cast<double>(errors.size()) / static_cast<double>(5 * truth.size());
  return result;
}

class StereoSampleTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kFolder + "truth.csv")) {
      GTEST_SKIP() << "the stereo recording in " << kFolder << " is not there";
    }
  }
};

TEST_F(StereoSampleTest, IsTrackedWithoutKnowingTheCaps) {
  const Result result = Track({});
  EXPECT_LT(result.median, 0.005);
  EXPECT_LT(result.p95, 0.015);
  EXPECT_EQ(result.swaps, 0);
  EXPECT_GT(result.coverage, 0.97);
}

TEST_F(StereoSampleTest, IsTrackedBetterWithTheirSizeGiven) {
  // 18 mm wide thimbles, 25 mm long.
  const Result result = Track({0.009, 0.025, 0.010});
  EXPECT_LT(result.median, 0.003);
  EXPECT_LT(result.p95, 0.012);
  EXPECT_EQ(result.swaps, 0);
  EXPECT_GT(result.coverage, 0.97);
}

TEST_F(StereoSampleTest, SameFramesAndSeedGiveTheSameBytes) {
  const CapShape cap{0.009, 0.025, 0.010};
  EXPECT_EQ(Track(cap).csv, Track(cap).csv);
}

}  // namespace
}  // namespace springgrasp
