#include "vision/recorded_stereo.h"

#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "base/error.h"

namespace springgrasp {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class RecordedStereoTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::path(testing::TempDir()) /
        ("recorded_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string Path(const std::string& name) const { return (folder_ / name).string(); }

  // Frame i is of grey value 5 i, with a stripe so that it does not compress to nothing.
  static cv::Mat Picture(int i, cv::Size size) {
    cv::Mat picture(size, CV_8UC3, cv::Scalar::all(5 * i));
    picture(cv::Rect(10 + i, 20, 40, 60)).setTo(cv::Scalar(20, 160, 20));
    return picture;
  }

  std::string Video(const std::string& name, int frames, cv::Size size = {320, 240},
                    double fps = 30) const {
    cv::VideoWriter writer(Path(name), cv::CAP_FFMPEG, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'),
                           fps, size);
    for (int i = 0; i < frames; ++i) writer.write(Picture(i, size));
    return Path(name);
  }

  std::string Pictures(const std::string& name, int frames, int first = 0) const {
    for (int i = 0; i < frames; ++i) {
      cv::imwrite(Path(cv::format((name + "_%03d.png").c_str(), first + i)),
                  Picture(i, {320, 240}));
    }
    return Path(name + "_%03d.png");
  }

  static int Count(RecordedStereo& recorded) {
    int count = 0;
    while (const auto frame = recorded.Next()) {
      EXPECT_NEAR(frame->t, count / recorded.fps(), 1e-9);
      ++count;
    }
    return count;
  }

  static std::string Refusal(const std::string& left, const std::string& right, double fps = 0) {
    try {
      RecordedStereo recorded(left, right, fps);
      return "";
    } catch (const Error& error) {
      return error.what();
    }
  }

  static void Cut(const std::string& path, double share) {
    fs::resize_file(path, static_cast<std::uintmax_t>(share * double(fs::file_size(path))));
  }

  fs::path folder_;
};

TEST_F(RecordedStereoTest, AWholeVideoIsReadToItsEnd) {
  RecordedStereo recorded(Video("l.avi", 20), Video("r.avi", 20));
  EXPECT_EQ(recorded.size(), cv::Size(320, 240));
  EXPECT_NEAR(recorded.fps(), 30, 0.01);
  EXPECT_EQ(Count(recorded), 20);
  EXPECT_FALSE(recorded.broke_off()) << *recorded.broke_off();
  EXPECT_FALSE(recorded.Next());
}

TEST_F(RecordedStereoTest, PicturesNeedARateAndMayBeginAtOne) {
  const std::string left = Pictures("l", 6, 1), right = Pictures("r", 6, 1);
  EXPECT_THAT(Refusal(left, right), HasSubstr("--fps"));
  RecordedStereo recorded(left, right, 25);
  const auto frame = recorded.Next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->left.at<cv::Vec3b>(200, 200)[0], 0);
  int rest = 0;
  while (recorded.Next()) ++rest;
  EXPECT_EQ(rest, 5);
}

TEST_F(RecordedStereoTest, WhatDoesNotBelongTogetherIsRefused) {
  const std::string left = Video("l.avi", 8);
  EXPECT_THAT(Refusal(left, Video("short.avi", 6)), HasSubstr("6 frames, expected 8"));
  EXPECT_THAT(Refusal(left, Video("large.avi", 8, {640, 480})), HasSubstr("640x480"));
  EXPECT_THAT(Refusal(left, Video("slow.avi", 8, {320, 240}, 15)), HasSubstr("per second"));
  EXPECT_EQ(Refusal(left, Path("slow.avi"), 30), "") << "the rate was given";
  EXPECT_THAT(Refusal(left, Path("absent.avi")), HasSubstr("no such video"));
  EXPECT_THAT(Refusal(Path("none_%03d.png"), Path("none_%03d.png"), 30), HasSubstr("no pictures"));
  EXPECT_THAT(Refusal(Path("%s%n.png"), Path("%s%n.png"), 30), HasSubstr("no pictures"));
  std::ofstream(Path("text.avi")) << "no video at all\n";
  EXPECT_THAT(Refusal(left, Path("text.avi")), HasSubstr("not a video"));
  const std::string tiny = Video("tiny.avi", 8, {160, 120});
  EXPECT_THAT(Refusal(tiny, tiny), HasSubstr("expected 320x240 to 1920x1080"));
  for (const double fps : {-1.0, 0.5, 1e9, std::nan("")}) {
    EXPECT_THAT(Refusal(left, left, fps), HasSubstr("--fps")) << fps;
  }
}

TEST_F(RecordedStereoTest, AFileCutOffEndsWithWhereAndWhy) {
  const std::string left = Video("l.avi", 30), right = Video("r.avi", 30);
  Cut(right, 0.5);
  RecordedStereo recorded(left, right, 30);
  const int count = Count(recorded);
  EXPECT_GT(count, 5);
  EXPECT_LT(count, 25);
  ASSERT_TRUE(recorded.broke_off());
  EXPECT_THAT(*recorded.broke_off(), HasSubstr("r.avi: breaks off"));
  EXPECT_THAT(*recorded.broke_off(), HasSubstr("after " + std::to_string(count) + " frames"));
}

TEST_F(RecordedStereoTest, APictureThatCannotBeDecodedEndsIt) {
  const std::string left = Pictures("l", 8), right = Pictures("r", 8);
  std::ofstream(Path("r_005.png")) << "no picture";
  RecordedStereo recorded(left, right, 30);
  EXPECT_EQ(Count(recorded), 5);
  ASSERT_TRUE(recorded.broke_off());
  EXPECT_THAT(*recorded.broke_off(), HasSubstr("r_%03d.png: breaks off"));
}

TEST_F(RecordedStereoTest, APictureOfAnotherSizeEndsIt) {
  const std::string left = Pictures("l", 8), right = Pictures("r", 8);
  cv::imwrite(Path("l_004.png"), Picture(0, {330, 240}));
  RecordedStereo recorded(left, right, 30);
  EXPECT_EQ(Count(recorded), 4);
  ASSERT_TRUE(recorded.broke_off());
  EXPECT_THAT(*recorded.broke_off(), HasSubstr("330x240"));
}

}  // namespace
}  // namespace springgrasp
