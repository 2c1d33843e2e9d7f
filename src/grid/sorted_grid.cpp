#include "gridlock/grid/detail/sorted_grid.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "grid/candidate_pairs.hpp"
#include "grid/sorted_pairs.hpp"
#include "gridlock/core/detail/thread_pool.hpp"
#include "gridlock/grid/detail/cell_list.hpp"
#include "gridlock/grid/detail/find_neighbours.hpp"

namespace gridlock {

namespace {

/// Number of rows that are searched before the results are passed on.
constexpr std::size_t rows_at_once = 128;

constexpr std::size_t nobody = std::numeric_limits<std::size_t>::max();

/// Calls visit(rows) for the near rows of a block, some rows at a time.
template <class Visit>
void for_each_near(RowBlock const& block, RowSearch const& search, Visit const& visit) {
  std::array<std::uint32_t, rows_at_once + neighbour_slack> found;
  if (block.candidates <= rows_at_once) {
    std::size_t const count = find_neighbours(search, block.ranges(), found.data());
    visit(std::span<std::uint32_t const>(found).first(count));
    return;
  }
  for (RowRange const range : block.ranges()) {
    for (std::size_t row = range.first; row < range.end; row += rows_at_once) {
      RowRange const part{row, std::min(range.end, row + rows_at_once)};
      std::size_t const count = find_neighbours(search, {&part, 1}, found.data());
      visit(std::span<std::uint32_t const>(found).first(count));
    }
  }
}

PointsInMemory in_memory(std::span<double const> x, std::span<double const> y) {
  return {.x = x.data(), .y = y.data(), .count = x.size()};
}

CellList sorted(CellLayout const& layout, std::span<double const> x, std::span<double const> y) {
  ThreadPool alone(1);
  return CellList::of_crowd(layout, in_memory(x, y), alone);
}

}  // namespace

SortedGrid::SortedGrid(Box const& box, CellLayout const& layout, std::span<double const> x, std::span<double const> y)
    : box_(box), points_(std::make_unique<CellList>(sorted(layout, x, y))) {}
SortedGrid::SortedGrid(SortedGrid const& other)
    : box_(other.box_), points_(std::make_unique<CellList>(*other.points_)) {}
SortedGrid::SortedGrid(SortedGrid&& other) noexcept = default;
SortedGrid& SortedGrid::operator=(SortedGrid other) noexcept {
  box_ = other.box_;
  points_ = std::move(other.points_);
  return *this;
}
SortedGrid::~SortedGrid() = default;

std::size_t SortedGrid::move_all(std::span<double const> x, std::span<double const> y) {
  ThreadPool alone(1);
  return points_->move_crowd(in_memory(x, y), alone);
}

double SortedGrid::squared_limit(double cutoff) const {
  // A margin as in PackedGrid::local_limit(), for errors of images far outside a box, as a part of a cell.
  CellLayout const& layout = points_->layout();
  double const error = 2e-6 * std::max(layout.cell_width(), layout.cell_height());
  return 1.001 * cutoff * cutoff + 1001.0 * error * error;
}

void SortedGrid::find_candidates(Vector p, double cutoff, OnAgents const& on_agents) const {
  CellList const& points = *points_;
  CellLayout const& layout = points.layout();
  auto const blocks = points.blocks();
  p = layout.image_in_cell(p);
  RowBlock const block = blocks.around(layout.column_of(p.x), layout.row_of(p.y));
  RowSearch const search{.x = points.x(),
                         .y = points.y(),
                         .size = points.size(),
                         .p = p,
                         .squared_cutoff = squared_limit(cutoff),
                         .left_out = nobody,
                         .box = block.is_at_edge ? &box_ : nullptr};
  for_each_near(block, search, [&](std::span<std::uint32_t const> rows) {
    std::array<std::uint32_t, rows_at_once> agents;
    for (std::size_t k = 0; k < rows.size(); ++k) agents[k] = points.index(rows[k]);
    on_agents(std::span<std::uint32_t const>(agents).first(rows.size()));
  });
}

void SortedGrid::find_candidate_pairs(double cutoff, OnPairs const& on_pairs) const {
  PairBuffer buffer(on_pairs);
  add_pairs_of_cells(*points_, box_, squared_limit(cutoff), 0, points_->layout().rows(), buffer);
  buffer.flush();
}

}  // namespace gridlock
