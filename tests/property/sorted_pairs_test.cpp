// Pairs of points in the order of their cells: those of the definition, in its order, with any instructions; and of
// crowds of which one cell holds more than a kernel takes at once.

#include "grid/sorted_pairs.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <vector>

#include "gridlock/core/random.hpp"
#include "gridlock/grid/neighbour_search.hpp"

namespace gridlock {
namespace {

using Pairs = std::vector<AgentPair>;

Pairs pairs_by(AddPairsOfRows kernel, SortedRows const& rows, RowRange cell, std::vector<RowRange> const& ranges,
               Box const* box) {
  Pairs all;
  OnPairs const keep = [&](std::span<AgentPair const> pairs) { all.insert(all.end(), pairs.begin(), pairs.end()); };
  PairBuffer buffer(keep);
  kernel(rows, cell, ranges, box, buffer);
  buffer.flush();
  return all;
}

RC_GTEST_PROP(PairsOfRows, AreThoseOfTheDefinitionInItsOrderWithAnyInstructions, ()) {
  auto const count = *rc::gen::inRange<std::size_t>(1, 150);
  RandomStream random(*rc::gen::arbitrary<std::uint64_t>(), 0, 0, Purpose::start_position);
  auto const edge = rc::gen::element(Edge::wall, Edge::periodic);
  Box const box(2.0, 3.0, *edge, *edge);
  bool const has_images = *rc::gen::arbitrary<bool>();
  std::vector<double> x;
  std::vector<double> y;
  std::vector<std::uint32_t> index;
  for (std::size_t row = 0; row < count; ++row) {
    // Some at the very same place, some exactly at the cutoff.
    x.push_back(static_cast<double>(random.below(8)) / 4.0);
    y.push_back(random.below(2) == 0 ? static_cast<double>(random.below(12)) / 4.0 : 3.0 * random.uniform());
    index.push_back(static_cast<std::uint32_t>(random.below(1ULL << 32)));
  }
  std::size_t const first = random.below(count);
  RowRange const cell{first, first + random.below(std::min<std::size_t>(40, count - first) + 1)};
  std::vector<RowRange> ranges{{first, cell.end + random.below(count - cell.end + 1)}};
  while (ranges.size() < 1 + random.below(5)) {
    std::size_t const begin = random.below(count);
    ranges.push_back({begin, begin + random.below(count - begin + 1)});
  }
  SortedRows const rows{.x = x.data(), .y = y.data(), .index = index.data(), .size = count, .squared_cutoff = 0.25};
  Pairs expected;
  for (std::size_t row = cell.first; row < cell.end; ++row) {
    for (std::size_t k = 0; k < ranges.size(); ++k) {
      for (std::size_t other = k == 0 ? row + 1 : ranges[k].first; other < ranges[k].end; ++other) {
        Vector const p{x[row], y[row]};
        Vector const q{x[other], y[other]};
        Vector const separation = has_images ? box.displacement(p, q) : q - p;
        if (squared_length(separation) < 0.25) expected.push_back({index[row], index[other]});
      }
    }
  }
  RC_PRE(cell.first < cell.end);
  Box const* const images = has_images ? &box : nullptr;
  RC_ASSERT(pairs_by(add_pairs_of_rows_scalar, rows, cell, ranges, images) == expected);
  for (Target const target : available_targets()) {
    RC_ASSERT(pairs_by(add_pairs_of_rows_kernel(target), rows, cell, ranges, images) == expected);
  }
}

TEST(PairsOfRows, AreAllOfThemWhereACellHoldsMoreThanAKernelTakes) {
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    Box const box(1.25, 0.8, edge);
    constexpr std::size_t count = 3 * max_candidates;
    constexpr double cutoff = 0.01;
    std::vector<double> x;
    std::vector<double> y;
    RandomStream random(1, 0, 0, Purpose::start_position);
    for (std::size_t i = 0; i < count; ++i) {
      // Around a corner of four cells, and of a periodic box.
      x.push_back(0.004 * random.uniform() - (box.is_periodic() ? 0.002 : 0.0));
      y.push_back(0.5 + 0.004 * random.uniform());
    }
    NeighbourSearch const search(box, cutoff, x, y);
    std::vector<std::vector<bool>> seen(count);
    for (std::size_t i = 0; i < count; ++i) seen[i].resize(i);
    std::size_t pairs = 0;
    search.for_each_pair([&](std::size_t i, std::size_t j, Vector) {
      ASSERT_FALSE(seen[i][j]) << "the pair came twice";
      seen[i][j] = true;
      ++pairs;
    });
    EXPECT_EQ(pairs, count * (count - 1) / 2);
  }
}

}  // namespace
}  // namespace gridlock
