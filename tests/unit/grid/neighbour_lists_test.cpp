#include "gridlock/grid/neighbour_lists.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "gridlock/grid/neighbour_search.hpp"

namespace gridlock {
namespace {

using PairSet = std::set<std::pair<std::uint32_t, std::uint32_t>>;

struct Points {
  std::vector<double> x;
  std::vector<double> y;
  [[nodiscard]] PointsInMemory view() const { return {.x = x.data(), .y = y.data(), .count = x.size()}; }
};

/// Some inside the box, some far outside.
Points scattered(std::size_t count, Box const& box, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> inside(0.0, 1.0);
  Points points;
  for (std::size_t i = 0; i < count; ++i) {
    double const images = i % 5 == 0 ? 3.0 : 0.0;
    points.x.push_back((inside(random) - images) * box.width());
    points.y.push_back((inside(random) + images) * box.height());
  }
  return points;
}

PairSet pairs_of(PointPairs const& found) {
  PairSet pairs;
  for (std::size_t k = 0; k < found.size(); ++k) {
    auto const [least, most] = std::minmax(found.first()[k], found.second()[k]);
    EXPECT_TRUE(pairs.emplace(least, most).second) << least << " and " << most << " are listed twice";
  }
  return pairs;
}

PairSet pairs_of(NeighbourLists const& lists) {
  PairSet pairs;
  for (std::uint32_t i = 0; i + 1 < lists.begin.size(); ++i) {
    for (std::uint64_t k = lists.begin[i]; k < lists.begin[i + 1]; ++k) pairs.emplace(i, lists.neighbours[k]);
  }
  EXPECT_EQ(pairs.size(), lists.neighbours.size());
  return pairs;
}

TEST(NeighbourLists, HaveThePairsOfTheSearchOnAnyNumberOfThreads) {
  for (Box const& box : {Box(1.0, 1.0, Edge::periodic), Box(3.0, 0.2, Edge::periodic), Box(1.0, 2.0, Edge::wall)}) {
    for (std::size_t const count : {0U, 1U, 2U, 30U, 1000U}) {
      for (double const share : {0.02, 0.1, 0.5}) {
        double const cutoff = share * std::min(box.width(), box.height());
        Points const points = scattered(count, box, count);
        PairSet expected;
        PairSet both_ways;
        NeighbourSearch(box, cutoff, points.x, points.y).for_each_pair([&](std::size_t i, std::size_t j, Vector) {
          expected.emplace(j, i);
          both_ways.emplace(i, j);
          both_ways.emplace(j, i);
        });
        PointPairs const one = find_pairs(box, cutoff, points.view());
        EXPECT_EQ(pairs_of(one), expected);
        EXPECT_EQ(pairs_of(find_neighbour_lists(box, cutoff, points.view(), 2)), both_ways);
        for (std::uint64_t const threads : {2U, 3U, 8U}) {
          EXPECT_EQ(find_pairs(box, cutoff, points.view(), threads).indices, one.indices);
        }
      }
    }
  }
}

TEST(NeighbourLists, OfPointsWithoutABoxAreThoseOfAWallFarAway) {
  Points points = scattered(500, Box(1.0, 1.0, Edge::wall), 4);
  PairSet const expected = pairs_of(find_pairs(Box(1.0, 1.0, Edge::wall), 0.1, points.view()));
  EXPECT_GT(expected.size(), 100U);
  EXPECT_EQ(pairs_of(find_pairs(0.1, points.view())), expected);
  EXPECT_EQ(find_neighbour_lists(0.1, points.view(), 3).neighbours.size(), 2 * expected.size());
}

TEST(NeighbourLists, ReadRowsOfATable) {
  std::vector<double> const table{0.1, 0.5, 0.15, 0.5, 0.9, 0.9};
  PointPairs const found =
      find_pairs(Box(1.0, 1.0, Edge::wall), 0.1, {.x = table.data(), .y = table.data() + 1, .count = 3, .stride = 2});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found.first()[0] + found.second()[0], 1U);
}

TEST(NeighbourLists, RefuseWhatCannotBeSearched) {
  Points points = scattered(10, Box(1.0, 1.0, Edge::wall), 1);
  Box const periodic(1.0, 1.0, Edge::periodic);
  EXPECT_THROW(find_pairs(periodic, 0.6, points.view()), Error);
  EXPECT_THROW(find_pairs(periodic, -1.0, points.view()), Error);
  EXPECT_THROW(find_pairs(0.0, points.view()), Error);
  points.y[7] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(find_pairs(periodic, 0.1, points.view()), Error);
  points.y[7] = 1e70;
  EXPECT_THROW(find_neighbour_lists(0.1, points.view()), Error);
}

struct DisksInMemory {
  Points centres;
  std::vector<double> radius;
};

/// One disk in ten is large, one in seven half as large as the others.
DisksInMemory scattered_disks(std::size_t count, Box const& box, double smallest, double ratio, std::uint64_t seed) {
  DisksInMemory disks{.centres = scattered(count, box, seed), .radius = {}};
  for (std::size_t i = 0; i < count; ++i) {
    disks.radius.push_back(smallest * (i % 10 == 3 ? ratio : i % 7 == 0 ? 0.5 : 1.0));
  }
  return disks;
}

PairSet all_pairs_of(Box const& box, DiskReach const& reach, DisksInMemory const& disks) {
  PairSet pairs;
  auto const at = [&](std::size_t i) { return Vector{disks.centres.x[i], disks.centres.y[i]}; };
  for (std::uint32_t i = 0; i < disks.radius.size(); ++i) {
    for (std::uint32_t j = i + 1; j < disks.radius.size(); ++j) {
      double const contact = reach.factor * (disks.radius[i] + disks.radius[j]) + reach.gap;
      if (squared_length(box.displacement(at(i), at(j))) < contact * contact) pairs.emplace(i, j);
    }
  }
  return pairs;
}

TEST(PairsOfDisks, AreThoseOfBruteForceForAnySizesOnAnyNumberOfThreads) {
  std::size_t pairs = 0;
  for (Box const& box : {Box(1.0, 1.0, Edge::periodic), Box(3.0, 0.9, Edge::periodic), Box(1.0, 2.0, Edge::wall)}) {
    for (std::size_t const count : {0U, 1U, 2U, 40U, 1000U}) {
      for (double const ratio : {1.0, 1.4, 3.0, 10.0, 50.0}) {
        SCOPED_TRACE(testing::Message() << box.width() << " × " << box.height() << ", " << count << ", 1:" << ratio);
        DisksInMemory const disks = scattered_disks(count, box, 0.2 / ratio / 2.0, ratio, count);
        for (DiskReach const& reach : {DiskReach{}, DiskReach{.factor = 1.7}, DiskReach{.factor = 0.5, .gap = 0.01}}) {
          PairSet const expected = all_pairs_of(box, reach, disks);
          PointPairs const found = find_pairs_of_disks(box, reach, disks.centres.view(), disks.radius);
          EXPECT_EQ(pairs_of(found), expected);
          pairs += expected.size();
          for (std::uint64_t const threads : {2U, 5U}) {
            PointPairs const more = find_pairs_of_disks(box, reach, disks.centres.view(), disks.radius, threads);
            EXPECT_TRUE(std::ranges::equal(more.indices, found.indices)) << threads << " threads";
          }
        }
      }
    }
  }
  EXPECT_GT(pairs, 100'000U);
}

TEST(PairsOfDisks, WhoseRimsTouchAreNone) {
  std::vector<double> const x{1.0, 3.0};
  std::vector<double> const y{1.0, 1.0};
  std::vector<double> const radius{1.5, 0.5};
  PointsInMemory const centres{.x = x.data(), .y = y.data(), .count = 2};
  Box const box(8.0, 8.0, Edge::periodic);
  EXPECT_EQ(find_pairs_of_disks(box, {}, centres, radius).size(), 0U);
  EXPECT_EQ(find_pairs_of_disks(box, {.gap = 1e-15}, centres, radius).size(), 1U);
  EXPECT_EQ(find_pairs_of_disks(box, {.factor = 1.0 + 1e-15}, centres, radius).size(), 1U);
  // A distance of half the box is allowed, and no more.
  EXPECT_EQ(find_pairs_of_disks(box, {.factor = 4.0 / 3.0}, centres, radius).size(), 1U);
  EXPECT_THROW((void)find_pairs_of_disks(box, {.factor = 1.34}, centres, radius), Error);
}

TEST(PairsOfDisks, NameTheDiskThatIsNowhere) {
  std::vector<double> x(2000, 0.5);
  std::vector<double> radius(2000, 0.001);
  for (std::size_t i = 0; i < 20; ++i) radius[i * 100] = 0.2;
  x[1234] = std::numeric_limits<double>::quiet_NaN();
  try {
    (void)find_pairs_of_disks(Box(1.0, 1.0, Edge::wall), {}, {.x = x.data(), .y = x.data(), .count = 2000}, radius);
    FAIL() << "no error";
  } catch (Error const& error) {
    EXPECT_NE(std::string(error.what()).find("1234"), std::string::npos) << error.what();
  }
}

TEST(PairsOfDisks, RefuseWhatIsNoDiskAndNoReach) {
  std::vector<double> const x{1.0, 3.0};
  PointsInMemory const centres{.x = x.data(), .y = x.data(), .count = 2};
  Box const box(8.0, 8.0, Edge::wall);
  double const nan = std::numeric_limits<double>::quiet_NaN();
  double const infinity = std::numeric_limits<double>::infinity();
  for (std::vector<double> const& radius : {std::vector{1.0}, std::vector{1.0, 0.0}, std::vector{1.0, -1.0},
                                            std::vector{nan, 1.0}, std::vector{infinity, 1.0}}) {
    EXPECT_THROW((void)find_pairs_of_disks(box, {}, centres, radius), Error);
  }
  std::vector<double> const radius{1.0, 1.0};
  for (DiskReach const& reach : {DiskReach{.factor = 0.0}, DiskReach{.factor = nan}, DiskReach{.gap = -0.1},
                                 DiskReach{.gap = nan}, DiskReach{.factor = infinity}}) {
    EXPECT_THROW((void)find_pairs_of_disks(box, reach, centres, radius), Error);
  }
}

}  // namespace
}  // namespace gridlock
