// springgrasp observe on recorded stereo video, from outside.
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <regex>

#include "apps/program.h"
#include "apps/recorded_files.h"
#include "demonstration/demonstration.h"
#include "experiment/small_experiment.h"

namespace springgrasp {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

constexpr int kFrames = 12;

class ObserveRecordedTest : public testing::Test {
 protected:
  void SetUp() override { Record(TestEyes()); }

  void Record(const StereoCameras& eyes) {
    DrawRecording(eyes, kFrames, Folder());
    WriteCalibration(IntrinsicsText(eyes), ExtrinsicsText(eyes));
    folder_.Write("truth.csv", TruthText(kFrames));
  }

  void WriteCalibration(const std::string& intrinsics, const std::string& extrinsics) {
    folder_.Write("i.yml", intrinsics);
    folder_.Write("e.yml", extrinsics);
  }

  // The pictures as a Motion JPEG video; `part` of its bytes is kept.
  void MakeVideo(const std::string& side, double part = 1) {
    const std::string path = folder_ / (side + ".avi");
    cv::VideoWriter writer(path, cv::CAP_FFMPEG, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 30,
                           {640, 480});
    for (int i = 0; i < kFrames; ++i) {
      writer.write(cv::imread(folder_ / fmt::format("{}_{:03d}.png", side, i)));
    }
    writer.release();
    fs::resize_file(path, static_cast<std::uintmax_t>(part * double(fs::file_size(path))));
  }

  ProgramResult Observe(const std::string& more, const std::string& left = "left_%03d.png --fps 30",
                        const std::string& right = "right_%03d.png") {
    return RunProgram("springgrasp observe --left " + left + " --right " + right +
                          " --intrinsics i.yml --extrinsics e.yml -o demo.csv " + more,
                      Folder());
  }

  void ExpectRefused(const ProgramResult& result, const std::string& part) {
    EXPECT_EQ(result.exit_code, 2) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_THAT(result.err, HasSubstr(part));
    EXPECT_EQ(result.out, "");
    EXPECT_FALSE(fs::exists(folder_ / "demo.csv"));
  }

  // Millimetres and swaps out of the line of all fingertips.
  struct Errors {
    double median = 1e9, p95 = 1e9;
    int swaps = -1;
  };
  static Errors ErrorsIn(const std::string& out) {
    std::smatch m;
    const std::regex line("all: median ([0-9.]+) mm, 95 % ([0-9.]+) mm, ([0-9]+) label swaps");
    if (!std::regex_search(out, m, line)) return {};
    return {std::stod(m[1]), std::stod(m[2]), std::stoi(m[3])};
  }

