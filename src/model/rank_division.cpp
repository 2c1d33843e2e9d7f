#include "gridlock/model/detail/rank_division.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "core/sorted.hpp"
#include "grid/division.hpp"
#include "gridlock/grid/detail/stored_cells.hpp"
#include "gridlock/parallel/detail/collectives.hpp"

namespace gridlock {

namespace {

/// More than what rounds in distances and in cells.
double margin(double cells) { return cells * (1.0 + 1e-6) + 1e-6; }

bool share_an_index(int first, int end, int other_first, int other_end, int all) {
  for (int const shift : {-all, 0, all}) {
    if (std::max(first, other_first + shift) < std::min(end, other_end + shift)) return true;
  }
  return false;
}

}  // namespace

CellsOfStep cells_of_step(Box const& box, double cutoff, std::size_t agents) {
  // A power of two, so that the cells change seldom while agents come and go.
  std::size_t const bound = std::bit_ceil(std::max<std::size_t>(16, agents));
  CellLayout const layout = layout_for_cutoff(box, cutoff, bound);
  return {.layout = layout, .finer = layout_for_crowd(box, cutoff, bound, layout)};
}

Rim rim_of(CellLayout const& cells, double cutoff) {
  return {.columns = cutoff * cells.columns_per_length(), .rows = cutoff * cells.rows_per_length()};
}

RankDivision::RankDivision(CellLayout const& cells, std::vector<Tiling::Rectangle> rectangles, Rim const& rim,
                           std::size_t rank)
    : cells_(cells),
      rectangles_(std::move(rectangles)),
      margin_columns_(margin(rim.columns)),
      margin_rows_(margin(rim.rows)),
      own_(cells_of(rectangles_[rank], 0.0, 0.0)) {
  for (Tiling::Rectangle const& rectangle : rectangles_) {
    if (rectangle.tiles() == 0) {
      seen_.emplace_back();
    } else {
      seen_.push_back(
          {.columns = range_of(rectangle.first_column, rectangle.end_column, margin_columns_, cells_.columns()),
           .rows = range_of(rectangle.first_row, rectangle.end_row, margin_rows_, cells_.rows())});
    }
  }
  CellWindow const around = cells_of(rectangles_[rank], margin_columns_ + 1.0, margin_rows_ + 1.0);
  for (std::size_t other = 0; other < rectangles_.size(); ++other) {
    CellWindow const its = cells_of(rectangles_[other], 0.0, 0.0);
    if (other != rank && rectangles_[rank].tiles() > 0 && rectangles_[other].tiles() > 0 &&
        share_an_index(around.first_column, around.end_column, its.first_column, its.end_column, cells_.columns()) &&
        share_an_index(around.first_row, around.end_row, its.first_row, its.end_row, cells_.rows())) {
      neighbours_.push_back(other);
    }
  }
  find_inside();
  find_owners();
}

RankDivision::Range RankDivision::range_of(std::size_t first, std::size_t end, double margin, int all) const {
  auto const begin = static_cast<double>(first) - margin;
  double const length = static_cast<double>(end - first) + 2.0 * margin;
  if (!cells_.is_periodic() || length >= all) {
    // Between walls a rim may end outside, where nobody is.
    bool const has_all = cells_.is_periodic();
    return {.first = has_all ? -1.0 : begin, .length = has_all ? all + 2.0 : length, .all = 0.0};
  }
  return {.first = begin, .length = length, .all = static_cast<double>(all)};
}

/// The cells of a rectangle and more to each side; beyond the box where it goes on there.
CellWindow RankDivision::cells_of(Tiling::Rectangle const& rectangle, double more_columns, double more_rows) const {
  if (rectangle.tiles() == 0) return {};
  auto const columns = static_cast<int>(std::min(std::ceil(more_columns), static_cast<double>(cells_.columns())));
  auto const rows = static_cast<int>(std::min(std::ceil(more_rows), static_cast<double>(cells_.rows())));
  return within(cells_, {.first_column = static_cast<int>(rectangle.first_column) - columns,
                         .end_column = static_cast<int>(rectangle.end_column) + columns,
                         .first_row = static_cast<int>(rectangle.first_row) - rows,
                         .end_row = static_cast<int>(rectangle.end_row) + rows});
}

void RankDivision::find_inside() {
  constexpr double everywhere = std::numeric_limits<double>::infinity();
  // A rank that has a whole side shares it with nobody, and behind a wall there is nobody.
  auto const shrink = [&](int first, int end, int all, double margin, double& from, double& to) {
    bool const has_all = first == 0 && end == all;
    from = has_all || (first == 0 && !cells_.is_periodic()) ? -everywhere : first + margin;
    to = has_all || (end == all && !cells_.is_periodic()) ? everywhere : end - margin;
  };
  shrink(own_.first_column, own_.end_column, cells_.columns(), margin_columns_, inside_.first_column,
         inside_.end_column);
  shrink(own_.first_row, own_.end_row, cells_.rows(), margin_rows_, inside_.first_row, inside_.end_row);
}

void RankDivision::find_owners() {
  strip_of_row_.assign(static_cast<std::size_t>(cells_.rows()), 0);
  for (std::uint32_t rank = 0; rank < rectangles_.size(); ++rank) {
    Tiling::Rectangle const& rectangle = rectangles_[rank];
    if (rectangle.tiles() == 0) continue;
    if (rectangle.first_column == 0) {
      for (std::size_t row = rectangle.first_row; row < rectangle.end_row; ++row) {
        strip_of_row_[row] = static_cast<std::uint32_t>(rank_of_column_.size());
      }
      rank_of_column_.emplace_back();
    }
    rank_of_column_.back().resize(rectangle.end_column, rank);
  }
}

std::size_t RankDivision::owner_of_cell(int cell) const {
  auto const column = static_cast<std::size_t>(cell % cells_.columns());
  auto const row = static_cast<std::size_t>(cell / cells_.columns());
  return rank_of_column_[strip_of_row_[row]][column];
}

bool RankDivision::is_neighbour(std::size_t rank) const {
  return std::ranges::find(neighbours_, rank) != neighbours_.end();
}

CellWindow RankDivision::window_of(CellLayout const& layout) const {
  if (own_.first_column == own_.end_column || own_.first_row == own_.end_row) return {};
  // A rim is not wider than a cell of the layout, which may be cut elsewhere.
  auto const scaled = [](int first, int end, int all, int all_of_layout) {
    double const scale = static_cast<double>(all_of_layout) / all;
    return std::pair(static_cast<int>(std::floor(first * scale)) - 2, static_cast<int>(std::ceil(end * scale)) + 2);
  };
  auto const [first_column, end_column] =
      scaled(own_.first_column, own_.end_column, cells_.columns(), layout.columns());
  auto const [first_row, end_row] = scaled(own_.first_row, own_.end_row, cells_.rows(), layout.rows());
  return within(layout,
                {.first_column = first_column, .end_column = end_column, .first_row = first_row, .end_row = end_row});
}

bool RankDivision::owns_cell(CellLayout const& layout, int column, int row) const {
  auto const owns = [](int k, int all_of_layout, int first, int end, int all) {
    if (all == all_of_layout) return k >= first && k < end;
    double const scale = static_cast<double>(all) / all_of_layout;
    return k * scale > first + 1e-6 && (k + 1) * scale < end - 1e-6;
  };
  return owns(column, layout.columns(), own_.first_column, own_.end_column, cells_.columns()) &&
         owns(row, layout.rows(), own_.first_row, own_.end_row, cells_.rows());
}

namespace {

/// Cuts the cells by agents of which these are some: `add_up` makes counts those of all agents.
template <class AddUp>
std::vector<Tiling::Rectangle> divided(Box const& box, CellLayout const& cells, std::span<double const> x,
                                       std::span<double const> y, std::size_t ranks, AddUp add_up) {
  std::vector<std::uint64_t> agents_of_row(static_cast<std::size_t>(cells.rows()), 0);
  for (double const place : y) ++agents_of_row[static_cast<std::size_t>(cells.row_of(place))];
  add_up(agents_of_row);
  return divide(agents_of_row, box.height() / box.width(), ranks, [&](std::size_t first_row, std::size_t end_row) {
    std::vector<std::uint64_t> agents_of_column(static_cast<std::size_t>(cells.columns()), 0);
    for (std::size_t k = 0; k < x.size(); ++k) {
      auto const row = static_cast<std::size_t>(cells.row_of(y[k]));
      if (row >= first_row && row < end_row) ++agents_of_column[static_cast<std::size_t>(cells.column_of(x[k]))];
    }
    add_up(agents_of_column);
    return agents_of_column;
  });
}

}  // namespace

std::vector<Tiling::Rectangle> divide_among_ranks(Box const& box, CellLayout const& cells, std::span<double const> x,
                                                  std::span<double const> y, std::size_t ranks) {
  return divided(box, cells, x, y, ranks, [](std::span<std::uint64_t> /*counts*/) {});
}

std::vector<Tiling::Rectangle> divide_among_ranks(Communicator& ranks, Box const& box, CellLayout const& cells,
                                                  std::span<double const> x, std::span<double const> y) {
  return divided(box, cells, x, y, ranks.count(), [&](std::span<std::uint64_t> counts) { all_sum(ranks, counts); });
}

bool is_crowd(CellLayout const& layout, std::span<double const> x, std::span<double const> y) {
  std::vector<std::uint32_t> agents(static_cast<std::size_t>(layout.count()), 0);
  std::uint64_t pairs = 0;
  for (std::size_t k = 0; k < x.size(); ++k) pairs += agents[static_cast<std::size_t>(layout.cell_of({x[k], y[k]}))]++;
  return is_crowd(pairs, x.size());
}

void CellCounts::add_up(RankDivision const& division, CellLayout const& layout) {
  std::size_t number = 0;
  for (int row = 0; row < numbers_.rows(); ++row) {
    for (int column = 0; column < numbers_.columns(); ++column) {
      std::uint64_t const agents = agents_[number++];
      if (agents == 0) continue;
      int const column_of_box = numbers_.column_at(column);
      int const row_of_box = numbers_.row_at(row);
      if (division.owns_cell(layout, column_of_box, row_of_box)) {
        pairs_ += agents * (agents - 1) / 2;
      } else {
        shared_.push_back({.cell = static_cast<std::uint32_t>(row_of_box * layout.columns() + column_of_box),
                           .agents = static_cast<std::uint32_t>(agents)});
      }
    }
  }
}

std::uint64_t CellCounts::pairs_in(std::vector<SharedCell> cells) {
  std::ranges::sort(cells, {}, &SharedCell::cell);
  std::uint64_t pairs = 0;
  for (std::size_t k = 0; k < cells.size();) {
    std::uint64_t agents = 0;
    std::uint32_t const cell = cells[k].cell;
    for (; k < cells.size() && cells[k].cell == cell; ++k) agents += cells[k].agents;
    pairs += agents * (agents - 1) / 2;
  }
  return pairs;
}

IdSet::IdSet(std::vector<Id> ids) : ids_(std::move(ids)) {
  sort_and_drop_repeats(ids_);
  mask_ = std::bit_ceil(std::max<std::uint64_t>(64, 16 * ids_.size())) - 1;
  bits_.assign((mask_ + 1) / 64, 0);
  for (Id const id : ids_) bits_[(id & mask_) / 64] |= std::uint64_t{1} << (id & mask_) % 64;
}

bool IdSet::is_among(Id id) const { return std::ranges::binary_search(ids_, id); }

}  // namespace gridlock
