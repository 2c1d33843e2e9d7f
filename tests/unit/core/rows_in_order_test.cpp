#include "gridlock/core/detail/rows_in_order.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "gridlock/core/random.hpp"

namespace gridlock {
namespace {

std::vector<std::uint32_t> sorted_by_the_library(std::vector<Id> const& ids) {
  std::vector<std::uint32_t> rows(ids.size());
  std::iota(rows.begin(), rows.end(), 0U);
  std::ranges::stable_sort(rows, {}, [&](std::uint32_t row) { return ids[row]; });
  return rows;
}

TEST(RowsInOrder, AreThoseOfAStableSortForFewAndManyIdsOldAndNewAndTwice) {
  RandomStream random(3, 0, 0, Purpose::start_position);
  for (std::size_t const count : {0, 1, 2, 499, 500, 501, 20'000}) {
    for (std::uint64_t const generations : {1, 2, 70'000}) {
      std::vector<Id> ids(count);
      for (Id& id : ids) id = random.below(generations) << 32 | random.below(3 * count + 1);
      if (count > 1) ids.back() = ids.front();
      EXPECT_EQ(rows_in_order(ids), sorted_by_the_library(ids)) << count << " Ids";
    }
  }
  std::vector<Id> const extremes(600, ~Id{0});
  EXPECT_EQ(rows_in_order(extremes), sorted_by_the_library(extremes));
}

}  // namespace
}  // namespace gridlock
