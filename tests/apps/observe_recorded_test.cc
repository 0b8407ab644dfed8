// springgrasp observe on recorded stereo video, from outside.
#include <gmock/gmock.h>

#include "apps/recorded_fixture.h"
#include "demonstration/demonstration.h"

namespace springgrasp {
namespace {

using testing::HasSubstr;

// The drawn caps and their truth, which is the middle.
const std::string kCaps =
    "--truth truth.csv --cap-diameter 0.018 --cap-length 0.025 --cap-centre 0.0125";

TEST_F(ObserveRecordedTest, PicturesAreTrackedAndComparedWithTheirTruth) {
  const ProgramResult result = Observe(kCaps + " --overlay new/o.mp4");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  const Errors errors = ErrorsIn(result.out);
  EXPECT_LT(errors.median, 3) << result.out;
  EXPECT_LT(errors.p95, 7) << result.out;
  EXPECT_EQ(errors.swaps, 0);
  EXPECT_THAT(result.out, HasSubstr("epipolar residual"));
  const Demonstration demonstration = ReadDemonstration(folder_ / "demo.csv");
  EXPECT_EQ(demonstration.frame, "camera_left");
  EXPECT_FALSE(demonstration.up);
  EXPECT_EQ(demonstration.samples.size(), std::size_t{kFrames});
  EXPECT_GT(fs::file_size(folder_ / "new/o.mp4"), 1000U);
}

TEST_F(ObserveRecordedTest, SameFramesAndSeedGiveTheSameBytes) {
  ASSERT_EQ(Observe("--seed 5").exit_code, 0);
  const std::string first = ReadFile(folder_ / "demo.csv");
  ASSERT_EQ(Observe("--seed 5").exit_code, 0);
  EXPECT_EQ(ReadFile(folder_ / "demo.csv"), first);
}

TEST_F(ObserveRecordedTest, TheCamerasPoseMovesTheDemonstrationAlong) {
  ASSERT_EQ(Observe("").exit_code, 0);
  const Demonstration here = ReadDemonstration(folder_ / "demo.csv");
  ASSERT_EQ(Observe("--camera-pose '1 2 3 1 0 0 0'").exit_code, 0);
  const Demonstration there = ReadDemonstration(folder_ / "demo.csv");
  EXPECT_EQ(there.frame, "world");
  ASSERT_TRUE(here.samples[3].p_WF[kIndex] && there.samples[3].p_WF[kIndex]);
  EXPECT_LT(
      (*there.samples[3].p_WF[kIndex] - *here.samples[3].p_WF[kIndex] - Eigen::Vector3d(1, 2, 3))
          .norm(),
      1e-3);
}

TEST_F(ObserveRecordedTest, ThePapersTrackerTracksToo) {
  const ProgramResult result = Observe("--tracker paper --truth truth.csv");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_LT(ErrorsIn(result.out).median, 8) << result.out;
  EXPECT_EQ(ErrorsIn(result.out).swaps, 0) << result.out;
}

TEST_F(ObserveRecordedTest, ALensDistortionIsUndone) {
  StereoCameras eyes = TestEyes();
  eyes.left.distortion = {-0.25, 0.08, 0.001, -0.002, 0, 0, 0, 0};
  eyes.right.distortion = {-0.22, 0.06, -0.001, 0.001, 0, 0, 0, 0};
  Record(eyes);
  const Errors known = ErrorsIn(Observe(kCaps).out);
  EXPECT_LT(known.median, 3);
  EXPECT_LT(known.p95, 7);
  // It matters: with calibration files that know nothing of it the errors are larger.
  WriteCalibration(IntrinsicsText(TestEyes()), ExtrinsicsText(eyes));
  EXPECT_GT(ErrorsIn(Observe(kCaps).out).median, 2 * known.median);
}

class PictureSizeTest : public ObserveRecordedTest,
                        public testing::WithParamInterface<std::pair<int, int>> {
 protected:
  static void SetUpTestSuite() {}
  void SetUp() override { Record(EyesOfSize(GetParam().first, GetParam().second), true); }
};

TEST_P(PictureSizeTest, IsTracked) {
  const ProgramResult result = Observe(kCaps);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_LT(ErrorsIn(result.out).median, GetParam().second < 480 ? 5 : 3) << result.out;
  EXPECT_EQ(ErrorsIn(result.out).swaps, 0) << result.out;
}

INSTANTIATE_TEST_SUITE_P(Sizes, PictureSizeTest,
                         testing::Values(std::pair(320, 240), std::pair(1280, 720),
                                         std::pair(1920, 1080)));

TEST_F(ObserveRecordedTest, AVideoThatBreaksOffKeepsWhatWasTracked) {
  MakeVideo("left");
  MakeVideo("right", 0.75);
  const ProgramResult result = Observe("", "left.avi", "right.avi");
  EXPECT_EQ(result.exit_code, 3) << result.err;
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_THAT(result.err, HasSubstr("right.avi: breaks off"));
  EXPECT_THAT(result.err, HasSubstr("what was tracked is kept"));
  const std::string csv = ReadFile(folder_ / "demo.csv");
  EXPECT_THAT(csv, HasSubstr("ended early: right.avi"));
}

}  // namespace
}  // namespace springgrasp
