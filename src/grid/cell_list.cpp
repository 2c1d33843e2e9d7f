#include "gridlock/grid/detail/cell_list.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <limits>
#include <numeric>
#include <utility>

#include "grid/require.hpp"
#include "gridlock/core/detail/look_ahead.hpp"
#include "gridlock/core/detail/thread_pool.hpp"

namespace gridlock {

namespace {

std::size_t parts_for(ThreadPool const& pool) { return pool.size() == 1 ? 1 : 4 * pool.size(); }

/// Calls take(part, first, end) for ranges of `count`.
template <class Take>
void for_each_range(ThreadPool& pool, std::size_t count, Take take) {
  std::size_t const parts = parts_for(pool);
  pool.for_each(parts, [&](std::size_t part) { take(part, part * count / parts, (part + 1) * count / parts); });
}

Vector point(PointsInMemory const& points, std::size_t i) {
  return {points.x[i * points.stride], points.y[i * points.stride]};
}

/// Sorts the agents of one cell. They are few and mostly in order.
void sort_cell_by_ids(std::span<std::uint32_t> agents, std::span<std::uint64_t const> ids) {
  if (agents.size() > 32) {
    std::ranges::sort(agents, {}, [&](std::uint32_t agent) { return ids[agent]; });
    return;
  }
  for (std::size_t k = 1; k < agents.size(); ++k) {
    std::uint32_t const agent = agents[k];
    std::uint64_t const id = ids[agent];
    std::size_t hole = k;
    for (; hole > 0 && ids[agents[hole - 1]] > id; --hole) agents[hole] = agents[hole - 1];
    agents[hole] = agent;
  }
}

constexpr auto nothing_else = [](std::size_t, std::size_t) {};

}  // namespace

CellList::CellList(CellLayout const& layout, Vector origin, PointsInMemory const& points, ThreadPool& pool,
                   std::optional<CellLayout> const& finer)
    : x_(points.count), y_(points.count) {
  if (count(layout, CellNumbers(layout), StoredCells::Which::all, origin, points, pool) && finer) {
    count(*finer, CellNumbers(*finer), StoredCells::Which::occupied, origin, points, pool);
  }
  fill_with_copies(points, pool);
}

CellList CellList::of_crowd(CellLayout const& layout, PointsInMemory const& points, ThreadPool& pool) {
  CellList sorted;
  sorted.x_.resize(points.count);
  sorted.y_.resize(points.count);
  sorted.count(layout, CellNumbers(layout), StoredCells::Which::occupied, {}, points, pool);
  sorted.fill_with_copies(points, pool);
  return sorted;
}

void CellList::sort(CellLayout const& layout, std::span<double const> x, std::span<double const> y,
                    std::span<std::uint64_t const> ids, ThreadPool& pool, std::optional<CellLayout> const& finer) {
  PointsInMemory const agents{.x = x.data(), .y = y.data(), .count = ids.size()};
  if (count(layout, CellNumbers(layout), StoredCells::Which::all, {}, agents, pool) && finer) {
    count(*finer, CellNumbers(*finer), StoredCells::Which::occupied, {}, agents, pool);
  }
  fill(pool, nothing_else, ids);
}

void CellList::sort_window(CellLayout const& layout, CellWindow const& window, StoredCells::Which stored,
                           std::span<double const> x, std::span<double const> y, std::span<std::uint64_t const> ids,
                           ThreadPool& pool) {
  PointsInMemory const agents{.x = x.data(), .y = y.data(), .count = ids.size()};
  count(layout, CellNumbers(layout, window), stored, {}, agents, pool);
  fill(pool, nothing_else, ids);
}

bool CellList::count(CellLayout const& layout, CellNumbers const& numbers, StoredCells::Which stored, Vector origin,
                     PointsInMemory const& points, ThreadPool& pool) {
  layout_ = layout;
  numbers_ = numbers;
  cells_.clear(numbers.count(), stored);
  // What stays comes before the scratch: the system gives large memory back and forth otherwise.
  first_.reserve(cells_.count() + 1);
  index_.resize(points.count);
  find_cells(stored, origin, points, pool);
  first_.resize(cells_.count() + 1);
  deal_out(pool);
  first_[0] = 0;
  std::atomic<std::uint64_t> pairs = 0;
  pool.for_each(parts_.size(), [&](std::size_t part) { pairs += count_in(parts_[part]); });
  return is_crowd(pairs, points.count);
}

void CellList::find_cells(StoredCells::Which stored, Vector origin, PointsInMemory const& points, ThreadPool& pool) {
  bool const are_occupied = stored == StoredCells::Which::occupied;
  cell_of_.resize(points.count);
  std::atomic<bool> are_finite = true;
  for_each_range(pool, points.count, [&](std::size_t, std::size_t first, std::size_t end) {
    CellLayout const layout = layout_;
    CellNumbers const numbers = numbers_;
    for (std::size_t i = first; i < end; ++i) {
      Vector const p = point(points, i) - origin;
      if (!(p.x - p.x == 0.0) | !(p.y - p.y == 0.0)) {
        are_finite = false;
        return;
      }
      std::size_t const cell = numbers.number_of(layout.column_of(p.x), layout.row_of(p.y));
      if (are_occupied) cells_.add(cell);
      cell_of_[i] = static_cast<std::uint32_t>(cell);
    }
  });
  if (!are_finite) require_points_in_memory(points);
  if (!are_occupied) return;
  cells_.find_places();
  for_each_range(pool, points.count, [&](std::size_t, std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) cell_of_[i] = static_cast<std::uint32_t>(cells_.place_of(cell_of_[i]));
  });
}

