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

TEST(LargeArray, KeepsItsNumbersWhileItGrows) {
  LargeArray<double> array;
  for (int k = 0; k < 600'000; ++k) array.push_back(k);
  double sum = 0.0;
  for (double const number : array) sum += number;
  EXPECT_EQ(sum, 599'999.0 * 300'000.0);
}

}  // namespace
}  // namespace gridlock
