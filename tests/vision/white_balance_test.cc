#include "vision/white_balance.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

namespace springgrasp {
namespace {

// A picture of many colours; `gain` per channel, a part of it moved.
cv::Mat Picture(const cv::Scalar& gain, bool moved) {
  cv::Mat picture(240, 320, CV_8UC3);
  for (int v = 0; v < picture.rows; ++v) {
    for (int u = 0; u < picture.cols; ++u) {
      picture.at<cv::Vec3b>(v, u) = {static_cast<std::uint8_t>(60 + u / 4),
                                     static_cast<std::uint8_t>(70 + v / 3),
                                     static_cast<std::uint8_t>(90 + (u + v) / 8)};
    }
  }
  cv::rectangle(picture, moved ? cv::Rect(20, 20, 90, 90) : cv::Rect(180, 100, 90, 90),
                cv::Scalar(90, 120, 180), cv::FILLED);
  cv::Mat out;
  cv::multiply(picture, gain, out);
  return out;
}

TEST(WhiteBalanceTest, WithoutDriftLevelsStayThoughPartOfThePictureMoves) {
  WhiteBalance balance;
  balance.SetReference(Picture({1, 1, 1, 0}, false));
  EXPECT_EQ(balance.LevelsOf(Picture({1, 1, 1, 0}, true)), SameLevels());
}

TEST(WhiteBalanceTest, ADriftOfColoursIsTurnedBack) {
  WhiteBalance balance;
  balance.SetReference(Picture({1, 1, 1, 0}, false));
  const LevelTable levels = balance.LevelsOf(Picture({0.9, 1, 1.15, 0}, true));
  // What was grey is grey again, whatever its brightness.
  const double b = levels[0][90], g = levels[1][100], r = levels[2][115];
  EXPECT_NEAR(b / g, 1, 0.03);
  EXPECT_NEAR(r / g, 1, 0.03);
}

TEST(WhiteBalanceTest, BrightnessAloneIsLeftAsItIs) {
  WhiteBalance balance;
  balance.SetReference(Picture({1, 1, 1, 0}, false));
  EXPECT_EQ(balance.LevelsOf(Picture({0.7, 0.7, 0.7, 0}, true)), SameLevels());
}

TEST(WhiteBalanceTest, LevelsMayBeThoseOfTheOtherEye) {
  const cv::Mat left = Picture({1, 1, 1, 0}, false), right = Picture({0.9, 1, 1.15, 0}, false);
  WhiteBalance balance;
  balance.SetReference(right, &left);
  const LevelTable levels = balance.LevelsOf(right);
  EXPECT_NEAR(levels[0][90], levels[1][100], 3);
  EXPECT_NEAR(levels[2][115], levels[1][100], 3);
}

}  // namespace
}  // namespace springgrasp
