#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "grid/require.hpp"
#include "gridlock/core/detail/large_array.hpp"
#include "gridlock/core/detail/look_ahead.hpp"
#include "gridlock/core/detail/thread_pool.hpp"
#include "gridlock/grid/cell_layout.hpp"
#include "gridlock/grid/detail/find_neighbours.hpp"
#include "gridlock/grid/detail/stored_cells.hpp"
#include "gridlock/grid/neighbour_lists.hpp"

namespace gridlock {

/// The points in the order of their cells, in a cell in their own order.
class SortedPoints {
 public:
  /// The cells begin to count at `origin`. Where points crowd, they are those of `finer`, if it is given.
  /// Errors: Error for points that are not finite.
  SortedPoints(CellLayout const& layout, Vector origin, PointsInMemory const& points, ThreadPool& pool,
               std::optional<CellLayout> const& finer = {})
      : layout_(layout),
        first_(static_cast<std::size_t>(layout_.count()) +
               1),  // first: the system gives large memory back and forth otherwise
        index_(points.count),
        x_(points.count),
        y_(points.count) {
    cells_.clear(static_cast<std::size_t>(layout.count()), StoredCells::Which::all);
    if (!sort(origin, points, pool, finer.has_value()) && finer) sort_crowd(*finer, origin, points, pool);
  }
  /// Points that are known to crowd.
  static SortedPoints of_crowd(CellLayout const& layout, PointsInMemory const& points, ThreadPool& pool) {
    SortedPoints sorted(points.count);
    sorted.sort_crowd(layout, {}, points, pool);
    return sorted;
  }
  /// The same points, which crowd, where they are now, in the same cells. In a cell those that have been there stay in
  /// their order, before those that have come. Returns how many have come, or the number of all where so many have that
  /// all are sorted.
  /// Contract: the points are finite, and their cells begin to count at the origin.
  std::size_t move_crowd(PointsInMemory const& points, ThreadPool& pool) {
    if (std::optional<std::size_t> const arrivals = move_few(points)) return *arrivals;
    sort_crowd(layout_, {}, points, pool);
    return size();
  }

  [[nodiscard]] CellLayout const& layout() const { return layout_; }
  [[nodiscard]] std::size_t first_of(std::size_t cell) const { return first_[cells_.place_of(cell)]; }
  [[nodiscard]] std::size_t first_of(int column, int row) const {
    return first_of(static_cast<std::size_t>(row) * static_cast<std::size_t>(layout_.columns()) +
                    static_cast<std::size_t>(column));
  }
  /// Calls visit(column, row, its points) for every cell with points in rows of cells first … end − 1, in their order.
  template <class Visit>
  void for_each_cell(int first, int end, Visit visit) const {
    cells_.for_each_in_rows(layout_.columns(), first, end, [&](int column, int row, std::size_t place) {
      RowRange const points{first_[place], first_[place + 1]};
      if (points.first < points.end) visit(column, row, points);
    });
  }
  [[nodiscard]] std::size_t size() const { return index_.size(); }
  [[nodiscard]] std::uint32_t index(std::size_t row) const { return index_[row]; }
  [[nodiscard]] std::uint32_t const* indices() const { return index_.data(); }
  [[nodiscard]] double const* x() const { return x_.data(); }
  [[nodiscard]] double const* y() const { return y_.data(); }

 private:
  static Vector point(PointsInMemory const& points, std::size_t i) {
    return {points.x[i * points.stride], points.y[i * points.stride]};
  }

  explicit SortedPoints(std::size_t count) : index_(count), x_(count), y_(count) {}

  void sort_crowd(CellLayout const& layout, Vector origin, PointsInMemory const& points, ThreadPool& pool) {
    layout_ = layout;
    cell_of_row_.clear();
    cells_.clear(static_cast<std::size_t>(layout.count()), StoredCells::Which::occupied);
    pool.for_each(pool.size(), [&](std::size_t part) {
      for (std::size_t i = part * points.count / pool.size(); i < (part + 1) * points.count / pool.size(); ++i) {
        cells_.add(static_cast<std::size_t>(layout_.cell_of(point(points, i) - origin)));
      }
    });
    cells_.find_places();
    sort(origin, points, pool, false);
  }

