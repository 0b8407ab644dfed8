#include "vision/hand_model.h"

#include <gtest/gtest.h>

namespace springgrasp {
namespace {

// Two balls of the palm and four of the forearm, from the wrist outwards.
HandModel ModelWithForearm() {
  HandModel model;
  model.balls.resize(6);
  for (int i = 2; i < 6; ++i) model.balls[i].forearm = true;
  for (int i = 0; i < 6; ++i) model.balls[i].p_B.x() = 0.04 - 0.02 * i;
  return model;
}

TEST(KeepBareForearmTest, TheSleeveBeginsAtTheFirstBallThatWasNotBare) {
  HandModel model = ModelWithForearm();
  KeepBareForearm({false, false, true, true, false, true}, model);
  ASSERT_EQ(model.balls.size(), 4u);
  EXPECT_TRUE(model.balls[3].cut);
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(model.balls[i].cut);
}

TEST(KeepBareForearmTest, ABareForearmStaysWhole) {
  HandModel model = ModelWithForearm();
  KeepBareForearm({false, false, true, true, true, true}, model);
  ASSERT_EQ(model.balls.size(), 6u);
  for (const HandBall& ball : model.balls) EXPECT_FALSE(ball.cut);
}

TEST(KeepBareForearmTest, ASleeveFromTheWristOnLeavesNoForearm) {
  HandModel model = ModelWithForearm();
  KeepBareForearm(std::vector<bool>(6, false), model);
  ASSERT_EQ(model.balls.size(), 2u);
  for (const HandBall& ball : model.balls) EXPECT_FALSE(ball.cut);
}

}  // namespace
}  // namespace springgrasp
