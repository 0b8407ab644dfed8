#include "base/last_value.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace springgrasp {
namespace {

TEST(LastValueTest, MakesOnceWhatIsAskedForAgain) {
  LastValue<int> last;
  int made = 0;
  const auto make = [&] { return ++made; };
  EXPECT_EQ(last.Get("a", make), 1);
  EXPECT_EQ(last.Get("a", make), 1);
  EXPECT_EQ(last.Get("b", make), 2);
  EXPECT_EQ(last.Get("a", make), 3);
}

TEST(LastValueTest, KeepsNothingOfAFailure) {
  LastValue<int> last;
  EXPECT_EQ(last.Get("a", [] { return 1; }), 1);
  EXPECT_THROW(last.Get("b", []() -> int { throw std::runtime_error("no"); }), std::runtime_error);
  EXPECT_EQ(last.Get("b", [] { return 2; }), 2);
}

}  // namespace
}  // namespace springgrasp
