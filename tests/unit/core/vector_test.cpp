#include "gridlock/core/vector.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace gridlock {
namespace {

TEST(Direction, IsCosineAndSineToTheLastBitsOfADouble) {
  for (int k = -20'000; k <= 20'000; ++k) {
    double const angle = 0.005 * k + 1e-4;
    Vector const d = direction(angle);
    EXPECT_NEAR(d.x, std::cos(angle), 4e-16) << angle;
    EXPECT_NEAR(d.y, std::sin(angle), 4e-16) << angle;
  }
}

TEST(Direction, IsExactWhereItCanBe) {
  EXPECT_EQ(direction(0.0), (Vector{1.0, 0.0}));
  EXPECT_TRUE(std::isnan(direction(INFINITY).x));
}

TEST(Direction, RotatedAddsAngles) {
  Vector const v = rotated(direction(0.4), direction(0.7));
  EXPECT_NEAR(v.x, std::cos(1.1), 1e-15);
  EXPECT_NEAR(v.y, std::sin(1.1), 1e-15);
}

}  // namespace
}  // namespace gridlock
