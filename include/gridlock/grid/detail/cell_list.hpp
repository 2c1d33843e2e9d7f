#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "gridlock/core/detail/large_array.hpp"
#include "gridlock/grid/cell_layout.hpp"
#include "gridlock/grid/detail/cell_window.hpp"
#include "gridlock/grid/detail/find_neighbours.hpp"
#include "gridlock/grid/detail/row_block.hpp"
#include "gridlock/grid/detail/stored_cells.hpp"
#include "gridlock/grid/neighbour_lists.hpp"

namespace gridlock {

class ThreadPool;

/// Sorts agents or points by their cells; in a cell agents are in the order of their Ids, points in their own. The
/// order is a function of the state alone, whatever the number of threads.
///
///     row         0   1   2   3   4   …      the rows of the cell in column c and row r:
///     index()   │ 7 │ 2 │ 5 │ 0 │ 9 │ …      first_of(c, r) … first_of(c + 1, r) − 1
///     cell        0   0   2   2   3
///
/// Cells that follow one another in a row of cells are neighbours in memory: three ranges hold a 3×3 block.
///
/// Memory: 4 bytes a stored cell; 8 an agent, 12 with several threads; 20 a point, 24 after move_crowd().
class CellList {
 public:
  CellList() = default;
  /// Sorts points, and copies their coordinates. The cells begin at `origin`; they are those of `finer`, if it is given
  /// and the points crowd, else of `layout`. Errors: Error for points that are not finite.
  CellList(CellLayout const& layout, Vector origin, PointsInMemory const& points, ThreadPool& pool,
           std::optional<CellLayout> const& finer = {});
  /// Sorts points that crowd, and stores the occupied cells only. Errors: Error for points that are not finite.
  static CellList of_crowd(CellLayout const& layout, PointsInMemory const& points, ThreadPool& pool);
  /// Sorts the points of of_crowd() again after they have moved, into the same cells. In a cell those that stayed keep
  /// their order, before those that came. Returns the number that changed their cell, or the number of all where these
  /// are so many that all are sorted.
  /// Contract: the points are finite.
  std::size_t move_crowd(PointsInMemory const& points, ThreadPool& pool);

  /// Sorts agents into the cells of `finer`, if it is given and the agents crowd, else of `layout`.
  /// Errors: Error for agents that are not at finite places.
  /// Cost: O(agents + cells), about 10 ns an agent where the agents are nearly in order already.
  void sort(CellLayout const& layout, std::span<double const> x, std::span<double const> y,
            std::span<std::uint64_t const> ids, ThreadPool& pool, std::optional<CellLayout> const& finer = {});
  /// Sorts agents in a window of the cells, of which all or the occupied ones are stored. The agents of a window have
  /// the order that they have among all.
  void sort_window(CellLayout const& layout, CellWindow const& window, StoredCells::Which stored,
                   std::span<double const> x, std::span<double const> y, std::span<std::uint64_t const> ids,
                   ThreadPool& pool);

  [[nodiscard]] CellLayout const& layout() const { return layout_; }
  [[nodiscard]] std::size_t size() const { return index_.size(); }
  /// Returns the index that the agent or point in a row had before it was sorted.
  [[nodiscard]] std::uint32_t index(std::size_t row) const { return index_[row]; }
  [[nodiscard]] std::span<std::uint32_t const> indices() const { return {index_.data(), index_.size()}; }
  /// The coordinates of points, row by row: of the images in their cells.
  [[nodiscard]] double const* x() const { return x_.data(); }
  [[nodiscard]] double const* y() const { return y_.data(); }

  [[nodiscard]] std::size_t first_of(std::size_t cell) const { return first_[cells_.place_of(cell)]; }
  [[nodiscard]] std::size_t first_of(int column, int row) const { return first_of(numbers_.number_of(column, row)); }
  /// Returns the blocks around cells. Contract: the list is of points, so that its cells are those of the whole box.
  [[nodiscard]] auto blocks() const {
    return RowBlocks(layout_, [this, columns = static_cast<std::size_t>(layout_.columns())](int column, int row) {
      return first_of(static_cast<std::size_t>(row) * columns + static_cast<std::size_t>(column));
    });
  }
  /// Returns the numbers of the cells in the window, or in the whole box.
  [[nodiscard]] CellNumbers const& numbers() const { return numbers_; }
  /// Calls visit(column, row, rows of the list) for every occupied cell in rows of cells first … end − 1, in their
  /// order; columns and rows of cells are counted in the window.
  template <class Visit>
  void for_each_cell(int first, int end, Visit visit) const {
    cells_.for_each_in_rows(numbers_.columns(), first, end, [&](int column, int row, std::size_t place) {
      RowRange const rows{first_[place], first_[place + 1]};
      if (rows.first < rows.end) visit(column, row, rows);
    });
  }

 private:
  /// Stored cells first_cell … end_cell − 1, which one thread sorts, and the rows that their agents get.
  struct Part {
    std::size_t first_cell, end_cell;
    RowRange rows;
  };

  /// Finds the cells of points, and the first row of each cell. Returns whether the points crowd.
  bool count(CellLayout const& layout, CellNumbers const& numbers, StoredCells::Which stored, Vector origin,
             PointsInMemory const& points, ThreadPool& pool);
  void find_cells(StoredCells::Which stored, Vector origin, PointsInMemory const& points, ThreadPool& pool);
  void deal_out(ThreadPool& pool);
  std::uint64_t count_in(Part const& part);
  template <class Visit>
  void for_each_in(Part const& part, Visit visit) const;
  /// Gives the counted agents their rows, in a cell in the order of the Ids, if there are any, and calls place(row,
  /// index) for each before that.
  template <class Place>
  void fill(ThreadPool& pool, Place place, std::span<std::uint64_t const> ids = {});
  void fill_with_copies(PointsInMemory const& points, ThreadPool& pool);
  void sort_by_ids(Part const& part, std::span<std::uint64_t const> ids);

  /// A point that has come to another cell.
  struct Arrival {
    std::uint32_t cell;
    std::uint32_t index;
  };
  std::optional<std::size_t> move_few(PointsInMemory const& points);
  void put(std::size_t row, std::uint32_t cell, std::uint32_t index, Vector p);
  void move_rows(std::size_t first, std::size_t end, std::size_t by);
  void find_cells_of_rows();
  void find_cells_again();

  CellLayout layout_;
  CellNumbers numbers_;
  StoredCells cells_;
  std::vector<std::uint32_t> first_;  ///< of each stored cell, and one behind
  UninitializedArray<std::uint32_t> index_;
  UninitializedArray<double> x_;
  UninitializedArray<double> y_;
  UninitializedArray<std::uint32_t> cell_of_row_;  ///< of points that have been moved, otherwise empty
  // Scratch of sorting, kept for agents, which are sorted often.
  UninitializedArray<std::uint32_t> cell_of_;  ///< of each agent, its place among the stored ones
  UninitializedArray<std::uint32_t> dealt_;    ///< the agents, part by part; empty where there is one part
  std::vector<Part> parts_;
};

/// Returns the ends of bands of whole rows of cells with about as many points each, and 0 before. Their number changes
/// nothing but which thread searches which points.
std::vector<int> bands_of(CellList const& points, ThreadPool const& pool);

}  // namespace gridlock