  /// A point that has come to another cell.
  struct Arrival {
    std::uint32_t cell;
    std::uint32_t index;
  };

  /// Moves the points one by one where most stay in their cells, and returns how many do not; nothing where it stops
  /// because these are too many.
  std::optional<std::size_t> move_few(PointsInMemory const& points) {
    constexpr std::size_t ahead = 16;
    find_cells_of_rows();
    std::size_t const max_arrivals = size() / 8;
    std::vector<Arrival> arrivals;
    std::size_t kept = 0;
    for (std::size_t row = 0; row < size(); ++row) {
      if (row + ahead < size()) prefetch_point(points, index_[row + ahead]);
      std::uint32_t const index = index_[row];
      std::uint32_t const cell = cell_of_row_[row];
      Vector const p = point(points, index);
      auto const cell_now = static_cast<std::uint32_t>(layout_.cell_of(p));
      if (cell_now != cell) [[unlikely]] {
        if (arrivals.size() == max_arrivals) return std::nullopt;
        arrivals.push_back({.cell = cell_now, .index = index});
        continue;
      }
      put(kept++, cell, index, layout_.image_in_cell(p));
    }
    std::ranges::sort(arrivals, {}, [](Arrival const& a) { return std::pair(a.cell, a.index); });
    // From the last row on, so that every row is moved once.
    for (std::size_t left = arrivals.size(); left > 0; --left) {
      Arrival const& last = arrivals[left - 1];
      std::size_t const end = kept;
      while (kept > 0 && cell_of_row_[kept - 1] > last.cell) --kept;
      move_rows(kept, end, left);
      put(kept + left - 1, last.cell, last.index, layout_.image_in_cell(point(points, last.index)));
    }
    find_cells_again();
    return arrivals.size();
  }

  void put(std::size_t row, std::uint32_t cell, std::uint32_t index, Vector p) {
    cell_of_row_[row] = cell;
    index_[row] = index;
    x_[row] = p.x;
    y_[row] = p.y;
  }

  /// Rows first … end − 1 go `by` rows up.
  void move_rows(std::size_t first, std::size_t end, std::size_t by) {
    auto const move = [&](auto& rows) {
      std::copy_backward(rows.data() + first, rows.data() + end, rows.data() + end + by);
    };
    move(cell_of_row_);
    move(index_);
    move(x_);
    move(y_);
  }

  void find_cells_of_rows() {
    if (!cell_of_row_.empty()) return;
    cell_of_row_.resize(size());
    for_each_cell(0, layout_.rows(), [&](int column, int cell_row, RowRange rows) {
      auto const cell = static_cast<std::uint32_t>(cell_row * layout_.columns() + column);
      std::fill(cell_of_row_.data() + rows.first, cell_of_row_.data() + rows.end, cell);
    });
  }

  /// Which cells are occupied, and their first rows, from the cells of the rows.
  void find_cells_again() {
    cells_.clear(static_cast<std::size_t>(layout_.count()), StoredCells::Which::occupied);
    first_.resize(size() + 1);
    std::size_t count = 0;
    std::uint32_t before = std::numeric_limits<std::uint32_t>::max();
    for (std::size_t row = 0; row < size(); ++row) {
      std::uint32_t const cell = cell_of_row_[row];
      cells_.add_alone(cell);
      // Whether a cell ends here is as good as random: what is no first row is written over by the next one.
      first_[count] = static_cast<std::uint32_t>(row);
      count += cell != before ? 1 : 0;
      before = cell;
    }
    cells_.find_places();
    first_.resize(count + 1);
    first_[count] = static_cast<std::uint32_t>(size());
  }

  static void prefetch_point(PointsInMemory const& points, std::size_t i) {
    prefetch_near(points.x + i * points.stride);
    prefetch_near(points.y + i * points.stride);
  }

