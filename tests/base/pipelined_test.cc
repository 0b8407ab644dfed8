#include "base/pipelined.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <thread>
#include <vector>

namespace springgrasp {
namespace {

using Next = std::function<std::optional<int>()>;

Next CountTo(int n, int& made) {
  return [n, &made]() -> std::optional<int> {
    if (made == n) return std::nullopt;
    return made++;
  };
}

TEST(Pipelined, AllValuesArriveInOrder) {
  int made = 0;
  std::vector<int> got;
  Pipelined<int>(CountTo(1000, made), [&](const Next& next) {
    while (const auto value = next()) got.push_back(*value);
  });
  ASSERT_EQ(got.size(), 1000u);
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(got[i], i);
}

TEST(Pipelined, ProductionStaysOnTheCallingThreadAndConsumptionDoesNot) {
  const auto here = std::this_thread::get_id();
  bool once = false;
  Pipelined<int>(
      [&]() -> std::optional<int> {
        EXPECT_EQ(std::this_thread::get_id(), here);
        if (once) return std::nullopt;
        once = true;
        return 1;
      },
      [&](const Next& next) {
        EXPECT_NE(std::this_thread::get_id(), here);
        while (next()) continue;
      });
}

TEST(Pipelined, NoMoreIsMadeAheadThanAllowed) {
  int made = 0;
  Pipelined<int>(
      CountTo(1000, made), [](const Next& next) { next(); }, 3);
  // One taken, three waiting, one in the making.
  EXPECT_LE(made, 5);
}

TEST(Pipelined, FailuresOfEitherSideComeOut) {
  int made = 0;
  EXPECT_THROW(
      Pipelined<int>(CountTo(10, made), [](const Next&) { throw std::runtime_error("consumer"); }),
      std::runtime_error);
  EXPECT_THROW(Pipelined<int>([]() -> std::optional<int> { throw std::logic_error("producer"); },
                              [](const Next& next) {
                                while (next()) continue;
                              }),
               std::logic_error);
}

}  // namespace
}  // namespace springgrasp
