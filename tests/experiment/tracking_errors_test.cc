#include "experiment/tracking_errors.h"

#include <gmock/gmock.h>

namespace springgrasp {
namespace {

// Frames in which everything is seen and tracked to 1 mm.
std::vector<TrackingFrame> Good(int count) {
  std::vector<TrackingFrame> frames(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    frames[i].t = i / 30.0;
    frames[i].error.fill(0.001);
    frames[i].visible.fill(1);
    frames[i].wrist = 0.004;
    frames[i].rotation = 0.02;
  }
  return frames;
}

void Hide(std::vector<TrackingFrame>& frames, int finger, int begin, int end) {
  for (int i = begin; i < end; ++i) {
    frames[i].visible[finger] = 0.1;
    frames[i].error[finger].reset();
  }
}

TEST(RecoveryTest, CountsFramesUntilRightAgain) {
  std::vector<TrackingFrame> frames = Good(40);
  Hide(frames, kIndex, 5, 10);
  Hide(frames, kRing, 8, 20);
  for (int i = 20; i < 27; ++i) frames[i].error[kRing] = 0.02;  // wrong for seven frames
  const Recovery recovery = CountRecoveries(frames);
  EXPECT_EQ(recovery.hidden, 2);
  EXPECT_EQ(recovery.soon, 1);
  EXPECT_EQ(recovery.worst, 7);
}

TEST(RecoveryTest, LeavesOutWhatCannotBeTold) {
  std::vector<TrackingFrame> frames = Good(40);
  Hide(frames, kThumb, 0, 5);     // never seen before
  Hide(frames, kIndex, 2, 20);    // longer than 15 frames
  Hide(frames, kMiddle, 30, 40);  // never seen again
  Hide(frames, kPinkie, 30, 37);  // seen for three frames, not yet found
  for (int i = 37; i < 40; ++i) frames[i].error[kPinkie].reset();
  EXPECT_EQ(CountRecoveries(frames).hidden, 0);
}

TEST(RecoveryTest, NeverFoundAgainIsNotRecovered) {
  std::vector<TrackingFrame> frames = Good(30);
  Hide(frames, kIndex, 5, 10);
  for (int i = 10; i < 30; ++i) frames[i].error[kIndex].reset();
  const Recovery recovery = CountRecoveries(frames);
  EXPECT_EQ(recovery.hidden, 1);
  EXPECT_EQ(recovery.soon, 0);
  EXPECT_EQ(recovery.worst, 20);
}

TEST(TrackingCsvTest, HasARowPerFrameAndEmptyCellsForWhatWasNotTracked) {
  std::vector<TrackingFrame> frames = Good(2);
  frames[1].error[kThumb].reset();
  frames[1].wrist.reset();
  frames[1].swapped[kRing] = frames[1].swapped[kPinkie] = true;
  EXPECT_EQ(FormatTracking(frames),
            "t,thumb_m,index_m,middle_m,ring_m,pinkie_m,thumb_visible,index_visible,"
            "middle_visible,ring_visible,pinkie_visible,wrist_m,rotation_rad,swapped\n"
            "0.000000,0.001000,0.001000,0.001000,0.001000,0.001000,1.000,1.000,1.000,1.000,1.000,"
            "0.004000,0.020000,\n"
            "0.033333,,0.001000,0.001000,0.001000,0.001000,1.000,1.000,1.000,1.000,1.000,"
            ",0.020000,ring pinkie\n");
}

}  // namespace
}  // namespace springgrasp
