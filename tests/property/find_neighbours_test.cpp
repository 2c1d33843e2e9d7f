// The search of synchronous models: the same rows whether eight candidates are looked at at a time or one, and those
// that the definition asks for; and the order of the rows that it relies on.

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <numeric>
#include <optional>
#include <tuple>
#include <vector>

#include "grid/find_neighbours_kernels.hpp"
#include "gridlock/core/detail/thread_pool.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/grid/detail/cell_list.hpp"

namespace gridlock {
namespace {

std::vector<std::uint32_t> found_by(FindNeighbours kernel, RowSearch const& search, std::vector<RowRange> const& ranges,
                                    std::size_t candidates) {
  std::vector<std::uint32_t> found(candidates + neighbour_slack);
  found.resize(kernel(search, ranges, found.data()));
  return found;
}

RC_GTEST_PROP(Neighbours, AreThoseOfTheDefinitionInTheOrderOfTheRangesOneOrEightAtATime, ()) {
  auto const count = *rc::gen::inRange<std::size_t>(1, 80);
  RandomStream random(*rc::gen::arbitrary<std::uint64_t>(), 0, 0, Purpose::start_position);
  auto const edge = rc::gen::element(Edge::wall, Edge::periodic);
  Box const box(2.0, 3.0, *edge, *edge);
  std::vector<double> x(count);
  std::vector<double> y(count);
  for (std::size_t row = 0; row < count; ++row) {
    // Some at the very same place, some exactly at the cutoff.
    x[row] = static_cast<double>(random.below(9)) / 4.0;
    y[row] = random.below(2) == 0 ? static_cast<double>(random.below(12)) / 4.0 : 3.0 * random.uniform();
  }
  std::vector<RowRange> ranges;
  std::size_t candidates = 0;
  for (std::size_t first = 0; first < count;) {
    std::size_t const end = std::min<std::size_t>(count, first + random.below(20));
    ranges.push_back({first, end});
    candidates += end - first;
    first = end + random.below(3);
  }
  std::size_t const self = random.below(count);
  RowSearch const search{.x = x.data(),
                         .y = y.data(),
                         .size = count,
                         .p = {x[self], y[self]},
                         .squared_cutoff = 0.25,
                         .left_out = self,
                         .box = *rc::gen::arbitrary<bool>() ? &box : nullptr};
  std::vector<std::uint32_t> expected;
  for (RowRange const& range : ranges) {
    for (std::size_t row = range.first; row < range.end; ++row) {
      Vector const q{x[row], y[row]};
      Vector const separation = search.box != nullptr ? box.displacement(search.p, q) : q - search.p;
      if (row != self && squared_length(separation) < 0.25) expected.push_back(static_cast<std::uint32_t>(row));
    }
  }
  RC_ASSERT(found_by(find_neighbours_scalar, search, ranges, candidates) == expected);
  RC_ASSERT(found_by(find_neighbours, search, ranges, candidates) == expected);
  for (Target const target : available_targets()) {
    RC_ASSERT(found_by(find_neighbours_kernel(target), search, ranges, candidates) == expected);
  }
}

RC_GTEST_PROP(CellList, IsThatOfTheCellsAndInACellThatOfTheIdsHoweverManyShareOne, ()) {
  auto const count = *rc::gen::inRange<std::size_t>(0, 400);
  auto const side = *rc::gen::inRange<std::uint64_t>(1, 7);  // one cell for all, or many
  RandomStream random(*rc::gen::arbitrary<std::uint64_t>(), 0, 0, Purpose::start_position);
  Box const box(1.25, 0.8, Edge::wall);
  CellLayout const layout(box, side, side);
  CellLayout const finer(box, 97, 113);  // words of 64 cells begin and end within rows
  std::vector<double> x(count);
  std::vector<double> y(count);
  std::vector<Id> ids(count);
  std::iota(ids.begin(), ids.end(), Id{0});
  for (std::size_t row = 0; row < count; ++row) {
    x[row] = random.below(3) == 0 ? random.uniform() : 0.5 + 0.01 * random.uniform();
    y[row] = random.uniform();
    // In order but for a few, or in no order at all.
    if (random.below(4) == 0 || side < 3) std::swap(ids[row], ids[random.below(count)]);
  }
  ThreadPool thread_pool(*rc::gen::element(1, 2, 5));
  CellList order;
  std::vector<std::optional<CellLayout>> const finer_ones{std::nullopt, finer};
  for (std::optional<CellLayout> const& wish : finer_ones) {
    order.sort(layout, x, y, ids, thread_pool, wish);
    CellLayout const& used = order.layout();
    RC_ASSERT(used == layout || (wish && used == finer));
    auto const cell_of = [&](std::uint32_t row) { return used.cell_of({x[row], y[row]}); };
    std::vector<std::uint32_t> expected(count);
    std::iota(expected.begin(), expected.end(), 0U);
    std::ranges::sort(expected, {}, [&](std::uint32_t row) { return std::tuple(cell_of(row), ids[row]); });
    RC_ASSERT(std::vector<std::uint32_t>(order.indices().begin(), order.indices().end()) == expected);
    // Stored or not, every cell knows where its rows begin, and those with rows are visited once, in their order.
    for (int cell = 0; cell <= used.count(); ++cell) {
      auto const first = std::ranges::lower_bound(expected, cell, {}, cell_of) - expected.begin();
      RC_ASSERT(order.first_of(cell % used.columns(), cell / used.columns()) == static_cast<std::size_t>(first));
    }
    std::size_t next = 0;
    order.for_each_cell(0, order.numbers().rows(), [&](int column, int row, RowRange rows) {
      RC_ASSERT(rows.first == next && rows.end > next);
      for (; next < rows.end; ++next) RC_ASSERT(cell_of(expected[next]) == row * used.columns() + column);
    });
    RC_ASSERT(next == count);
  }
}

RC_GTEST_PROP(CellList, OfPointsHasThemCellByCellInTheirOwnOrderWithTheirPlacesHoweverManyThreadsSort, ()) {
  auto const count = *rc::gen::inRange<std::size_t>(0, 400);
  auto const columns = *rc::gen::inRange<std::uint64_t>(1, 40);
  RandomStream random(*rc::gen::arbitrary<std::uint64_t>(), 0, 0, Purpose::start_position);
  Box const box(1.25, 0.8, Edge::wall);
  CellLayout const layout(box, columns, 16);  // cells that parts divide evenly, and that they do not
  Vector const origin{-3.0, 2.0};
  std::vector<double> xy;
  for (std::size_t i = 0; i < count; ++i) {
    xy.push_back(origin.x + (i % 3 == 0 ? 1.25 * random.uniform() : 0.5 + 0.01 * random.uniform()));
    xy.push_back(origin.y + 0.8 * random.uniform());
  }
  PointsInMemory const points{.x = xy.data(), .y = xy.data() + 1, .count = count, .stride = 2};
  auto const cell_of = [&](std::uint32_t i) { return layout.cell_of(Vector{xy[2 * i], xy[2 * i + 1]} - origin); };
  std::vector<std::uint32_t> expected(count);
  std::iota(expected.begin(), expected.end(), 0U);
  std::ranges::stable_sort(expected, {}, cell_of);
  for (std::uint64_t const threads : {1U, 2U, 5U}) {
    ThreadPool pool(threads);
    CellList const list(layout, origin, points, pool);
    RC_ASSERT(std::ranges::equal(list.indices(), expected));
    for (std::size_t row = 0; row < count; ++row) {
      RC_ASSERT(list.x()[row] == xy[2 * expected[row]]);
      RC_ASSERT(list.y()[row] == xy[2 * expected[row] + 1]);
    }
    for (int cell = 0; cell <= layout.count(); ++cell) {
      auto const first = std::ranges::lower_bound(expected, cell, {}, cell_of) - expected.begin();
      RC_ASSERT(list.first_of(static_cast<std::size_t>(cell)) == static_cast<std::size_t>(first));
    }
  }
}

}  // namespace
}  // namespace gridlock
