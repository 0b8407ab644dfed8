// The shipped library names the grasps of demonstrations that it never saw.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "experiment/synthesised_demonstration.h"
#include "grasp/library.h"

namespace springgrasp {
namespace {

TEST(RecogniseGrasp, HeldOutDemonstrationsOfTheFourTypesAreNamed) {
  const std::vector<LibraryEntry> library = ReadLibrary(ShippedLibrary());
  int right = 0, all = 0;
  for (const char* type : {"pinch", "tripod", "power", "lateral"}) {
    for (std::uint64_t draw = 0; draw < 5; ++draw) {
      RandomEngine engine = MakeStream(5001, draw, type);
      const Shape shape = RandomObjectFor(type, engine);
      const Demonstration shown = SynthesisedDemonstration(type, shape, 0.001, engine);
      const RecognisedGrasp best = RecogniseGrasp(shown, library).front();
      SCOPED_TRACE(fmt::format("{} of {} taken for {}", type, FormatShape(shape), best.type));
      EXPECT_LT(best.rmse, 0.05);
      right += best.type == type;
      ++all;
    }
  }
  EXPECT_GE(right, all - 1);
}

}  // namespace
}  // namespace springgrasp
