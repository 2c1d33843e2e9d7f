#include "parallel/sort_among_ranks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <set>
#include <vector>

#include "gridlock/core/random.hpp"
#include "thread_ranks.hpp"

namespace gridlock {
namespace {

struct Keyed {
  std::uint64_t key;
  std::uint64_t also_key;  ///< which has to come along
};

/// Keys of which no two are equal, as wide as `bits` says, in no order.
std::vector<Keyed> any_values(RandomStream& random, std::size_t count, std::uint64_t bits) {
  std::set<std::uint64_t> known;
  std::vector<Keyed> values;
  while (values.size() < count) {
    std::uint64_t const key = random.bits() >> (64 - bits);
    if (known.insert(key).second) values.push_back({key, ~key});
  }
  return values;
}

void expect_sorted(std::vector<Keyed> const& values, std::size_t ranks, RandomStream& random) {
  // As many on each rank as it happens: none on some.
  std::vector<std::vector<Keyed>> of_ranks(ranks);
  std::uint64_t const favoured = random.below(ranks);
  for (Keyed const& value : values) of_ranks[random.below(2) == 0 ? favoured : random.below(ranks)].push_back(value);
  RowDivision const rows = RowDivision::even(values.size(), ranks);
  test::ThreadRanks(ranks).run([&](Communicator& here) {
    sort_among_ranks(here, of_ranks[here.rank()], rows, [](Keyed const& value) { return value.key; });
  });
  std::vector<std::uint64_t> expected;
  for (Keyed const& value : values) expected.push_back(value.key);
  std::ranges::sort(expected);
  std::vector<std::uint64_t> found;
  for (std::size_t rank = 0; rank < ranks; ++rank) {
    ASSERT_EQ(of_ranks[rank].size(), rows.rows_of(rank)) << "rank " << rank << " of " << ranks;
    for (Keyed const& value : of_ranks[rank]) {
      ASSERT_EQ(value.also_key, ~value.key);
      found.push_back(value.key);
    }
  }
  ASSERT_EQ(found, expected);
}

TEST(SortAmongRanks, GivesEachRankItsRowsInTheOrderOfTheKeys) {
  for (std::uint64_t seed = 0; seed < 120; ++seed) {
    RandomStream random(seed, 0, 0, Purpose::start_position);
    std::uint64_t const bits = 10 + random.below(55);
    std::size_t const count = random.below(seed % 4 == 0 ? 8 : 600);
    ASSERT_NO_FATAL_FAILURE(expect_sorted(any_values(random, count, bits), 1 + random.below(7), random)) << seed;
  }
}

TEST(SortAmongRanks, KnowsTheSmallestAndTheLargestKey) {
  RandomStream random(1, 0, 0, Purpose::start_position);
  constexpr std::uint64_t largest = std::numeric_limits<std::uint64_t>::max();
  for (std::size_t const ranks : {1U, 2U, 3U, 5U}) {
    expect_sorted({{largest, 0}, {0, largest}, {largest - 1, 1}}, ranks, random);
    expect_sorted({{7, ~std::uint64_t{7}}}, ranks, random);
    expect_sorted({}, ranks, random);
  }
}

TEST(SortAmongRanks, SendsManyValuesInSeveralMessages) {
  RandomStream random(2, 0, 0, Purpose::start_position);
  expect_sorted(any_values(random, 300'000, 40), 3, random);
}

}  // namespace
}  // namespace gridlock
