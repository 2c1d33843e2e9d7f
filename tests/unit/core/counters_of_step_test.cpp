#include "gridlock/core/detail/counters_of_step.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace gridlock {
namespace {

/// What tiles have counted, with sums of which every order has another rounding.
std::vector<Counters> counters_of_tiles(std::size_t tiles) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  std::vector<Counters> all;
  for (std::size_t tile = 0; tile < tiles; ++tile) {
    all.push_back({.moves = tile + 1,
                   .halted_moves = tile % 5,
                   .pair_collisions = tile % 3,
                   .distance_checks = 4 * tile,
                   .wall_hits = {tile % 2, 0, 1, 2},
                   .wall_impulse = {number(random), 0.0, 1e8 * number(random), number(random)},
                   .pair_virial = (tile % 4 == 0 ? 1e6 : 1e-3) * number(random)});
  }
  return all;
}

Counters sum_of(std::vector<Counters> const& tiles) {
  CountersOfStep of_step;
  for (Counters const& tile : tiles) of_step.add(tile);
  Counters sum{.moves = 1, .wall_impulse = {0.0, 0.0, 3.0, 0.0}, .pair_virial = 0.1};
  of_step.add_to(sum);
  return sum;
}

void expect_equal(Counters const& a, Counters const& b) {
  EXPECT_EQ(a.moves, b.moves);
  EXPECT_EQ(a.halted_moves, b.halted_moves);
  EXPECT_EQ(a.pair_collisions, b.pair_collisions);
  EXPECT_EQ(a.distance_checks, b.distance_checks);
  EXPECT_EQ(a.wall_hits, b.wall_hits);
  EXPECT_EQ(a.wall_impulse, b.wall_impulse);
  EXPECT_EQ(a.pair_virial, b.pair_virial);
}

TEST(CountersOfStep, AddsToWhatARunHasCounted) {
  std::vector<Counters> const tiles{{.moves = 5, .wall_hits = {0, 1, 0, 0}, .wall_impulse = {0.0, 0.5, 0.0, 0.0}},
                                    {.moves = 7, .pair_collisions = 2, .pair_virial = 0.25}};
  expect_equal(sum_of(tiles), {.moves = 13,
                               .pair_collisions = 2,
                               .wall_hits = {0, 1, 0, 0},
                               .wall_impulse = {0.0, 0.5, 3.0, 0.0},
                               .pair_virial = 0.1 + 0.25});
}

TEST(CountersOfStep, HasTheBitsOfAnyOrderOfTheTiles) {
  std::vector<Counters> tiles = counters_of_tiles(300);
  Counters const expected = sum_of(tiles);
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    std::ranges::shuffle(tiles, std::mt19937_64(seed));
    expect_equal(sum_of(tiles), expected);
  }
}

TEST(CountersOfStep, HasTheBitsOfAnyDivisionAmongRanks) {
  std::vector<Counters> const tiles = counters_of_tiles(300);
  Counters const expected = sum_of(tiles);
  for (std::size_t const ranks : {1U, 2U, 3U, 7U, 300U}) {
    std::vector<CountersOfStep> of_ranks(ranks);
    for (std::size_t tile = 0; tile < tiles.size(); ++tile) of_ranks[tile * 31 % ranks].add(tiles[tile]);
    CountersOfStep all;
    for (CountersOfStep const& of_rank : of_ranks) {
      MessageWriter message;
      of_rank.write(message);
      Message const bytes = message.take();
      MessageReader reader(bytes);
      all.add(CountersOfStep::read(reader));
      EXPECT_TRUE(reader.is_at_end());
    }
    Counters sum{.moves = 1, .wall_impulse = {0.0, 0.0, 3.0, 0.0}, .pair_virial = 0.1};
    all.add_to(sum);
    expect_equal(sum, expected);
  }
}

}  // namespace
}  // namespace gridlock
