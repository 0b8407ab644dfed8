#include "vision/marker_segmentation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "vision/marker_colour.h"
#include "vision/synthetic_caps.h"

namespace springgrasp {
namespace {

// Caps of a right hand whose palm is seen: thumb to pinkie counter-clockwise, turned by `turn`.
PerFinger<Eigen::Vector2d> RightHand(double turn, const Eigen::Vector2d& palm) {
  PerFinger<Eigen::Vector2d> caps;
  const double angle_deg[5] = {20, 70, 92, 112, 134};
  for (int f = 0; f < kNumFingers; ++f) {
    const double a = angle_deg[f] * M_PI / 180 + turn;
    caps[f] = palm + 80 * Eigen::Vector2d(std::cos(a), -std::sin(a));
  }
  return caps;
}

TEST(LabelFingersTest, ARightHandIsLabelledWhicheverWayItPointsAndInWhateverOrder) {
  const Eigen::Vector2d palm(300, 200);
  for (double turn = 0; turn < 6.2; turn += 0.7) {
    const auto caps = RightHand(turn, palm);
    PerFinger<int> shuffle = {3, 0, 4, 1, 2};
    PerFinger<Eigen::Vector2d> mixed;
    for (int i = 0; i < kNumFingers; ++i) mixed[i] = caps[shuffle[i]];
    const auto labels = LabelFingers(mixed, palm, Handedness::kRight);
    for (int f = 0; f < kNumFingers; ++f) EXPECT_EQ(shuffle[labels[f]], f) << "turn " << turn;
    // The thumb's gap tells the same without knowing the hand.
    EXPECT_EQ(LabelFingers(mixed, palm, Handedness::kEither), labels);
  }
}

TEST(LabelFingersTest, ALeftHandIsTheMirrorImage) {
  const Eigen::Vector2d palm(300, 200);
  auto caps = RightHand(0.4, palm);
  for (auto& cap : caps) cap.x() = 600 - cap.x();
  const auto labels = LabelFingers(caps, palm, Handedness::kLeft);
  for (int f = 0; f < kNumFingers; ++f) EXPECT_EQ(labels[f], f);
}

TEST(FingerOrderTest, ASwapOfNeighboursIsAViolation) {
  const Eigen::Vector2d palm(300, 200);
  auto caps = RightHand(1.0, palm);
  const int turn = FingerTurn(caps, palm);
  const PerFinger<bool> all = {true, true, true, true, true};
  EXPECT_TRUE(InFingerOrder(caps, all, palm, turn));
  std::swap(caps[kMiddle], caps[kRing]);
  EXPECT_FALSE(InFingerOrder(caps, all, palm, turn));
  // Not when one of them is not seen.
  EXPECT_TRUE(InFingerOrder(caps, {true, true, false, true, true}, palm, turn));
}

TEST(FingerOrderTest, ExchangedFingersAreSortedBackWhicheverWayTheHandPoints) {
  const Eigen::Vector2d palm(300, 200);
  for (double angle = 0; angle < 6.2; angle += 0.7) {
    const auto right = RightHand(angle, palm);
    PerFinger<Eigen::Vector2d> caps = right;
    caps[kIndex] = right[kMiddle];
    caps[kMiddle] = right[kRing];
    caps[kRing] = right[kIndex];
    const auto order = OrderAboutPalm(caps, palm, FingerTurn(right, palm));
    for (int f = 0; f < kNumFingers; ++f) EXPECT_EQ(caps[order[f]], right[f]) << f << " " << angle;
  }
}

TEST(PalmFromCapsTest, LiesInsideTheArc) {
  const Eigen::Vector2d palm(300, 200);
  EXPECT_LT((PalmFromCaps(RightHand(0.3, palm)) - palm).norm(), 1e-6);
}

TEST(ChooseCapsTest, GreenishClutterIsLeftAside) {
  const StereoCameras eyes = TestEyes();
  const DrawnHand hand = MakeDrawnHand({0.03, 0.03, 0.6}, 0);
  std::vector<DrawnCapsule> scene = hand.capsules;
  // A green book far off and a green pea nearby.
  scene.push_back({{-0.3, 0.1, 1.2}, {-0.25, 0.1, 1.2}, 0.05, {30, 140, 30}});
  scene.push_back({{-0.16, 0.0, 0.6}, {-0.16, 0.0, 0.6}, 0.004, {20, 160, 20}});
  std::vector<MarkerBlob> blobs[2];
  const MarkerColour colour = MakeMarkerColour({});
  for (int v = 0; v < 2; ++v) {
    const cv::Mat picture = DrawCapsules(eyes.view(v), scene);
    cv::Mat likelihood(picture.size(), CV_8UC1), bins(picture.size(), CV_8UC1);
    MapColours(picture, colour, {0, 0, picture.cols, picture.rows}, likelihood, bins);
    blobs[v] = SegmentMarkers(likelihood, 20);
    EXPECT_EQ(blobs[v].size(), 7U);
  }
  const auto sets = ChooseCaps(PairMarkers(eyes, blobs[0], blobs[1], 3), 0, 3);
  ASSERT_FALSE(sets.empty());
  for (const Eigen::Vector3d& tip : hand.tips) {
    double nearest = 1;
    for (const MarkerPair& pair : sets[0])
      nearest = std::min(nearest, (pair.point.p_WQ - tip).norm());
    EXPECT_LT(nearest, 0.012);
  }
}

TEST(SegmentMarkersTest, CapsThatTouchArePartedByTheAreaOfOne) {
  constexpr double kRadius = 9, kArea = M_PI * kRadius * kRadius;
  for (const double turn : {0.0, 0.7, 1.5}) {
    cv::Mat likelihood = cv::Mat::zeros(200, 200, CV_8UC1);
    std::vector<Eigen::Vector2d> caps;
    for (int k = 0; k < 4; ++k) {
      caps.push_back(Eigen::Vector2d(100, 100) +
                     (17.0 * k - 25.5) * Eigen::Vector2d(std::cos(turn), std::sin(turn)));
    }
    caps.emplace_back(30, 170);  // on its own
    for (const Eigen::Vector2d& cap : caps) {
      cv::circle(likelihood, cv::Point(int(std::lround(cap.x())), int(std::lround(cap.y()))),
                 int(kRadius), 255, cv::FILLED);
    }
    MarkerScratch scratch;
    std::vector<MarkerBlob> whole, parted;
    SegmentMarkers(likelihood, 20, {}, scratch, whole);
    EXPECT_EQ(whole.size(), 2U);
    SegmentMarkers(likelihood, 20, {}, scratch, parted, kArea);
    ASSERT_EQ(parted.size(), caps.size());
    for (const Eigen::Vector2d& cap : caps) {
      double nearest = 1e9;
      for (const MarkerBlob& blob : parted) {
        nearest = std::min(nearest, (blob.centre - cap).norm());
      }
      EXPECT_LT(nearest, 2);
    }
  }
}

TEST(MarkerColourTest, TheHueOfTheCapsIsFoundInThePicture) {
  const StereoCameras eyes = TestEyes();
  DrawnHand hand = MakeDrawnHand({0.03, 0.03, 0.6}, 0);
  for (DrawnCapsule& capsule : hand.capsules) {
    if (capsule.bgr.y() == 160) capsule.bgr = {190, 40, 20};  // blue caps
  }
  const auto hue = FindMarkerHue(DrawCapsules(eyes.left, hand.capsules), {});
  ASSERT_TRUE(hue);
  EXPECT_NEAR(*hue, 233, 20);
  // Nothing to find on an empty wall.
  EXPECT_FALSE(FindMarkerHue(DrawCapsules(eyes.left, {}), {}));
}

TEST(MarkerColourTest, HueRunsFromRedOverGreenAndBlueBackToRed) {
  EXPECT_NEAR(HueDeg({0.8, 0, 0}), 0, 1e-9);
  EXPECT_NEAR(HueDeg({0.5, 0.5, 0}), 60, 1e-9);
  EXPECT_NEAR(HueDeg({0.1, 0.9, 0.1}), 120, 1e-9);
  EXPECT_NEAR(HueDeg({0, 0, 255}), 240, 1e-9);
  EXPECT_NEAR(HueDeg({1, 0, 0.5}), 330, 1e-9);
}

TEST(MarkerColourTest, ChromaIsLinearInTheShareOfCap) {
  const MarkerColour colour = MakeMarkerColour({});
  const std::uint8_t cap[3] = {20, 160, 20}, grey[3] = {90, 90, 90}, half[3] = {55, 125, 55};
  EXPECT_NEAR(colour.Chroma(grey), 0, 1e-3);
  EXPECT_NEAR(colour.Chroma(half), 0.5 * colour.Chroma(cap), 1e-3);
}

TEST(HistogramTest, SimilarityIsOneForEqualAndZeroForDisjointHistograms) {
  Histogram a = {}, b = {}, c = {};
  a[3] = a[9] = b[3] = b[9] = 0.5F;
  c[20] = 1;
  EXPECT_NEAR(Bhattacharyya(a, b), 1, 1e-6);
  EXPECT_EQ(Bhattacharyya(a, c), 0);
}

}  // namespace
}  // namespace springgrasp
