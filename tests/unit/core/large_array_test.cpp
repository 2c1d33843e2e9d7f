#include "gridlock/core/detail/large_array.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <set>
#include <vector>

namespace gridlock {
namespace {

std::uintptr_t address_of(LargeArray<double> const& array) { return reinterpret_cast<std::uintptr_t>(array.data()); }

TEST(LargeArray, BeginsAtACacheLineShortOrLong) {
  for (std::size_t const numbers : {1, 100, 300'000}) {
    EXPECT_EQ(address_of(LargeArray<double>(numbers, 1.0)) % 64, 0U) << numbers << " numbers";
  }
}

TEST(LargeArray, LongOnesThatAreUsedSideBySideBeginAtDifferentLinesOfAPage) {
  std::vector<LargeArray<double>> columns;
  std::set<std::uintptr_t> lines;
  for (int column = 0; column < 12; ++column) {
    columns.emplace_back(300'000, 0.5);
    lines.insert(address_of(columns.back()) % 4096);
  }
  EXPECT_EQ(lines.size(), 12U);
}

TEST(LargeArray, LiesSideBySideWithOthersInOneBlockThatGoesWithTheLast) {
  for (std::size_t const numbers : {1, 100, 300'000}) {
    std::size_t const bytes = numbers * sizeof(double);
    LargeArray<double> const alone(numbers, 0.5);
    LargeArray<double> first, second, third;
    {
      SideBySide const scope(2 * SideBySide::room_for(bytes));
      first.assign(numbers, 1.0);
      second.assign(numbers, 2.0);
      third.assign(numbers, 3.0);
    }
    EXPECT_TRUE(are_side_by_side(first.data(), second.data()));
    EXPECT_EQ(address_of(second) - address_of(first), SideBySide::room_for(bytes));
    EXPECT_EQ(address_of(first) % 64, 0U);
    EXPECT_FALSE(are_side_by_side(second.data(), third.data())) << "no room is left for it";
    EXPECT_FALSE(are_side_by_side(alone.data(), third.data()));
    first.push_back(1.5);
    EXPECT_FALSE(are_side_by_side(first.data(), second.data()));
    EXPECT_EQ(second, LargeArray<double>(numbers, 2.0));
  }
}

TEST(LargeArray, ScopesOfBlocksMayLieInOneAnother) {
  SideBySide const outer(3 * SideBySide::room_for(8));
  LargeArray<double> const first(1);
  {
    SideBySide const inner(SideBySide::room_for(8));
    LargeArray<double> const other(1);
    EXPECT_FALSE(are_side_by_side(first.data(), other.data()));
  }
  LargeArray<double> const second(1);
  EXPECT_TRUE(are_side_by_side(first.data(), second.data()));
}

TEST(LargeArray, KeepsItsNumbersWhileItGrows) {
  LargeArray<double> array;
  for (int k = 0; k < 600'000; ++k) array.push_back(k);
  double sum = 0.0;
  for (double const number : array) sum += number;
  EXPECT_EQ(sum, 599'999.0 * 300'000.0);
}

}  // namespace
}  // namespace gridlock
