// How a box is divided among processes.

#include "gridlock/parallel/detail/domain.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <mutex>
#include <set>
#include <vector>

#include "gridlock/core/random.hpp"
#include "gridlock/grid/detail/stored_cells.hpp"
#include "thread_ranks.hpp"

namespace gridlock {
namespace {

using test::ThreadRanks;

struct Points {
  std::vector<double> x, y;
};

/// Points of which half crowd in a corner.
Points points_in(Box const& box, std::size_t count, std::uint64_t seed) {
  RandomStream random(seed, 0, 0, Purpose::start_position);
  Points points;
  for (std::size_t k = 0; k < count; ++k) {
    double const part = k % 2 == 0 ? 1.0 : 0.2;
    points.x.push_back(random.uniform() * box.width() * part);
    points.y.push_back(random.uniform() * box.height() * part);
  }
  return points;
}

/// The points of one of several processes.
Points part_of(Points const& all, Communicator const& here) {
  Points part;
  for (std::size_t k = here.rank(); k < all.x.size(); k += here.count()) {
    part.x.push_back(all.x[k]);
    part.y.push_back(all.y[k]);
  }
  return part;
}

struct Case {
  Box box;
  CellLayout cells;
  double cutoff;
};

std::vector<Case> cases() {
  std::vector<Case> all;
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    Box const box(3.0, 2.0, edge);
    for (double const cutoff : {0.05, 0.3, 1.1}) all.push_back({box, layout_for_cutoff(box, cutoff, 2000), cutoff});
  }
  return all;
}

TEST(Domain, GivesEachPointToOneProcessAndShowsItToAllWithPointsWithinTheCutoff) {
  for (Case const& of : cases()) {
    Points const points = points_in(of.box, 400, 7);
    for (std::size_t const count : {1U, 2U, 3U, 7U}) {
      std::mutex mutex;
      std::vector<std::set<std::size_t>> owners(points.x.size());
      std::vector<std::set<std::size_t>> seen_by(points.x.size());
      ThreadRanks(count).run([&](Communicator& here) {
        Points const own = part_of(points, here);
        Domain const domain = Domain::of_cells(here, of.cells, of.cutoff, own.x, own.y);
        std::scoped_lock const lock(mutex);
        for (std::size_t k = 0; k < points.x.size(); ++k) {
          Vector const p{points.x[k], points.y[k]};
          owners[k].insert(domain.owner_of(p));
          EXPECT_EQ(domain.is_own(p), domain.owner_of(p) == here.rank());
          if (domain.is_own(p)) {
            seen_by[k].insert(here.rank());
            domain.for_each_that_sees(p, [&](std::size_t process) { seen_by[k].insert(process); });
          }
        }
      });
      for (std::size_t k = 0; k < points.x.size(); ++k) {
        ASSERT_EQ(owners[k].size(), 1U) << "all processes name the same owner";
        for (std::size_t other = 0; other < points.x.size(); ++other) {
          Vector const between = of.box.displacement({points.x[k], points.y[k]}, {points.x[other], points.y[other]});
          if (squared_length(between) > of.cutoff * of.cutoff) continue;
          EXPECT_TRUE(seen_by[k].contains(*owners[other].begin())) << count << " processes, cutoff " << of.cutoff;
        }
      }
    }
  }
}

TEST(Domain, DividesPointsEvenly) {
  Box const box(3.0, 2.0, Edge::periodic);
  CellLayout const cells(box, 150, 100);
  Points const points = points_in(box, 20'000, 3);
  for (std::size_t const count : {2U, 5U, 8U}) {
    ThreadRanks(count).run([&](Communicator& here) {
      Points const own = part_of(points, here);
      Domain const domain = Domain::of_cells(here, cells, 0.02, own.x, own.y);
      std::size_t owned = 0;
      for (std::size_t k = 0; k < points.x.size(); ++k) {
        owned += domain.is_own({points.x[k], points.y[k]}) ? 1 : 0;
      }
      EXPECT_NEAR(static_cast<double>(owned * count) / static_cast<double>(points.x.size()), 1.0, 0.15);
    });
  }
}

TEST(Domain, GivesWholeTilesAndCountsTheirPoints) {
  Box const box(3.0, 2.0, Edge::wall);
  CellLayout const cells(box, 150, 100);
  Tiling const tiling(cells);
  Points const points = points_in(box, 3000, 5);
  for (std::size_t const count : {1U, 4U, 300U}) {
    std::mutex mutex;
    std::multiset<std::uint32_t> tiles;
    std::uint64_t counted = 0;
    ThreadRanks(count).run([&](Communicator& here) {
      Points const own = part_of(points, here);
      Domain const domain = Domain::of_tiles(here, cells, [&](auto visit) {
        for (std::size_t k = 0; k < own.x.size(); ++k) visit({own.x[k], own.y[k]});
      });
      std::uint64_t inside = 0;
      for (std::size_t k = 0; k < points.x.size(); ++k) inside += domain.is_own({points.x[k], points.y[k]}) ? 1 : 0;
      EXPECT_EQ(domain.points_of_own_tiles(), inside);
      std::scoped_lock const lock(mutex);
      counted += inside;
      domain.own_tiles().for_each_tile(
          [&](std::size_t column, std::size_t row) { tiles.insert(tiling.number_of(column, row)); });
    });
    EXPECT_EQ(counted, points.x.size());
    EXPECT_EQ(tiles.size(), tiling.tiles().size());
    EXPECT_EQ(std::set<std::uint32_t>(tiles.begin(), tiles.end()).size(), tiling.tiles().size());
  }
}

TEST(Domain, FindsACrowdHoweverTheCellsAreCut) {
  Box const box(3.0, 2.0, Edge::periodic);
  CellLayout const coarse(box, 30, 20);
  for (bool const do_crowd : {false, true}) {
    Points points = points_in(box, 300, 11);
    for (std::size_t k = 0; do_crowd && k < 100; ++k) {
      points.x[k] = 1.0 + 0.001 * static_cast<double>(k);
      points.y[k] = 1.0;
    }
    std::vector<std::uint64_t> points_of_cells(static_cast<std::size_t>(coarse.count()), 0);
    std::uint64_t pairs = 0;
    for (std::size_t k = 0; k < points.x.size(); ++k) {
      pairs += points_of_cells[static_cast<std::size_t>(coarse.cell_of({points.x[k], points.y[k]}))]++;
    }
    for (std::size_t const count : {1U, 3U, 6U}) {
      ThreadRanks(count).run([&](Communicator& here) {
        Points const own = part_of(points, here);
        // Other cells than those that are asked for.
        Domain const domain = Domain::of_cells(here, CellLayout(box, 37, 22), 0.05, own.x, own.y);
        EXPECT_EQ(is_crowd(domain, coarse, points.x, points.y, points.x.size()), is_crowd(pairs, points.x.size()));
      });
    }
    EXPECT_EQ(is_crowd(pairs, points.x.size()), do_crowd) << "or the test tells nothing";
  }
}

}  // namespace
}  // namespace gridlock
