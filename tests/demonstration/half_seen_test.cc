// Fingertips at the edge of what hides them.
#include "demonstration/half_seen.h"

#include <gtest/gtest.h>

#include <string>

namespace springgrasp {
namespace {

// A thumb seen (x) or not (.) at 30 Hz, and an index that always is.
Demonstration Seen(const std::string& thumb) {
  Demonstration demonstration;
  for (std::size_t n = 0; n < thumb.size(); ++n) {
    DemonstrationSample sample;
    sample.t = static_cast<double>(n) / 30;
    sample.p_WF[kIndex] = Eigen::Vector3d(0, 0, 1);
    if (thumb[n] == 'x') sample.p_WF[kThumb] = Eigen::Vector3d(1, 0, 0);
    demonstration.samples.push_back(sample);
  }
  return demonstration;
}

std::string Left(const std::string& thumb) {
  std::string left;
  for (const DemonstrationSample& sample : WithoutHalfSeenTips(Seen(thumb)).samples) {
    EXPECT_TRUE(sample.p_WF[kIndex]);
    left += sample.p_WF[kThumb] ? 'x' : '.';
  }
  return left;
}

TEST(HalfSeenTips, AreThoseNextToWhereAFingerWasHidden) {
  EXPECT_EQ(Left("xxxxx....xxxxx"), "xxxx......xxxx");
  EXPECT_EQ(Left("....xxxxxx...."), ".....xxxx.....");
  EXPECT_EQ(Left("xxxx....xxxxx.....xxxx"), "xxx......xxx.......xxx");
}

TEST(HalfSeenTips, EndsOfTheRecordingAndSingleMissesHideNothing) {
  EXPECT_EQ(Left("xxxxxxxx"), "xxxxxxxx");
  EXPECT_EQ(Left("xxxx.xxxx"), "xxxx.xxxx");
  EXPECT_EQ(Left(".xxxxxxx."), ".xxxxxxx.");
}

TEST(HalfSeenTips, AreKeptWhereLittleElseWasSeen) { EXPECT_EQ(Left("....xx...."), "....xx...."); }

}  // namespace
}  // namespace springgrasp
