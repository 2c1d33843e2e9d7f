#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>

#include "gridlock/core/detail/large_array.hpp"
#include "gridlock/core/detail/thread_pool.hpp"
#include "gridlock/grid/detail/cell_list.hpp"
#include "gridlock/grid/detail/row_block.hpp"
#include "gridlock/model/turn.hpp"

namespace gridlock {

/// Sorts the rows of agents by their cells, and lets all agents take their turns on several threads.
template <class Model>
class AgentsInCellOrder {
 public:
  using Agents = typename World<Model>::Agents;
  using AllValues = typename Agents::AllValues;

  explicit AgentsInCellOrder(ThreadPool& thread_pool) : thread_pool_(thread_pool) {}

  /// Returns the cells by which the rows are sorted.
  [[nodiscard]] CellLayout const& layout() const { return order_.layout(); }

  /// Sorts all agents by their cells, and returns the layout used: `finer`, if it is given and the agents crowd, else
  /// `layout`.
  CellLayout sort(Agents& agents, CellLayout const& layout, std::optional<CellLayout> const& finer = {}) {
    order_.sort(layout, agents.template column<X>(), agents.template column<Y>(), agents.ids(), thread_pool_, finer);
    next_.resize(agents.size());
    // The values are copied to scratch columns in their new order, since sorting in place would overwrite values still
    // unread.
    agents.exchange(next_);
    put_into_scratch(agents.ids(), next_);
    agents.reorder(scratch_ids_, scratch_);
    for_each_range_of_rows(agents.size(), [&](std::size_t first, std::size_t end) { agents.find_again(first, end); });
    return order_.layout();
  }
  /// Gives the agents the values back that they had at the last sort(). Contract: next() has not been written since.
  void undo(Agents& agents) {
    agents.reorder(scratch_ids_, next_);
    sort(agents, CellLayout(order_.layout()));
  }
  /// Makes `agents` a part, see Population::become(), with `ids` and the values of next(), sorted by the cells of a
  /// window.
  void sort_window(Agents& agents, LargeArray<Id> const& ids, CellLayout const& layout, CellWindow const& window,
                   StoredCells::Which stored) {
    order_.sort_window(layout, window, stored, next_.template values<X>(), next_.template values<Y>(), ids,
                       thread_pool_);
    put_into_scratch(ids, next_);
    agents.become(scratch_ids_, scratch_);
  }

  /// Returns the values of all agents after the step.
  [[nodiscard]] AllValues& next() { return next_; }
  [[nodiscard]] AllValues const& next() const { return next_; }
  void begin_turns(std::size_t agents) { next_.resize(agents); }
  void copy_present(Agents const& agents, std::size_t row) { next_.copy(row, agents.values(), row); }

  /// Returns the number of bands: whole rows of cells whose turns one thread takes. Their number does not change the
  /// bits, since all births and deaths are sorted afterwards.
  [[nodiscard]] std::size_t bands() const {
    auto const cell_rows = static_cast<std::size_t>(order_.numbers().rows());
    return thread_pool_.size() == 1 ? 1 : std::min(cell_rows, 16 * thread_pool_.size());
  }
  /// Calls take(neighbourhood, row, band) for each row for which takes_turn(row) returns true; neighbourhood_of(band)
  /// returns the data that the turns of a band share.
  template <class NeighbourhoodOf, class TakesTurn, class Take>
  void for_each_turn(NeighbourhoodOf neighbourhood_of, TakesTurn takes_turn, Take take) {
    CellNumbers const& numbers = order_.numbers();
    RowBlocks const blocks(order_.layout(), [&](int column, int row) { return order_.first_of(column, row); });
    auto const cell_rows = static_cast<std::size_t>(numbers.rows());
    std::size_t const parts = bands();
    thread_pool_.for_each(parts, [&](std::size_t band) {
      Neighbourhood<Model> around = neighbourhood_of(band);
      order_.for_each_cell(static_cast<int>(band * cell_rows / parts), static_cast<int>((band + 1) * cell_rows / parts),
                           [&](int column, int cell_row, RowRange rows) {
                             bool has_block = false;
                             for (std::size_t row = rows.first; row < rows.end; ++row) {
                               if (!takes_turn(row)) continue;
                               if (!has_block) {
                                 around.block = blocks.around(numbers.column_at(column), numbers.row_at(cell_row));
                                 has_block = true;
                               }
                               take(around, row, band);
                             }
                           });
    });
  }

 private:
  template <class Ids>
  void put_into_scratch(Ids const& ids, AllValues const& values) {
    scratch_.resize(ids.size());
    scratch_ids_.resize(ids.size());
    for_each_range_of_rows(ids.size(), [&](std::size_t first, std::size_t end) {
      for (std::size_t row = first; row < end; ++row) {
        std::size_t const from = order_.index(row);
        scratch_.copy(row, values, from);
        scratch_ids_[row] = ids[from];
      }
    });
  }

  template <class Take>
  void for_each_range_of_rows(std::size_t rows, Take take) {
    std::size_t const parts = thread_pool_.size() == 1 ? 1 : 4 * thread_pool_.size();
    thread_pool_.for_each(parts, [&](std::size_t part) { take(part * rows / parts, (part + 1) * rows / parts); });
  }

  ThreadPool& thread_pool_;
  CellList order_;
  AllValues next_;
  AllValues scratch_;
  LargeArray<Id> scratch_ids_;
};

}  // namespace gridlock
