#include "vision/marker_colour.h"

#include <gtest/gtest.h>

#include <cmath>

#include "vision/synthetic_caps.h"

namespace springgrasp {
namespace {

// A hand with caps of another colour (BGR, as red, green, blue below).
std::vector<DrawnCapsule> HandWithCaps(const Eigen::Vector3d& rgb) {
  auto capsules = MakeDrawnHand({0.05, 0.05, 0.6}, 0).capsules;
  for (DrawnCapsule& capsule : capsules) {
    if (capsule.bgr == Eigen::Vector3d(20, 160, 20)) capsule.bgr = rgb.reverse();
  }
  return capsules;
}

struct Case {
  const char* name;
  Eigen::Vector3d rgb;  // 0..255
};

const std::vector<Case> kCases = {{"green", {20, 160, 20}},   {"blue", {30, 60, 220}},
                                  {"pink", {240, 60, 160}},   {"orange", {250, 120, 0}},
                                  {"yellow", {240, 220, 20}}, {"cyan", {20, 200, 220}},
                                  {"violet", {130, 40, 210}}, {"red", {220, 20, 20}}};

double HueOff(double found, const Eigen::Vector3d& rgb) {
  return std::abs(std::remainder(found - HueDeg(rgb), 360.0));
}

TEST(FindMarkerHueTest, CapsOfAnyHueAreFoundBesideSkin) {
  for (const Case& c : kCases) {
    const auto hue = FindMarkerHue(DrawCapsules(TestEyes().left, HandWithCaps(c.rgb)), {});
    ASSERT_TRUE(hue) << c.name;
    EXPECT_LT(HueOff(*hue, c.rgb), 25) << c.name;
  }
}

// Balls of other bright colours lie about, one of each, larger or smaller than caps.
TEST(FindMarkerHueTest, ClutterIsNotTakenForCaps) {
  for (const Case& c : kCases) {
    auto capsules = HandWithCaps(c.rgb);
    int k = 0;
    for (const Case& other : kCases) {
      if (other.name == c.name) continue;
      const Eigen::Vector3d at(-0.25 + 0.06 * k, 0.2 - 0.02 * (k % 3), 0.8);
      capsules.push_back(
          {at, at + Eigen::Vector3d(0, 0.01 * k, 0), 0.006 + 0.004 * k, other.rgb.reverse()});
      ++k;
    }
    const auto hue = FindMarkerHue(DrawCapsules(TestEyes().left, capsules), {});
    ASSERT_TRUE(hue) << c.name;
    EXPECT_LT(HueOff(*hue, c.rgb), 25) << c.name;
  }
}

TEST(FindMarkerHueTest, WithoutFiveCapsNothingIsFound) {
  EXPECT_FALSE(FindMarkerHue(DrawCapsules(TestEyes().left, {}), {}));
  auto capsules = MakeDrawnHand({0.05, 0.05, 0.6}, 0).capsules;
  for (DrawnCapsule& capsule : capsules) capsule.bgr = kSkin;
  EXPECT_FALSE(FindMarkerHue(DrawCapsules(TestEyes().left, capsules), {}));
}

}  // namespace
}  // namespace springgrasp