  /// False where it stops because the points crowd.
  bool sort(Vector origin, PointsInMemory const& points, ThreadPool& pool, bool stops_for_crowd) {
    // Every thread counts and places a range of the points; the second knows where those before it end in each cell.
    std::size_t const parts = pool.size();
    std::size_t const cells = cells_.count();
    first_.resize(cells + 1);
    auto const first_point = [&](std::size_t part) { return part * points.count / parts; };
    UninitializedArray<std::uint32_t> cell_of(points.count);
    std::vector<std::vector<std::uint32_t>> places(parts);
    std::atomic<bool> are_finite = true;
    pool.for_each(parts, [&](std::size_t part) {
      std::vector<std::uint32_t>& counts = places[part];
      counts.assign(cells, 0);
      for (std::size_t i = first_point(part); i < first_point(part + 1); ++i) {
        Vector const p = point(points, i) - origin;
        if (!(p.x - p.x == 0.0) | !(p.y - p.y == 0.0)) {
          are_finite = false;
          return;
        }
        auto const cell = static_cast<std::uint32_t>(cells_.place_of(static_cast<std::size_t>(layout_.cell_of(p))));
        cell_of[i] = cell;
        ++counts[cell];
      }
    });
    if (!are_finite) require_points_in_memory(points);
    std::uint32_t next = 0;
    std::uint64_t pairs_in_cells = 0;
    for (std::size_t cell = 0; cell < cells; ++cell) {
      first_[cell] = next;
      for (std::size_t part = 0; part < parts; ++part) next += std::exchange(places[part][cell], next);
      std::uint64_t const in_cell = next - first_[cell];
      pairs_in_cells += in_cell * (in_cell - 1) / 2;
    }
    first_[cells] = next;
    if (stops_for_crowd && is_crowd(pairs_in_cells, points.count)) return false;
    pool.for_each(parts, [&](std::size_t part) {
      std::vector<std::uint32_t>& place = places[part];
      for (std::size_t i = first_point(part); i < first_point(part + 1); ++i) {
        std::size_t const row = place[cell_of[i]]++;
        Vector const p = layout_.image_in_cell(point(points, i));
        index_[row] = static_cast<std::uint32_t>(i);
        x_[row] = p.x;
        y_[row] = p.y;
      }
    });
    return true;
  }

  CellLayout layout_;
  StoredCells cells_;
  std::vector<std::uint32_t> first_;  ///< of each stored cell, and one behind
  UninitializedArray<std::uint32_t> index_;
  UninitializedArray<double> x_;
  UninitializedArray<double> y_;
  UninitializedArray<std::uint32_t> cell_of_row_;  ///< of points that have been moved, otherwise empty
};

/// Sorts the points into cells with sides of at least `cutoff`. Where the points crowd in a part of the box, the cells
/// are as small as that allows, and only occupied ones are stored.
inline SortedPoints sorted_for_cutoff(Box const& box, Vector origin, double cutoff, PointsInMemory const& points,
                                      ThreadPool& pool) {
  CellLayout const layout = layout_for_cutoff(box, cutoff, points.count);
  return {layout, origin, points, pool, layout_for_crowd(box, cutoff, points.count, layout)};
}

/// Bands of whole rows of cells with about as many points each. How many there are changes nothing but who does what.
inline std::vector<int> bands_of(SortedPoints const& points, ThreadPool const& pool) {
  std::size_t const count = pool.size() == 1 ? 1 : 8 * pool.size();
  CellLayout const& layout = points.layout();
  auto const columns = static_cast<std::size_t>(layout.columns());
  std::size_t const all = points.first_of(columns * static_cast<std::size_t>(layout.rows()));
  std::vector<int> ends{0};
  for (int row = 1; row <= layout.rows(); ++row) {
    bool const is_full = points.first_of(static_cast<std::size_t>(row) * columns) * count >= all * ends.size();
    if (is_full || row == layout.rows()) ends.push_back(row);
  }
  return ends;
}

}  // namespace gridlock
