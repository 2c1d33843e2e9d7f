#include "core/number_text.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <limits>

#include "gridlock/core/random.hpp"

namespace gridlock {
namespace {

TEST(NumberText, IsThatOfFmt) {
  double const largest = std::numeric_limits<double>::max();
  for (double const value : {0.0, -0.0, 1.0, -2.5, 0.1, 1e-4, 9.999e-5, 1e15, 9999999999999998.0, 1e16, 1e300, largest,
                             std::numeric_limits<double>::denorm_min(), std::numeric_limits<double>::infinity(),
                             -std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_EQ(number_text(value), fmt::format("{}", value));
  }
  RandomStream random(1, 0, 0, Purpose::start_position);
  for (int n = 0; n < 20000; ++n) {
    auto const bits = random.below(std::uint64_t{1} << 32) << 32 | random.below(std::uint64_t{1} << 32);
    auto const any = std::bit_cast<double>(bits);
    if (any == any) {
      EXPECT_EQ(number_text(any), fmt::format("{}", any));
    }
    double const usual = 1e5 * (random.uniform() - 0.5);
    EXPECT_EQ(number_text(usual), fmt::format("{}", usual));
  }
}

}  // namespace
}  // namespace gridlock