/// Divides the cells into parts, and lists the agents of each part in their order. So no two threads write to the same
/// cell, and each thread writes to memory that is near together.
void CellList::deal_out(ThreadPool& pool) {
  std::size_t const agents = cell_of_.size();
  std::size_t const cells = cells_.count();
  std::size_t const parts = parts_for(pool);
  auto const shift = std::bit_width(cells / parts);  // a part has 2^shift cells: no division finds it
  parts_.resize(parts);
  for (std::size_t part = 0; part < parts; ++part) {
    parts_[part] = {std::min(cells, part << shift), std::min(cells, (part + 1) << shift), {0, agents}};
  }
  dealt_.resize(parts == 1 ? 0 : agents);
  if (parts == 1) return;
  // Agents that follow one another are often of one part, whose counter stays in a register.
  auto const for_each_counted = [&](std::size_t first, std::size_t end, std::vector<std::uint32_t>& counters,
                                    auto take) {
    std::size_t part = 0;
    std::uint32_t counter = counters[part];
    for (std::size_t i = first; i < end; ++i) {
      std::size_t const part_now = cell_of_[i] >> shift;
      if (part_now != part) counters[std::exchange(part, part_now)] = std::exchange(counter, counters[part_now]);
      take(i, counter++);
    }
    counters[part] = counter;
  };
  // Threads deal out ranges of the agents; `next` is where each range goes on in each part.
  std::vector<std::vector<std::uint32_t>> next(parts);
  for_each_range(pool, agents, [&](std::size_t range, std::size_t first, std::size_t end) {
    std::vector<std::uint32_t> counts(parts, 0);
    for_each_counted(first, end, counts, nothing_else);
    next[range] = std::move(counts);
  });
  std::uint32_t begin = 0;
  for (std::size_t part = 0; part < parts; ++part) {
    parts_[part].rows.first = begin;
    for (std::vector<std::uint32_t>& range : next) begin += std::exchange(range[part], begin);
    parts_[part].rows.end = begin;
  }
  for_each_range(pool, agents, [&](std::size_t range, std::size_t first, std::size_t end) {
    for_each_counted(first, end, next[range],
                     [&](std::size_t i, std::size_t place) { dealt_[place] = static_cast<std::uint32_t>(i); });
  });
}

template <class Visit>
void CellList::for_each_in(Part const& part, Visit visit) const {
  for (std::size_t k = part.rows.first; k < part.rows.end; ++k) visit(dealt_.empty() ? k : dealt_[k]);
}

/// Sets first_[cell + 1], for each cell of a part, to the first row of the cell: fill() increases it to the end, where
/// the next cell begins. Returns the number of pairs in the same cell.
std::uint64_t CellList::count_in(Part const& part) {
  std::uint32_t* const first = first_.data() + 1;
  std::fill(first + part.first_cell, first + part.end_cell, 0U);
  for_each_in(part, [&](std::size_t i) { ++first[cell_of_[i]]; });
  auto next = static_cast<std::uint32_t>(part.rows.first);
  std::uint64_t pairs = 0;
  for (std::size_t cell = part.first_cell; cell < part.end_cell; ++cell) {
    std::uint64_t const agents = std::exchange(first[cell], next);
    next += static_cast<std::uint32_t>(agents);
    pairs += agents * (agents - 1) / 2;
  }
  return pairs;
}

template <class Place>
void CellList::fill(ThreadPool& pool, Place place, std::span<std::uint64_t const> ids) {
  pool.for_each(parts_.size(), [&](std::size_t part) {
    std::uint32_t* const next = first_.data() + 1;
    for_each_in(parts_[part], [&](std::size_t i) {
      std::size_t const row = next[cell_of_[i]]++;
      index_[row] = static_cast<std::uint32_t>(i);
      place(row, i);
    });
    if (!ids.empty()) sort_by_ids(parts_[part], ids);
  });
}

void CellList::fill_with_copies(PointsInMemory const& points, ThreadPool& pool) {
  fill(pool, [&, layout = layout_](std::size_t row, std::size_t i) {
    Vector const p = layout.image_in_cell(point(points, i));
    x_[row] = p.x;
    y_[row] = p.y;
  });
  cell_of_ = {};
  dealt_ = {};
}

