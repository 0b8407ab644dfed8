#include "demonstration/demonstration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>

#include "base/error.h"
#include "base/random.h"

namespace springgrasp {
namespace {

using testing::HasSubstr;

constexpr char kHeader[] = "t,thumb_x,thumb_y,thumb_z,index_x,index_y,index_z\n";

// Ten samples of thumb and index, 20 ms apart; `cell` may change any text before it is written.
std::string Table(
    const std::function<std::string(int row, int column, std::string)>& cell =
        [](int, int, std::string text) { return text; },
    int rows = 10) {
  std::string text = kHeader;
  for (int r = 0; r < rows; ++r) {
    text += cell(r, 0, std::to_string(0.02 * r));
    for (int c = 1; c <= 6; ++c) text += "," + cell(r, c, std::to_string(0.1 * c + 0.01 * r));
    text += "\n";
  }
  return text;
}

std::string MessageOf(const std::string& text) {
  try {
    ParseDemonstration(text, "d.csv");
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

std::string MessageWithCell(const char* bad) {
  return MessageOf(
      Table([bad](int r, int c, std::string text) { return r == 4 && c == 2 ? bad : text; }));
}

TEST(DemonstrationTest, PlainTableIsRead) {
  const Demonstration d = ParseDemonstration(Table(), "d.csv");
  ASSERT_EQ(d.samples.size(), 10u);
  EXPECT_DOUBLE_EQ(d.samples[3].t, 0.06);
  EXPECT_NEAR(d.samples[3].p_WF[kIndex]->y(), 0.53, 1e-12);
  EXPECT_FALSE(d.samples[3].p_WH || d.samples[3].R_WH || d.samples[3].p_WF[kRing]);
  EXPECT_EQ(d.frame, "world");
  EXPECT_EQ(*d.up, Eigen::Vector3d::UnitZ());
}

TEST(DemonstrationTest, BadCellsAreNamedWithFileAndLine) {
  EXPECT_THAT(MessageWithCell("lost"), testing::AllOf(HasSubstr("d.csv:6:"), HasSubstr("lost")));
  EXPECT_THAT(MessageWithCell("1.0x"), HasSubstr("1.0x"));
  EXPECT_THAT(MessageWithCell("0,1"), HasSubstr("8 cells"));
  for (const char* bad : {"inf", "-inf", "nan", "1e999"}) {
    EXPECT_THAT(MessageWithCell(bad), testing::AllOf(HasSubstr("d.csv:6:"), HasSubstr("finite")));
  }
  EXPECT_THAT(MessageWithCell(""), HasSubstr("2 of 3"));
  EXPECT_THAT(MessageWithCell("412.5"), HasSubstr("millimetres"));
}

TEST(DemonstrationTest, TimeMustIncrease) {
  for (const char* t : {"0.06", "0.01", "-1"}) {
    const std::string text =
        Table([t](int r, int c, std::string cell) { return r == 4 && c == 0 ? t : cell; });
    EXPECT_THAT(MessageOf(text), testing::AllOf(HasSubstr("d.csv:6:"), HasSubstr("increase")));
  }
}

TEST(DemonstrationTest, TooLittleIsRefused) {
  EXPECT_THAT(MessageOf(Table([](int, int, std::string s) { return s; }, 3)),
              HasSubstr("3 samples, expected at least 8"));
  EXPECT_THAT(MessageOf(""), HasSubstr("empty"));
  EXPECT_THAT(MessageOf("# frame: world\n\n"), HasSubstr("empty"));
  EXPECT_THAT(MessageOf(kHeader), HasSubstr("0 samples"));
  const std::string one_finger = Table([](int, int c, std::string s) { return c > 3 ? "" : s; });
  EXPECT_THAT(MessageOf(one_finger), HasSubstr("1 finger seen"));
  EXPECT_THAT(MessageOf("a,b\n1,2\n"), HasSubstr("header"));
  EXPECT_THROW(ReadDemonstration("/nowhere/demo.csv"), Error);
}

TEST(DemonstrationTest, TimeInMillisecondsIsRefused) {
  const std::string text =
      Table([](int r, int c, std::string s) { return c == 0 ? std::to_string(20 * r) : s; });
  EXPECT_THAT(MessageOf(text), HasSubstr("Hz"));
}

TEST(DemonstrationTest, CommentKeysAreRead) {
  const std::string head =
      "# frame: camera_left\n# object: cylinder:0.05x0.2; pose: 1 2 3 0 1 0 0\n"
      "# marker_offset: 0.004\n# shown by a person: right hand\n";
  const Demonstration d = ParseDemonstration(head + Table(), "d.csv");
  EXPECT_EQ(d.frame, "camera_left");
  EXPECT_FALSE(d.up.has_value());
  ASSERT_TRUE(d.object.has_value());
  EXPECT_EQ(FormatShape(d.object->shape), "cylinder:0.05x0.2");
  EXPECT_NEAR(d.object->X_WO.linear()(1, 1), -1, 1e-12);
  EXPECT_EQ(d.marker_offset, 0.004);
  EXPECT_THAT(d.comments, testing::ElementsAre("shown by a person: right hand"));
  EXPECT_EQ(*ParseDemonstration("# frame: camera_left\n# up: 0 -2 0\n" + Table(), "").up,
            -Eigen::Vector3d::UnitY());
  EXPECT_EQ(ParseDemonstration("# frame: x right, y away, z up\n" + Table(), "").frame,
            "recording");
  EXPECT_THAT(MessageOf("# frame: moon\n" + Table()), HasSubstr("camera_left"));
  EXPECT_THAT(MessageOf("# up: 0 0\n" + Table()), HasSubstr("d.csv:1:"));
  EXPECT_THAT(MessageOf("# object: cone:1; pose: 0 0 0 1 0 0 0\n" + Table()), HasSubstr("sphere"));
}

TEST(DemonstrationTest, LinesOfOtherSystemsAndFurtherColumnsAreRead) {
  std::string text = "\xEF\xBB\xBF";
  for (const char c : Table()) text += c == '\n' ? std::string("\r\n") : std::string(1, c);
  EXPECT_EQ(ParseDemonstration(text, "d.csv").samples.size(), 10u);

  std::string wide = "t,thumb_x,thumb_y,thumb_z,index_x,index_y,index_z,thumb_confidence,note\n";
  for (int r = 0; r < 9; ++r) {
    wide += std::to_string(0.02 * r) + ",0.1,0.2,0.3,0.4,0.5,0.6,0.25,good\n";
  }
  const Demonstration d = ParseDemonstration(wide, "d.csv");
  EXPECT_EQ(d.samples[0].confidence[kThumb], 0.25);
  EXPECT_EQ(d.samples[0].confidence[kIndex], 1);
  EXPECT_THAT(d.further_columns, testing::ElementsAre("note"));
  EXPECT_THAT(FormatDemonstration(d), HasSubstr("good"));
}

TEST(DemonstrationTest, WritingAndReadingReturnsTheSameValues) {
  RandomEngine engine = MakeStream(7, 0, "test");
  Demonstration d;
  d.source = "d.csv";
  d.comments = {"made for a test"};
  d.object = DemonstratedObject{ParseShape("box:0.04x0.05x0.1"),
                                MakePose({0.1, 0.2, 0.3}, ExpRotation({0.3, 0.2, 0.1}))};
  for (int i = 0; i < 40; ++i) {
    DemonstrationSample s;
    s.t = 0.03 * i + 0.001 * Uniform01(engine);
    const auto point = [&] {
      return Eigen::Vector3d(Normal(engine), Normal(engine), Normal(engine));
    };
    if (Uniform01(engine) < 0.8) s.p_WH = point();
    if (Uniform01(engine) < 0.8) s.R_WH = ExpRotation(point());
    for (int f = 0; f < kNumFingers; ++f) {
      if (f != kRing && Uniform01(engine) < 0.9) {
        s.p_WF[f] = point();
        s.confidence[f] = Uniform01(engine);
      }
    }
    d.samples.push_back(s);
  }
  const std::string path = testing::TempDir() + "/round_trip.csv";
  WriteDemonstration(d, path);
  const Demonstration back = ReadDemonstration(path);
  ASSERT_EQ(back.samples.size(), d.samples.size());
  for (std::size_t i = 0; i < d.samples.size(); ++i) {
    EXPECT_EQ(back.samples[i].t, d.samples[i].t);
    EXPECT_EQ(back.samples[i].p_WH, d.samples[i].p_WH);
    EXPECT_EQ(back.samples[i].R_WH.has_value(), d.samples[i].R_WH.has_value());
    if (d.samples[i].R_WH) {
      EXPECT_EQ(back.samples[i].R_WH->coeffs(), d.samples[i].R_WH->coeffs());
    }
    EXPECT_EQ(back.samples[i].p_WF, d.samples[i].p_WF);
    EXPECT_EQ(back.samples[i].confidence, d.samples[i].confidence);
  }
  EXPECT_TRUE(back.object->X_WO.isApprox(d.object->X_WO, 1e-15));
  EXPECT_EQ(back.comments, d.comments);
  std::filesystem::remove(path);
}

TEST(DemonstrationTest, TheRecordingsAreRead) {
  const std::filesystem::path folder = std::string(SPRINGGRASP_SHARED_DIR) + "/demonstrations";
  if (!std::filesystem::is_directory(folder)) {
    GTEST_SKIP() << "the recordings are not beside the project";
  }
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".csv") continue;
    const Demonstration d = ReadDemonstration(entry.path().string());
    const PerFinger<bool> recorded = RecordedFingers(d);
    const bool pinch = entry.path().filename().string().starts_with("pinch");
    EXPECT_TRUE(recorded[kThumb] && recorded[kIndex]) << entry.path();
    EXPECT_NE(recorded[kPinkie], pinch) << entry.path();
    EXPECT_NE(d.samples[0].p_WH.has_value(), pinch) << entry.path();
    EXPECT_GT(d.samples.size(), 150u);
  }
}

}  // namespace
}  // namespace springgrasp