  std::string Folder() const { return folder_ / "."; }
  TemporaryFolder folder_;
};

TEST_F(ObserveRecordedTest, PicturesAreTrackedAndComparedWithTheirTruth) {
  const ProgramResult result =
      Observe("--truth truth.csv --cap-diameter 0.018 --cap-length 0.025 --overlay new/o.mp4");
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
  const std::string caps = "--truth truth.csv --cap-diameter 0.018 --cap-length 0.025 ";
  const Errors known = ErrorsIn(Observe(caps).out);
  EXPECT_LT(known.median, 3);
  EXPECT_LT(known.p95, 7);
  // It matters: with calibration files that know nothing of it the errors are larger.
  WriteCalibration(IntrinsicsText(TestEyes()), ExtrinsicsText(eyes));
  EXPECT_GT(ErrorsIn(Observe(caps).out).median, 2 * known.median);
}

class PictureSizeTest : public ObserveRecordedTest,
                        public testing::WithParamInterface<std::pair<int, int>> {
  void SetUp() override { Record(EyesOfSize(GetParam().first, GetParam().second)); }
};

TEST_P(PictureSizeTest, IsTracked) {
  const ProgramResult result = Observe("--truth truth.csv --cap-diameter 0.018 --cap-length 0.025");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_LT(ErrorsIn(result.out).median, GetParam().second < 480 ? 5 : 3) << result.out;
  EXPECT_EQ(ErrorsIn(result.out).swaps, 0) << result.out;
}

INSTANTIATE_TEST_SUITE_P(Sizes, PictureSizeTest,
                         testing::Values(std::pair(320, 240), std::pair(1280, 720),
                                         std::pair(1920, 1080)));

TEST_F(ObserveRecordedTest, AVideoThatBreaksOffKeepsWhatWasTracked) {
  MakeVideo("left");
  MakeVideo("right", 0.85);
  const ProgramResult result = Observe("", "left.avi", "right.avi");
  EXPECT_EQ(result.exit_code, 3) << result.err;
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_THAT(result.err, HasSubstr("right.avi: breaks off"));
  EXPECT_THAT(result.err, HasSubstr("what was tracked is kept"));
  const std::string csv = ReadFile(folder_ / "demo.csv");
  EXPECT_THAT(csv, HasSubstr("ended early: right.avi"));
}

TEST_F(ObserveRecordedTest, BadInputIsRefused) {
  fs::create_directory(folder_ / "out");
  const StereoCameras eyes = TestEyes();
  ExpectRefused(Observe("", "none_%03d.png --fps 30"), "none_%03d.png: no pictures");
  ExpectRefused(Observe("", "left_%03d.png"), "give --fps");
  ExpectRefused(Observe("", "left_%03d.png --fps -3"), "--fps");
  ExpectRefused(Observe("", "left_%03d.png --fps nan"), "--fps");
  ExpectRefused(Observe("--marker-hue greenish"), "--marker-hue is 'greenish'");
  ExpectRefused(Observe("--marker-hue 400"), "--marker-hue is '400'");
  ExpectRefused(Observe("--hand both"), "--hand");
  ExpectRefused(Observe("--tracker magic"), "--tracker");
  ExpectRefused(Observe("--cap-length 0.025"), "--cap-diameter");
  ExpectRefused(Observe("--camera-pose '1 2'"), "--camera-pose has 2 numbers");
  ExpectRefused(Observe("--overlay o.gif"), ".mp4");
  ExpectRefused(Observe("--noise 3"), "for a scene");
  ExpectRefused(Observe("--truth absent.csv"), "absent.csv: no such file");
  folder_.Write("text.avi", "no video\n");
  ExpectRefused(Observe("", "text.avi"), "text.avi: not a video");
  // No cap in the first two seconds: nothing is made, not even the overlay's folder.
  ExpectRefused(Observe("--marker-hue 300 --overlay new/o.mp4"), "fingertip markers");
  EXPECT_FALSE(fs::exists(folder_ / "new"));

  const std::string intrinsics = IntrinsicsText(eyes), extrinsics = ExtrinsicsText(eyes);
  const auto calibration = [&](const std::string& i, const std::string& e, const char* part) {
    WriteCalibration(i, e);
    ExpectRefused(Observe(""), part);
  };
  calibration(intrinsics.substr(0, intrinsics.find("D2")), extrinsics, "i.yml: matrix 'D2'");
  calibration(intrinsics, extrinsics.substr(0, extrinsics.find("T:")), "e.yml: matrix 'T'");
  calibration(IntrinsicsText(EyesOfSize(1280, 960)), extrinsics, "another size");
  calibration(std::regex_replace(intrinsics, std::regex("540.5"), "0"), extrinsics, "singular");
  calibration(intrinsics, std::regex_replace(extrinsics, std::regex("0\\.99"), "0.5"),
              "not a rotation");
  calibration("", extrinsics, "i.yml");
}

TEST_F(ObserveRecordedTest, LeftAndRightMustBeAlike) {
  MakeVideo("left");
  fs::remove(folder_ / fmt::format("right_{:03d}.png", kFrames - 1));
  ExpectRefused(Observe(""), "11 frames, expected 12");
  const StereoCameras large = EyesOfSize(1280, 960);
  DrawRecording(large, 1, Folder());
  fs::remove(folder_ / "left_000.png");
  ExpectRefused(Observe("", "left.avi", "right_%03d.png"), "1280x960, expected 640x480");
}

}  // namespace
}  // namespace springgrasp
