#include "grasp/learn_segment.h"

#include <gtest/gtest.h>

#include <cmath>

#include "motion/minimum_jerk.h"

namespace springgrasp {
namespace {

constexpr double kDt = 0.01;

// A reach of 1 s with 0.4 m/s at its peak from 0.3 s on, closing from 7 to 4 cm in its second half.
struct Reach {
  std::vector<double> speed, span;
};
Reach MakeReach() {
  Reach reach;
  for (int i = 0; i < 180; ++i) {
    const double s = (kDt * i - 0.3) / 1.0;
    reach.speed.push_back(s > 0 && s < 1 ? 0.4 / 1.875 * MinimumJerkSpeed(s) : 0);
    const double open = MinimumJerkPosition(std::clamp(2 * s, 0.0, 1.0));
    const double closed = MinimumJerkPosition(std::clamp(2 * s - 1, 0.0, 1.0));
    reach.span.push_back(0.04 + 0.03 * (open - closed));
  }
  return reach;
}

void ExpectTheReach(const ReachSegment& found) {
  EXPECT_NEAR(kDt * found.peak, 0.8, 0.03);
  EXPECT_NEAR(kDt * found.begin, 0.4, 0.06);
  EXPECT_NEAR(kDt * found.contact, 1.2, 0.08);
}

TEST(FindReachTest, FindsTheBellOfAReach) {
  const Reach reach = MakeReach();
  ExpectTheReach(FindReach(reach.speed, reach.span, kDt, 0, 0));
}

TEST(FindReachTest, AJumpOfTheTrackIsNoMovement) {
  for (const int at : {2, 20, 150}) {
    Reach reach = MakeReach();
    for (int i = at; i < at + 3; ++i) reach.speed[i] = 0.9;
    ExpectTheReach(FindReach(reach.speed, reach.span, kDt, 0, 0));
  }
}

}  // namespace
}  // namespace springgrasp
