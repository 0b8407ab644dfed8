// springgrasp observe on recorded stereo video that it must refuse.
#include <gmock/gmock.h>

#include "apps/recorded_fixture.h"

namespace springgrasp {
namespace {

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
  ExpectRefused(Observe(""), fmt::format("{} frames, expected {}", kFrames - 1, kFrames));
  cv::imwrite(folder_ / "large_000.png", cv::Mat(960, 1280, CV_8UC3, cv::Scalar(90, 90, 90)));
  ExpectRefused(Observe("", "left.avi", "large_%03d.png"), "1280x960, expected 640x480");
}

}  // namespace
}  // namespace springgrasp
