#include "gridlock/parallel/detail/domain.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "grid/division.hpp"
#include "gridlock/core/detail/message.hpp"
#include "gridlock/grid/detail/stored_cells.hpp"

namespace gridlock {

namespace {

/// Returns a number of cells with a margin above the rounding of distances and cells.
double with_margin(double cells) { return cells * (1.0 + 1e-6) + 1e-6; }

bool is_empty(CellWindow const& window) {
  return window.first_column == window.end_column || window.first_row == window.end_row;
}

/// Cuts cells into rectangles with about equal numbers of points of all processes.
std::vector<CellWindow> cut(Communicator& processes, CellLayout const& cells, std::span<double const> x,
                            std::span<double const> y) {
  std::vector<std::uint64_t> points_of_rows(static_cast<std::size_t>(cells.rows()), 0);
  for (double const place : y) ++points_of_rows[static_cast<std::size_t>(cells.row_of(place))];
  all_sum(processes, points_of_rows);
  double const height = cells.rows() * cells.cell_height();
  double const width = cells.columns() * cells.cell_width();
  auto const points_of_columns = [&](std::size_t first_row, std::size_t end_row) {
    std::vector<std::uint64_t> points(static_cast<std::size_t>(cells.columns()), 0);
    for (std::size_t k = 0; k < x.size(); ++k) {
      auto const row = static_cast<std::size_t>(cells.row_of(y[k]));
      if (row >= first_row && row < end_row) ++points[static_cast<std::size_t>(cells.column_of(x[k]))];
    }
    all_sum(processes, points);
    return points;
  };
  std::vector<CellWindow> windows;
  for (Tiling::Rectangle const& part : divide(points_of_rows, height / width, processes.count(), points_of_columns)) {
    windows.push_back({.first_column = static_cast<int>(part.first_column),
                       .end_column = static_cast<int>(part.end_column),
                       .first_row = static_cast<int>(part.first_row),
                       .end_row = static_cast<int>(part.end_row)});
  }
  return windows;
}

bool share_an_index(int first, int end, int other_first, int other_end, int all) {
  for (int const shift : {-all, 0, all}) {
    if (std::max(first, other_first + shift) < std::min(end, other_end + shift)) return true;
  }
  return false;
}

}  // namespace

Domain Domain::of_cells(Communicator& processes, CellLayout const& cells, double cutoff, std::span<double const> x,
                        std::span<double const> y) {
  Rim const rim{.columns = cutoff * cells.columns_per_length(), .rows = cutoff * cells.rows_per_length()};
  return {processes, cells, cut(processes, cells, x, y), rim};
}

Domain Domain::of_whole_tiles(Communicator& processes, CellLayout const& cells, Tiling const& tiling,
                              std::span<std::uint64_t const> points_of_tiles) {
  std::vector<Tiling::Rectangle> const tiles = divide_tiles(tiling, points_of_tiles, processes.count());
  std::vector<CellWindow> windows;
  for (Tiling::Rectangle const& of_process : tiles) windows.push_back(window_around(cells, tiling, of_process, 0));
  Domain domain(processes, cells, std::move(windows), {.columns = 1.0, .rows = 1.0});
  domain.own_tiles_ = tiles[processes.rank()];
  domain.own_tiles_.for_each_tile([&](std::size_t column, std::size_t row) {
    domain.points_of_own_tiles_ += points_of_tiles[tiling.number_of(column, row)];
  });
  return domain;
}

Domain::Domain(Communicator& processes, CellLayout const& cells, std::vector<CellWindow> rectangles, Rim const& rim)
    : processes_(&processes),
      cells_(cells),
      rectangles_(std::move(rectangles)),
      rim_{.columns = with_margin(rim.columns), .rows = with_margin(rim.rows)},
      own_(rectangles_[processes.rank()]) {
  for (CellWindow const& rectangle : rectangles_) {
    if (is_empty(rectangle)) {
      seen_.emplace_back();
    } else {
      seen_.push_back(
          {.columns = range_of(rectangle.first_column, rectangle.end_column, rim_.columns, cells_.columns(),
                               cells_.is_periodic_x()),
           .rows = range_of(rectangle.first_row, rectangle.end_row, rim_.rows, cells_.rows(), cells_.is_periodic_y())});
    }
  }
  find_neighbours();
  find_inside();
  find_owners();
}

Domain::Range Domain::range_of(int first, int end, double margin, int all, bool is_periodic) {
  double const begin = first - margin;
  double const length = end - first + 2.0 * margin;
  if (!is_periodic || length >= all) {
    // Between walls a rim may end outside the box, where there are no points.
    return {.first = is_periodic ? -1.0 : begin, .length = is_periodic ? all + 2.0 : length, .all = 0.0};
  }
  return {.first = begin, .length = length, .all = static_cast<double>(all)};
}

/// Returns the cells of a rectangle and further ones on each side, beyond the edges in a periodic box.
CellWindow Domain::around(CellWindow const& rectangle, int columns, int rows) const {
  if (is_empty(rectangle)) return {};
  return within(cells_, {.first_column = rectangle.first_column - columns,
                         .end_column = rectangle.end_column + columns,
                         .first_row = rectangle.first_row - rows,
                         .end_row = rectangle.end_row + rows});
}

CellWindow Domain::window(std::size_t process, int margin) const {
  return around(rectangles_[process], margin, margin);
}

void Domain::find_neighbours() {
  auto const cells_within = [](double more, int all) {
    return static_cast<int>(std::min(std::ceil(more + 1.0), static_cast<double>(all)));
  };
  CellWindow const near =
      around(own_, cells_within(rim_.columns, cells_.columns()), cells_within(rim_.rows, cells_.rows()));
  for (std::size_t process = 0; process < rectangles_.size(); ++process) {
    CellWindow const& its = rectangles_[process];
    if (process != processes_->rank() && !is_empty(near) && !is_empty(its) &&
        share_an_index(near.first_column, near.end_column, its.first_column, its.end_column, cells_.columns()) &&
        share_an_index(near.first_row, near.end_row, its.first_row, its.end_row, cells_.rows())) {
      neighbours_.push_back(process);
    }
  }
}

void Domain::find_inside() {
  constexpr double everywhere = std::numeric_limits<double>::infinity();
  // A process with a whole side shares it with no other, and there are no points behind a wall.
  auto const shrink = [](int first, int end, int all, bool is_periodic, double margin, double& from, double& to) {
    bool const has_all = first == 0 && end == all;
    from = has_all || (first == 0 && !is_periodic) ? -everywhere : first + margin;
    to = has_all || (end == all && !is_periodic) ? everywhere : end - margin;
  };
  shrink(own_.first_column, own_.end_column, cells_.columns(), cells_.is_periodic_x(), rim_.columns,
         inside_.first_column, inside_.end_column);
  shrink(own_.first_row, own_.end_row, cells_.rows(), cells_.is_periodic_y(), rim_.rows, inside_.first_row,
         inside_.end_row);
}

void Domain::find_owners() {
  strip_of_row_.assign(static_cast<std::size_t>(cells_.rows()), 0);
  for (std::uint32_t process = 0; process < rectangles_.size(); ++process) {
    CellWindow const& rectangle = rectangles_[process];
    if (is_empty(rectangle)) continue;
    if (rectangle.first_column == 0) {
      for (int row = rectangle.first_row; row < rectangle.end_row; ++row) {
        strip_of_row_[static_cast<std::size_t>(row)] = static_cast<std::uint32_t>(owner_of_column_.size());
      }
      owner_of_column_.emplace_back();
    }
    owner_of_column_.back().resize(static_cast<std::size_t>(rectangle.end_column), process);
  }
}

std::size_t Domain::owner_of_cell(int cell) const {
  auto const column = static_cast<std::size_t>(cell % cells_.columns());
  auto const row = static_cast<std::size_t>(cell / cells_.columns());
  return owner_of_column_[strip_of_row_[row]][column];
}

bool Domain::is_neighbour(std::size_t process) const {
  return std::ranges::find(neighbours_, process) != neighbours_.end();
}

CellWindow Domain::window_in(CellLayout const& layout) const {
  if (is_empty(own_)) return {};
  // A rim is at most a cell wide, in a layout whose cells may have other borders.
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

bool Domain::owns_cell(CellLayout const& layout, int column, int row) const {
  auto const owns = [](int k, int all_of_layout, int first, int end, int all) {
    if (all == all_of_layout) return k >= first && k < end;
    double const scale = static_cast<double>(all) / all_of_layout;
    return k * scale > first + 1e-6 && (k + 1) * scale < end - 1e-6;
  };
  return owns(column, layout.columns(), own_.first_column, own_.end_column, cells_.columns()) &&
         owns(row, layout.rows(), own_.first_row, own_.end_row, cells_.rows());
}

namespace {

/// A cell that several processes may share, and the number of points that one process has in it.
struct SharedCell {
  std::uint32_t cell;
  std::uint32_t points;
};

std::uint64_t pairs_of(std::uint64_t points) { return points * (points - 1) / 2; }

/// Returns the number of pairs in the same cell, for cells that processes share.
std::uint64_t pairs_in(std::vector<SharedCell> cells) {
  std::ranges::sort(cells, {}, &SharedCell::cell);
  std::uint64_t pairs = 0;
  for (std::size_t k = 0; k < cells.size();) {
    std::uint64_t points = 0;
    std::uint32_t const cell = cells[k].cell;
    for (; k < cells.size() && cells[k].cell == cell; ++k) points += cells[k].points;
    pairs += pairs_of(points);
  }
  return pairs;
}

}  // namespace

bool is_crowd(Domain const& domain, CellLayout const& layout, std::span<double const> x, std::span<double const> y,
              std::size_t points) {
  CellNumbers const numbers(layout, domain.window_in(layout));
  std::vector<std::uint32_t> points_of_cells(numbers.count(), 0);
  for (std::size_t k = 0; k < x.size(); ++k) {
    if (!domain.is_own({x[k], y[k]})) continue;
    ++points_of_cells[numbers.number_of(layout.column_of(x[k]), layout.row_of(y[k]))];
  }
  std::uint64_t own_pairs = 0;
  std::vector<SharedCell> own_shared;
  std::size_t number = 0;
  for (int row = 0; row < numbers.rows(); ++row) {
    for (int column = 0; column < numbers.columns(); ++column) {
      std::uint32_t const own = points_of_cells[number++];
      if (own == 0) continue;
      int const column_of_box = numbers.column_at(column);
      int const row_of_box = numbers.row_at(row);
      if (domain.owns_cell(layout, column_of_box, row_of_box)) {
        own_pairs += pairs_of(own);
      } else {
        own_shared.push_back(
            {.cell = static_cast<std::uint32_t>(row_of_box * layout.columns() + column_of_box), .points = own});
      }
    }
  }
  MessageWriter own;
  own.add(own_pairs);
  own.add_all(std::span<SharedCell const>(own_shared));
  std::uint64_t pairs = 0;
  std::vector<SharedCell> shared;
  for (Message const& bytes : all_gather(domain.processes(), own.take())) {
    MessageReader message(bytes);
    pairs += message.next<std::uint64_t>();
    std::ranges::copy(message.rest<SharedCell>(), std::back_inserter(shared));
  }
  return is_crowd(pairs + pairs_in(std::move(shared)), points);
}

}  // namespace gridlock
