#include "core/saturating.hpp"

#include <gtest/gtest.h>

namespace gridlock {
namespace {

TEST(Saturating, SumsEndAtTheLargestCount) {
  EXPECT_EQ(saturating_sum(2, 3), 5U);
  EXPECT_EQ(saturating_sum(never_reached, 0), never_reached);
  EXPECT_EQ(saturating_sum(1, never_reached), never_reached);
  EXPECT_EQ(saturating_sum(never_reached / 2 + 1, never_reached / 2 + 1), never_reached);
}

TEST(Saturating, TheNextMultipleIsAboveTheCount) {
  EXPECT_EQ(next_multiple(10, 0), 10U);
  EXPECT_EQ(next_multiple(10, 9), 10U);
  EXPECT_EQ(next_multiple(10, 10), 20U);
  EXPECT_EQ(next_multiple(never_reached / 2, never_reached - 2), never_reached - 1);
  EXPECT_EQ(next_multiple(never_reached / 2, never_reached - 1), never_reached);
}

}  // namespace
}  // namespace gridlock
