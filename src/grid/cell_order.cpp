#include "gridlock/grid/detail/cell_order.hpp"

#include <algorithm>
#include <numeric>

namespace gridlock {

namespace {

constexpr std::size_t rows_per_range = 2048;

/// Parts of the cells that are sorted on their own; enough for any thread pool, and few enough that looking for the
/// rows of a part costs little.
std::size_t parts_for(ThreadPool const& thread_pool) { return thread_pool.size() == 1 ? 1 : 4 * thread_pool.size(); }

/// The rows of one cell. They are few and mostly in order.
void sort_by_id(std::span<std::uint32_t> rows, std::span<Id const> ids) {
  if (rows.size() > 32) {
    std::ranges::sort(rows, {}, [&](std::uint32_t row) { return ids[row]; });
    return;
  }
  for (std::size_t k = 1; k < rows.size(); ++k) {
    std::uint32_t const row = rows[k];
    Id const id = ids[row];
    std::size_t hole = k;
    for (; hole > 0 && ids[rows[hole - 1]] > id; --hole) rows[hole] = rows[hole - 1];
    rows[hole] = row;
  }
}

}  // namespace

template <class Visit>
void CellOrder::for_each_row_in_cells(std::uint32_t first_cell, std::uint32_t end_cell, Visit visit) const {
  for (std::size_t s = 0; s < ranges_.size(); ++s) {
    if (ranges_[s].max < first_cell || ranges_[s].min >= end_cell) continue;
    std::size_t const end = std::min(cell_.size(), (s + 1) * rows_per_range);
    for (std::size_t row = s * rows_per_range; row < end; ++row) {
      if (cell_[row] >= first_cell && cell_[row] < end_cell) visit(static_cast<std::uint32_t>(row), cell_[row]);
    }
  }
}

void CellOrder::find_occupied(CellLayout const& layout, Columns const& columns, ThreadPool& thread_pool) {
  std::size_t const agents = columns.ids.size();
  std::size_t const parts = parts_for(thread_pool);
  cells_.clear(numbers_.count(), StoredCells::Which::occupied);
  thread_pool.for_each(parts, [&](std::size_t part) {
    for (std::size_t row = part * agents / parts; row < (part + 1) * agents / parts; ++row) {
      cells_.add(number_of(layout, columns, row));
    }
  });
  cells_.find_places();
}

void CellOrder::count(CellLayout const& layout, Columns const& columns, ThreadPool& thread_pool) {
  std::size_t const agents = columns.ids.size();
  std::size_t const cells = cells_.count();
  std::size_t const parts = parts_for(thread_pool);
  cell_.resize(agents);
  ranges_.resize((agents + rows_per_range - 1) / rows_per_range);
  first_.resize(cells + 1);
  thread_pool.for_each(parts, [&](std::size_t part) {
    for (std::size_t s = part * ranges_.size() / parts; s < (part + 1) * ranges_.size() / parts; ++s) {
      RowRange range{.min = static_cast<std::uint32_t>(cells), .max = 0};
      for (std::size_t row = s * rows_per_range; row < std::min(agents, (s + 1) * rows_per_range); ++row) {
        auto const cell = static_cast<std::uint32_t>(cells_.place_of(number_of(layout, columns, row)));
        cell_[row] = cell;
        range.min = std::min(range.min, cell);
        range.max = std::max(range.max, cell);
      }
      ranges_[s] = range;
    }
  });
  // Every part counts its own cells and afterwards fills them, so that no two threads write to one place.
  thread_pool.for_each(parts, [&](std::size_t part) {
    std::uint32_t const first = first_cell(part, thread_pool);
    std::uint32_t const end = first_cell(part + 1, thread_pool);
    std::fill(first_.begin() + first, first_.begin() + end, 0U);
    for_each_row_in_cells(first, end, [&](std::uint32_t, std::uint32_t cell) { ++first_[cell]; });
  });
}

bool CellOrder::has_crowd() const {
  std::uint64_t pairs = 0;
  for (std::size_t cell = 0; cell < cells_.count(); ++cell) {
    std::uint64_t const agents = first_[cell];
    pairs += agents * (agents - 1) / 2;
  }
  return is_crowd(pairs, cell_.size());
}

std::uint32_t CellOrder::first_cell(std::size_t part, ThreadPool const& thread_pool) const {
  return static_cast<std::uint32_t>(part * cells_.count() / parts_for(thread_pool));
}

CellLayout CellOrder::sort(CellLayout const& layout, std::span<double const> x, std::span<double const> y,
                           std::span<Id const> ids, ThreadPool& thread_pool, std::optional<CellLayout> const& finer) {
  Columns const columns{x, y, ids};
  numbers_ = CellNumbers(layout);
  cells_.clear(numbers_.count(), StoredCells::Which::all);
  count(layout, columns, thread_pool);
  bool const is_finer = finer && has_crowd();
  if (is_finer) {
    numbers_ = CellNumbers(*finer);
    find_occupied(*finer, columns, thread_pool);
    count(*finer, columns, thread_pool);
  }
  fill(ids, thread_pool);
  return is_finer ? *finer : layout;
}

void CellOrder::sort_window(CellLayout const& layout, CellWindow const& window, StoredCells::Which stored,
                            std::span<double const> x, std::span<double const> y, std::span<Id const> ids,
                            ThreadPool& thread_pool) {
  Columns const columns{x, y, ids};
  numbers_ = CellNumbers(layout, window);
  if (stored == StoredCells::Which::all) {
    cells_.clear(numbers_.count(), StoredCells::Which::all);
  } else {
    find_occupied(layout, columns, thread_pool);
  }
  count(layout, columns, thread_pool);
  fill(ids, thread_pool);
}

void CellOrder::fill(std::span<Id const> ids, ThreadPool& thread_pool) {
  std::size_t const agents = ids.size();
  std::size_t const parts = parts_for(thread_pool);
  rows_.resize(agents);
  std::size_t const cells = cells_.count();
  std::exclusive_scan(first_.begin(), first_.end() - 1, first_.begin(), 0U);
  first_[cells] = static_cast<std::uint32_t>(agents);
  thread_pool.for_each(parts, [&](std::size_t part) {
    std::uint32_t const first = first_cell(part, thread_pool);
    std::uint32_t const end = first_cell(part + 1, thread_pool);
    // first_[cell] runs on to the end of its cell while it is filled, and is set back behind it.
    for_each_row_in_cells(first, end, [&](std::uint32_t row, std::uint32_t cell) { rows_[first_[cell]++] = row; });
  });
  std::shift_right(first_.begin(), first_.end() - 1, 1);
  first_[0] = 0;
  first_[cells] = static_cast<std::uint32_t>(agents);
  thread_pool.for_each(parts, [&](std::size_t part) {
    // Cells are short and seldom out of order: a pass over all rows, which knows nothing of cells, stumbles only there.
    Id last_id = 0;
    std::uint32_t last_cell = static_cast<std::uint32_t>(cells);
    for (std::size_t k = first_[first_cell(part, thread_pool)]; k < first_[first_cell(part + 1, thread_pool)]; ++k) {
      std::uint32_t const row = rows_[k];
      // Both sides are always worked out: a branch on the first alone would often be guessed wrongly.
      int const is_in_order = int{cell_[row] != last_cell} | int{ids[row] > last_id};
      last_id = ids[row];
      last_cell = cell_[row];
      if (is_in_order != 0) continue;
      std::size_t const end = first_[last_cell + 1];
      sort_by_id(std::span(rows_).subspan(first_[last_cell], end - first_[last_cell]), ids);
      k = end - 1;
    }
  });
}

}  // namespace gridlock
