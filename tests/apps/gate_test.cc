// The regression gate on outcomes: runs experiments/gate and holds it against its expectation.
#include <gmock/gmock.h>

#include "apps/program.h"
#include "experiment/small_experiment.h"

namespace springgrasp {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(GateTest, TheShippedGraspsStillSucceed) {
  const TemporaryFolder folder;
  const std::string gate = SPRINGGRASP_SOURCE_DIR "/experiments/gate";
  ASSERT_EQ(
      RunProgram("springgrasp run '" + gate + "' -o out --jobs 2 --quiet", folder / "").exit_code,
      0);
  const ProgramResult check =
      RunProgram("springgrasp check out '" + gate + "/expect.yaml'", folder / "");
  EXPECT_EQ(check.exit_code, 0) << check.out << check.err;
  EXPECT_THAT(check.out, Not(HasSubstr("FAILED")));
}

}  // namespace
}  // namespace springgrasp
