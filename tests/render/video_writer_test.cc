#include "render/video_writer.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <opencv2/videoio.hpp>

#include "base/error.h"

namespace springgrasp {
namespace {

namespace fs = std::filesystem;

class VideoWriterTest : public ::testing::Test {
 protected:
  fs::path folder_ = fs::path(::testing::TempDir()) / "springgrasp_video_test";
  void SetUp() override {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  int Files() const { return static_cast<int>(std::distance(fs::directory_iterator(folder_), {})); }
};

TEST_F(VideoWriterTest, WritesH264ThatReadsBack) {
  const std::string path = folder_ / "v.mp4";
  VideoWriter writer(path, 25);
  for (int i = 0; i < 10; ++i) {
    cv::Mat frame(120, 160, CV_8UC3, cv::Scalar(20 * i, 100, 50));
    DrawText(frame, "frame", 0);
    writer.Add(frame);
    EXPECT_FALSE(fs::exists(path));
  }
  writer.Finish();
  EXPECT_EQ(Files(), 1);
  cv::VideoCapture in(path);
  ASSERT_TRUE(in.isOpened());
  const int fourcc = static_cast<int>(in.get(cv::CAP_PROP_FOURCC));
  EXPECT_TRUE(fourcc == cv::VideoWriter::fourcc('h', '2', '6', '4') ||
              fourcc == cv::VideoWriter::fourcc('a', 'v', 'c', '1'));
  int frames = 0;
  cv::Mat frame;
  double last = -1;
  while (in.read(frame)) {
    const double blue = frame.at<cv::Vec3b>(100, 140)[0];
    EXPECT_GT(blue, last);
    last = blue;
    ++frames;
  }
  EXPECT_EQ(frames, 10);
}

TEST_F(VideoWriterTest, UnfinishedVideosLeaveNothingBehind) {
  {
    VideoWriter writer(folder_ / "v.mp4", 25);
    writer.Add(cv::Mat(120, 160, CV_8UC3, cv::Scalar(0, 0, 0)));
  }
  EXPECT_EQ(Files(), 0);
}

TEST_F(VideoWriterTest, BadRequestsAreErrors) {
  EXPECT_THROW(VideoWriter(folder_ / "v.avi", 25), Error);
  VideoWriter writer(folder_ / "v.mp4", 25);
  EXPECT_THROW(writer.Finish(), Error);
  EXPECT_THROW(writer.Add(cv::Mat(121, 160, CV_8UC3)), Error);
  VideoWriter nowhere(folder_ / "missing" / "v.mp4", 25);
  EXPECT_THROW(nowhere.Add(cv::Mat(120, 160, CV_8UC3)), Error);
}

}  // namespace
}  // namespace springgrasp
