// Random insertion on ranks, here threads: the sites of one process, to the bit.
#include "lattice/insertion_on_ranks.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "gridlock/core/random.hpp"
#include "lattice/random_insertion.hpp"
#include "thread_ranks.hpp"

namespace gridlock {
namespace {

/// The same of one process and of some ranks. Returns how many disks found a place.
std::uint64_t expect_insertion_of_one_process(Box const& box, std::vector<double> const& radii, std::uint64_t seed,
                                              std::vector<std::size_t> const& numbers_of_ranks) {
  RandomInsertion one(box, radii, seed);
  std::uint64_t const placed = one.place_all();
  for (std::size_t const count : numbers_of_ranks) {
    RowDivision const rows = RowDivision::even(radii.size(), count);
    std::vector<InsertedRows> of_ranks(count);
    test::ThreadRanks(count).run_on_all([&](Communicator& here) {
      auto const own = std::span(radii).subspan(rows.first(here.rank()), rows.rows_of(here.rank()));
      of_ranks[here.rank()] = insert_on_ranks(here, box, own, rows, seed);
    });
    for (std::size_t rank = 0; rank < count; ++rank) {
      std::string const what = std::to_string(radii.size()) + " disks, rank " + std::to_string(rank) + " of " +
                               std::to_string(count) + ", seed " + std::to_string(seed);
      InsertedRows const& own = of_ranks[rank];
      EXPECT_EQ(own.placed, placed) << what;
      EXPECT_NEAR(own.packing_fraction, one.packing_fraction(), 1e-12) << what;
      EXPECT_EQ(own.sites.size(), rows.rows_of(rank)) << what;
      std::size_t different = 0;
      for (std::size_t k = 0; k < own.sites.size(); ++k) {
        if (own.sites[k] != one.sites()[rows.first(rank) + k]) ++different;
      }
      EXPECT_EQ(different, 0U) << what;
    }
    if (::testing::Test::HasFailure()) break;
  }
  return placed;
}

/// Sizes in the ratios of the disks that cover so much of the box.
std::vector<double> radii_for(std::vector<double> ratios, double packing_fraction, Box const& box) {
  double squares = 0.0;
  for (double const ratio : ratios) squares += ratio * ratio;
  double const unit = std::sqrt(packing_fraction * box.area() / (std::numbers::pi * squares));
  for (double& ratio : ratios) ratio *= unit;
  return ratios;
}

enum class Sizes { equal, species, very_unequal, distribution };

std::vector<double> ratios_of(Sizes sizes, std::size_t count, RandomStream& random) {
  std::vector<double> ratios(count, 1.0);
  for (double& ratio : ratios) {
    if (sizes == Sizes::species && random.below(2) == 0) ratio = 1.4;
    if (sizes == Sizes::very_unequal && random.below(20) == 0) ratio = 10.0;
    if (sizes == Sizes::distribution) ratio = 0.5 + random.uniform();
  }
  return ratios;
}

TEST(InsertionOnRanks, HasTheSitesOfOneProcess) {
  for (std::uint64_t seed = 0; seed < 160; ++seed) {
    RandomStream random(seed, 0, 0, Purpose::start_velocity);
    auto const sizes = static_cast<Sizes>(random.below(4));
    std::size_t const count = std::vector<std::size_t>{1, 2, 10, 300, 300, 1500}[random.below(6)];
    Edge const edge = random.below(2) == 0 ? Edge::wall : Edge::periodic;
    std::vector<Box> const boxes{Box(1.0, 1.0, edge), Box(1.0, 8.0, edge), Box(8.0, 1.0, edge), Box(3.0, 2.0, edge)};
    Box const box = boxes[random.below(boxes.size())];
    // Few disks of one size may cover more, and no more of them than that find room in any time.
    double const most = count >= 300 && sizes == Sizes::equal ? 0.5 : 0.3;
    std::vector<double> const radii =
        radii_for(ratios_of(sizes, count, random), 0.05 + (most - 0.05) * random.uniform(), box);
    expect_insertion_of_one_process(box, radii, seed, {1, 2, 3 + random.below(7)});
    ASSERT_FALSE(HasFailure());
  }
}

TEST(InsertionOnRanks, HasTheSitesOfOneProcessForManyDisks) {
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
      RandomStream random(seed, 0, 0, Purpose::start_velocity);
      std::size_t const count = seed % 2 == 0 ? 6000 : 20'000;
      Box const box(1.0, seed < 2 ? 1.0 : 8.0, edge);
      std::vector<double> const radii =
          radii_for(ratios_of(static_cast<Sizes>(seed), count, random), seed == 0 ? 0.48 : 0.4, box);
      EXPECT_EQ(expect_insertion_of_one_process(box, radii, seed, {2, 5}), count);
    }
  }
}

TEST(InsertionOnRanks, ServesMoreRanksThanRowsOfCells) {
  // Two rows of cells across, and no more than that.
  Box const box(1.25, 0.8, Edge::periodic);
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    expect_insertion_of_one_process(box, radii_for(std::vector<double>(4, 1.0), 0.25, box), seed, {3, 9});
  }
}

TEST(InsertionOnRanks, GivesUpAtTheSameDisk) {
  std::uint64_t times = 0;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    RandomStream random(seed, 0, 0, Purpose::start_velocity);
    Box const box(1.25, 0.8, seed % 2 == 0 ? Edge::wall : Edge::periodic);
    std::size_t const count = std::vector<std::size_t>{7, 40, 300}[seed % 3];
    std::vector<double> const radii = radii_for(ratios_of(static_cast<Sizes>(seed / 3), count, random), 0.75, box);
    if (expect_insertion_of_one_process(box, radii, seed, {1, 2, 5}) < count) ++times;
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GE(times, 10U);
}

TEST(InsertionOnRanks, PlacesNothingWhereTheLargestDiskDoesNotFit) {
  Box const box(1.25, 0.8, Edge::wall);
  EXPECT_EQ(expect_insertion_of_one_process(box, {0.1, 0.1, 0.6, 0.1}, 1, {1, 2, 6}), 0U);
}

}  // namespace
}  // namespace gridlock
