// A drawn recording in a folder of its own, and the program on it.
#pragma once

#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <regex>

#include "apps/program.h"
#include "apps/recorded_files.h"
#include "experiment/small_experiment.h"

namespace springgrasp {

namespace fs = std::filesystem;

inline constexpr int kFrames = 8;

class ObserveRecordedTest : public testing::Test {
 protected:
  // Drawn once.
  static void SetUpTestSuite() { DrawRecording(TestEyes(), kFrames, Drawn()); }

  void SetUp() override {
    for (const auto& entry : fs::directory_iterator(Drawn())) {
      fs::copy(entry.path(), folder_ / entry.path().filename().string());
    }
    WriteCalibration(IntrinsicsText(TestEyes()), ExtrinsicsText(TestEyes()));
    folder_.Write("truth.csv", TruthText(kFrames));
  }

  static std::string Drawn() {
    static const TemporaryFolder drawn;
    return drawn / ".";
  }

  // Another recording in its place.
  void Record(const StereoCameras& eyes, bool still = false) {
    DrawRecording(eyes, kFrames, Folder(), still);
    WriteCalibration(IntrinsicsText(eyes), ExtrinsicsText(eyes));
    folder_.Write("truth.csv", TruthText(kFrames, still));
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
    EXPECT_THAT(result.err, testing::HasSubstr(part));
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

}  // namespace springgrasp
