// The shipped grasps: complete, sound, and moving as people do for every size and speed.
#include "grasp/library.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "base/error.h"
#include "grasp/generate.h"
#include "grasp/learn_fit.h"

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
        const double start = Aperture(motion.samples.front().p_HF, motion.involved);
        double widest = 0, at = 0;
        for (const FingertipMotionSample& sample : motion.samples) {
          const double aperture = Aperture(sample.p_HF, motion.involved);
          if (aperture > widest) {
            widest = aperture;
            at = sample.t / motion.T;
          }
          if (sample.t < motion.T - 1e-9) continue;
          for (int i = 0; i < kNumFingers; ++i) {
            if (!motion.involved[i]) continue;
            EXPECT_LT((sample.p_HF[i] - motion.X_HO * motion.p_OC[i]).norm(), 0.0011) << sample.t;
          }
        }
        EXPECT_GT(widest, start + 0.005);
        EXPECT_GE(at, 0.60);
        EXPECT_LE(at, 0.75);
      }
    }
  }
}

TEST(Library, AFolderWithoutGraspsIsAnError) { EXPECT_THROW(ReadLibrary("/nonexistent"), Error); }

}  // namespace
}  // namespace springgrasp
