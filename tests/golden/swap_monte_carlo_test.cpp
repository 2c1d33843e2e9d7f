// The bits of starts with continuous sizes, of starts that overlap and of swap Monte Carlo, for ever; how to accept
// others: see hashes_test.cpp.

#include "gridlock/engine/swap_monte_carlo.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "golden/table.hpp"
#include "gridlock/lattice/start.hpp"

namespace gridlock {
namespace {

std::string hash_text(State const& state) { return fmt::format("{:016x}", hash(state)); }

void expect_golden(std::string const& scene, Edge edge, DisksSettings const& disks) {
  State state = make_start(Box(1.25, 0.8, edge), disks, 20);
  std::string const start = hash_text(state);
  SwapMonteCarlo swaps({.sweeps = 150}, state);
  swaps.advance(state);
  // The step that was adjusted is in what comes after.
  HashTable("swap_monte_carlo.csv").expect({scene, "swap"}, {start, hash_text(state)});
}

TEST(GoldenSwaps, OfEverySizeDistribution) {
  expect_golden(
      "inverse_cube", Edge::periodic,
      {.count = 300, .packing_fraction = 0.5, .sizes = SizeDistribution::inverse_cube, .start = StartKind::random});
  expect_golden("uniform", Edge::wall,
                {.count = 200, .packing_fraction = 0.3, .sizes = SizeDistribution::uniform, .size_spread = 0.3});
  expect_golden("normal", Edge::periodic,
                {.count = 250,
                 .packing_fraction = 0.5,
                 .sizes = SizeDistribution::normal,
                 .size_spread = 0.1,
                 .start = StartKind::random});
}

TEST(GoldenSwaps, OfAStartThatOverlaps) {
  DisksSettings const disks{
      .count = 300, .packing_fraction = 0.86, .sizes = SizeDistribution::inverse_cube, .start = StartKind::uniform};
  std::string const start = hash_text(make_start(Box(1.25, 0.8, Edge::periodic), disks, 20));
  HashTable("swap_monte_carlo.csv").expect({"overlapping", "none"}, {start, start});
}

TEST(GoldenSwaps, AreThoseOfTheTable) {
  HashTable("swap_monte_carlo.csv")
      .expect_only({{"inverse_cube", "swap"}, {"uniform", "swap"}, {"normal", "swap"}, {"overlapping", "none"}});
}

}  // namespace
}  // namespace gridlock
