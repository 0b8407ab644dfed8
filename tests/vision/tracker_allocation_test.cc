// The tracker's own memory is all there after its first frame.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "vision/fingertip_tracker.h"
#include "vision/synthetic_caps.h"

namespace {
std::atomic<long> allocations = 0;
}  // namespace

// OpenCV takes its pictures from elsewhere: what is counted here is C++'s own.
void* operator new(std::size_t size) {
  ++allocations;
  if (void* p = std::malloc(size)) return p;
  throw std::bad_alloc();
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }

namespace springgrasp {
namespace {

struct Pair {
  cv::Mat left, right;
};

Pair Draw(const StereoCameras& eyes, int k, bool cover) {
  const DrawnHand hand = MakeDrawnHand({0.09 - 0.0025 * k, 0.05, 0.62}, 0.02 * k);
  std::vector<DrawnCapsule> scene = hand.capsules;
  if (cover) {
    const Eigen::Vector3d before = hand.tips[kRing] - Eigen::Vector3d(-0.006, 0, 0.12);
    scene.push_back({before, before, 0.024, {160, 60, 60}});
  }
  return {DrawCapsules(eyes.left, scene), DrawCapsules(eyes.right, scene)};
}

// Allocations of an update, frame by frame; OpenCV's own (its labelling) come from a search only.
long AllocationsOf(FingertipTracker& tracker, const Pair& pair, RandomEngine& engine) {
  const long before = allocations;
  tracker.Update(pair.left, pair.right, engine);
  return allocations - before;
}

TEST(TrackerAllocation, FollowingTakesNoMemory) {
  const StereoCameras eyes = TestEyes();
  FingertipTracker tracker(eyes, {});
  RandomEngine engine = MakeStream(1, 0, "observation");
  const Pair first = Draw(eyes, 0, false);
  ASSERT_TRUE(tracker.Start(first.left, first.right));
  for (int k = 1; k < 8; ++k) {
    const Pair pair = Draw(eyes, k, false);
    const long count = AllocationsOf(tracker, pair, engine);
    if (k > 1) EXPECT_EQ(count, 0) << "frame " << k;
  }
}

TEST(TrackerAllocation, SearchingAlwaysTakesTheSame) {
  const StereoCameras eyes = TestEyes();
  FingertipTracker tracker(eyes, {});
  RandomEngine engine = MakeStream(1, 0, "observation");
  const Pair first = Draw(eyes, 0, false);
  ASSERT_TRUE(tracker.Start(first.left, first.right));
  // What OpenCV's labelling of two pictures takes by itself.
  MarkerScratch scratch;
  std::vector<MarkerBlob> blobs;
  blobs.reserve(64);
  cv::Mat green;
  cv::inRange(first.left, cv::Scalar(0, 60, 0), cv::Scalar(60, 255, 60), green);
  SegmentMarkers(green, 10, {}, scratch, blobs);
  ASSERT_EQ(blobs.size(), 5u);
  const long before = allocations;
  SegmentMarkers(green, 10, {}, scratch, blobs);
  const long of_opencv = 2 * (allocations - before) + 4;  // differs a little with the blobs
  for (int k = 1; k < 8; ++k) {
    const Pair pair = Draw(eyes, k, true);
    const long count = AllocationsOf(tracker, pair, engine);
    if (k > 2) EXPECT_LE(count, of_opencv) << "frame " << k;
  }
}

}  // namespace
}  // namespace springgrasp
