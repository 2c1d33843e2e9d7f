#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "gridlock/core/detail/thread_pool.hpp"
#include "gridlock/core/population.hpp"
#include "gridlock/grid/cell_layout.hpp"
#include "gridlock/grid/detail/cell_window.hpp"
#include "gridlock/grid/detail/stored_cells.hpp"

namespace gridlock {

/// All agents in the order of their cells, in a cell in the order of their Ids: a function of the state alone, whatever
/// the order of the rows was and however many threads sort.
///
///     rows()    │ 7 │ 2 │ 5 │ 0 │ 9 │ …      those of column c in row r are rows()[first_of(c, r)] … rows()[first_of(c + 1, r) − 1]
///     cells       0   0   2   2   3
///
/// Cells that follow one another in a row of cells are neighbours in memory: three ranges hold a 3×3 block. The agents
/// of a window alone have the order that they have among all.
class CellOrder {
 public:
  /// Sorts by counting, and returns the cells: where agents crowd those of `finer`, if it is given.
  /// Cost: O(agents + cells), about 10 ns an agent where the rows are nearly in order already.
  CellLayout sort(CellLayout const& layout, std::span<double const> x, std::span<double const> y,
                  std::span<Id const> ids, ThreadPool& thread_pool, std::optional<CellLayout> const& finer = {});
  /// The same for agents in a window of the cells, all of which or the occupied ones are stored.
  void sort_window(CellLayout const& layout, CellWindow const& window, StoredCells::Which stored,
                   std::span<double const> x, std::span<double const> y, std::span<Id const> ids,
                   ThreadPool& thread_pool);

  [[nodiscard]] std::span<std::uint32_t const> rows() const { return rows_; }
  [[nodiscard]] std::size_t first_of(int column, int row) const {
    return first_[cells_.place_of(numbers_.number_of(column, row))];
  }
  /// Rows of cells, of the window.
  [[nodiscard]] int cell_rows() const { return numbers_.rows(); }
  /// Calls visit(column, row, first, end) for every cell with agents in the first_row-th … last before the end_row-th
  /// of these rows of cells, in their order; its agents are rows()[first] … rows()[end − 1].
  template <class Visit>
  void for_each_cell(int first_row, int end_row, Visit visit) const {
    cells_.for_each_in_rows(numbers_.columns(), first_row, end_row, [&](int column, int row, std::size_t place) {
      std::size_t const first = first_[place];
      std::size_t const end = first_[place + 1];
      if (first < end) visit(numbers_.column_at(column), numbers_.row_at(row), first, end);
    });
  }

 private:
  struct Columns {
    std::span<double const> x;
    std::span<double const> y;
    std::span<Id const> ids;
  };
  /// Where agents are, among the cells of the window.
  [[nodiscard]] std::size_t number_of(CellLayout const& layout, Columns const& columns, std::size_t row) const {
    return numbers_.number_of(layout.column_of(columns.x[row]), layout.row_of(columns.y[row]));
  }
  void find_occupied(CellLayout const& layout, Columns const& columns, ThreadPool& thread_pool);
  /// The cells of all rows and, in first_, how many rows each has.
  void count(CellLayout const& layout, Columns const& columns, ThreadPool& thread_pool);
  [[nodiscard]] bool has_crowd() const;
  /// Puts all rows where they belong, when they are counted.
  void fill(std::span<Id const> ids, ThreadPool& thread_pool);
  /// The first of the stored cells that a part of the work sorts.
  [[nodiscard]] std::uint32_t first_cell(std::size_t part, ThreadPool const& thread_pool) const;

  struct RowRange {
    std::uint32_t min;  ///< of the places of cells in a range of rows
    std::uint32_t max;
  };

  template <class Visit>
  void for_each_row_in_cells(std::uint32_t first_cell, std::uint32_t end_cell, Visit visit) const;

  CellNumbers numbers_;
  StoredCells cells_;
  std::vector<std::uint32_t> cell_;  ///< of each row, its place among the stored ones
  std::vector<RowRange> ranges_;     ///< of cell_
  std::vector<std::uint32_t> rows_;
  std::vector<std::uint32_t> first_;  ///< one entry more than stored cells
};

}  // namespace gridlock
