#include "experiment/force_window.h"

#include <gtest/gtest.h>

namespace springgrasp {
namespace {

TEST(ForceWindowTest, MeansOverItsStepsOnly) {
  ForceWindow window;
  window.Add({9, 9, 9, 9, 9}, {9, 9, 9, 9, 9});
  window.Clear();
  window.Add({1, 0, 0, 0, 0}, {2, 0, 0, 0, 0});
  window.Add({3, 0, 0, 0, 0}, {6, 0, 0, 0, 0});
  EXPECT_DOUBLE_EQ(window.MeanTarget()[kThumb], 2);
  EXPECT_DOUBLE_EQ(window.MeanSensed()[kThumb], 4);
  EXPECT_DOUBLE_EQ(window.MeanSensed()[kIndex], 0);
}

TEST(ForceWindowTest, WithoutStepsIsZero) {
  EXPECT_DOUBLE_EQ(ForceWindow().MeanTarget()[kThumb], 0);
}

}  // namespace
}  // namespace springgrasp