void CellList::sort_by_ids(Part const& part, std::span<std::uint64_t const> ids) {
  // Cells are short and seldom out of order: a pass over all rows, which knows nothing of cells, stumbles only there.
  std::uint64_t last_id = 0;
  auto last_cell = static_cast<std::uint32_t>(cells_.count());
  for (std::size_t row = part.rows.first; row < part.rows.end; ++row) {
    std::uint32_t const agent = index_[row];
    // Both sides are always worked out: a branch on the first alone would often be guessed wrongly.
    int const is_in_order = int{cell_of_[agent] != last_cell} | int{ids[agent] > last_id};
    last_id = ids[agent];
    last_cell = cell_of_[agent];
    if (is_in_order != 0) continue;
    // Another thread may still be writing where the first cell of this part begins.
    std::size_t const first = last_cell == part.first_cell ? part.rows.first : first_[last_cell];
    std::size_t const end = first_[last_cell + 1];
    sort_cell_by_ids(std::span(index_).subspan(first, end - first), ids);
    row = end - 1;
  }
}

std::size_t CellList::move_crowd(PointsInMemory const& points, ThreadPool& pool) {
  if (std::optional<std::size_t> const arrivals = move_few(points)) return *arrivals;
  cell_of_row_.clear();
  count(layout_, CellNumbers(layout_), StoredCells::Which::occupied, {}, points, pool);
  fill_with_copies(points, pool);
  return size();
}

inline void CellList::put(std::size_t row, std::uint32_t cell, std::uint32_t index, Vector p) {
  cell_of_row_[row] = cell;
  index_[row] = index;
  x_[row] = p.x;
  y_[row] = p.y;
}

/// Moves the points one by one, and returns the number that changed their cell, or nothing where it stops because these
/// are too many.
std::optional<std::size_t> CellList::move_few(PointsInMemory const& points) {
  constexpr std::size_t ahead = 16;
  CellLayout const layout = layout_;  // a copy, which stays in registers while coordinates are written
  find_cells_of_rows();
  std::size_t const max_arrivals = size() / 8;
  std::vector<Arrival> arrivals;
  std::size_t kept = 0;
  for (std::size_t row = 0; row < size(); ++row) {
    if (row + ahead < size()) {
      prefetch_near(points.x + index_[row + ahead] * points.stride);
      prefetch_near(points.y + index_[row + ahead] * points.stride);
    }
    std::uint32_t const index = index_[row];
    std::uint32_t const cell = cell_of_row_[row];
    Vector const p = point(points, index);
    auto const cell_now = static_cast<std::uint32_t>(layout.cell_of(p));
    if (cell_now != cell) [[unlikely]] {
      if (arrivals.size() == max_arrivals) return std::nullopt;
      arrivals.push_back({.cell = cell_now, .index = index});
      continue;
    }
    put(kept++, cell, index, layout.image_in_cell(p));
  }
  std::ranges::sort(arrivals, {}, [](Arrival const& a) { return std::pair(a.cell, a.index); });
  // From the last row on, so that every row is moved once.
  for (std::size_t left = arrivals.size(); left > 0; --left) {
    Arrival const& last = arrivals[left - 1];
    std::size_t const end = kept;
    while (kept > 0 && cell_of_row_[kept - 1] > last.cell) --kept;
    move_rows(kept, end, left);
    put(kept + left - 1, last.cell, last.index, layout.image_in_cell(point(points, last.index)));
  }
  find_cells_again();
  return arrivals.size();
}

/// Moves rows first … end − 1 up by `by` rows.
void CellList::move_rows(std::size_t first, std::size_t end, std::size_t by) {
  auto const move = [&](auto& rows) {
    std::copy_backward(rows.data() + first, rows.data() + end, rows.data() + end + by);
  };
  move(cell_of_row_);
  move(index_);
  move(x_);
  move(y_);
}

void CellList::find_cells_of_rows() {
  if (!cell_of_row_.empty()) return;
  cell_of_row_.resize(size());
  for_each_cell(0, layout_.rows(), [&](int column, int cell_row, RowRange rows) {
    auto const cell = static_cast<std::uint32_t>(cell_row * layout_.columns() + column);
    std::fill(cell_of_row_.data() + rows.first, cell_of_row_.data() + rows.end, cell);
  });
}

/// Finds the occupied cells and their first rows from the cells of the rows.
void CellList::find_cells_again() {
  cells_.clear(static_cast<std::size_t>(layout_.count()), StoredCells::Which::occupied);
  first_.resize(size() + 1);
  std::size_t count = 0;
  std::uint32_t before = std::numeric_limits<std::uint32_t>::max();
  for (std::size_t row = 0; row < size(); ++row) {
    std::uint32_t const cell = cell_of_row_[row];
    cells_.add_alone(cell);
    // No branch asks whether a cell ends here, which would be guessed wrongly: the next one overwrites.
    first_[count] = static_cast<std::uint32_t>(row);
    count += cell != before ? 1 : 0;
    before = cell;
  }
  cells_.find_places();
  first_.resize(count + 1);
  first_[count] = static_cast<std::uint32_t>(size());
}

std::vector<int> bands_of(CellList const& points, ThreadPool const& pool) {
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
