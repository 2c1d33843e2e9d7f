#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gridlock/grid/cell_layout.hpp"
#include "gridlock/grid/detail/agent_pairs.hpp"

namespace gridlock {

/// The data structure of the paper: a doubly linked list of agents for each cell.
///
///     heads_[cell] → i ⇄ j ⇄ l → none        next_[i] = j, previous_[j] = i, cell_[i] = cell
///
/// An agent is its row in the population. Insert, erase and move cost O(1) whatever the number of agents in a cell.
/// Contract: an agent is inserted once before it is moved or erased (asserted).
/// Source: J.-X. Shen, Agent based simulations and optimization with uniform grid applied to colloidal jamming
/// transitions.
class LinkedGrid {
 public:
  LinkedGrid() = default;
  /// Makes an empty grid with memory for agents 0 … agents − 1.
  explicit LinkedGrid(CellLayout const& layout, std::size_t agents = 0);
  /// Makes a grid that holds all points, agent i at (x[i], y[i]).
  /// Errors: Error for lists of different lengths, and for coordinates that are not finite.
  LinkedGrid(CellLayout const& layout, std::span<double const> x, std::span<double const> y);

  [[nodiscard]] CellLayout const& layout() const { return layout_; }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] int cell_of(std::size_t agent) const { return cell_[agent]; }
  [[nodiscard]] bool contains(std::size_t agent) const { return agent < cell_.size() && cell_[agent] != outside; }

  /// Allocates memory for agents 0 … agents − 1.
  void reserve(std::size_t agents) {
    if (agents > cell_.size()) grow(agents);
  }

  void insert(std::size_t agent, Vector p) {
    if (agent >= cell_.size()) grow(agent + 1);
    assert(cell_[agent] == outside);
    link(agent, layout_.cell_of(p));
    ++size_;
  }

  void erase(std::size_t agent) {
    assert(contains(agent));
    unlink(agent);
    cell_[agent] = outside;
    --size_;
  }

  /// Moves the agent to the list of the cell that holds `p`; nothing changes while it stays in its cell.
  void move(std::size_t agent, Vector p) {
    assert(contains(agent));
    int const cell = layout_.cell_of(p);
    if (cell == cell_[agent]) return;
    unlink(agent);
    link(agent, cell);
  }

  /// Moves every agent i in the grid to (x[i], y[i]).
  /// Errors: Error for lists of different lengths, or too short for the agents held.
  void move_all(std::span<double const> x, std::span<double const> y);

  /// Calls visit(agent) for every agent of one cell.
  template <class Visit>
  void for_each_in_cell(int cell, Visit visit) const {
    for (std::int32_t i = heads_[static_cast<std::size_t>(cell)]; i != none; i = next_[static_cast<std::size_t>(i)]) {
      visit(static_cast<std::size_t>(i));
    }
  }

  /// Calls visit(agent) for every agent of the block of cells around `cell`, the 3×3 block for reach 1, 1.
  template <class Visit>
  void for_each_in_block(int cell, int reach_columns, int reach_rows, Visit visit) const {
    layout_.for_each_cell_in_block(cell, reach_columns, reach_rows, [&](int c) { for_each_in_cell(c, visit); });
  }

  /// Calls visit(j) for every agent nearer to p than `cutoff`, and for some that are farther.
  template <class Visit>
  void for_each_candidate(Vector p, double cutoff, Visit visit) const {
    for_each_in_block(layout_.cell_of(p), layout_.columns_within(cutoff), layout_.rows_within(cutoff), visit);
  }

  /// Calls visit(i, j), i > j, once for every pair nearer than `cutoff`, and for some that are farther.
  template <class Visit, class Expect = ExpectNothing>
  void for_each_candidate_pair(double cutoff, Visit visit, Expect const& = {}) const {
    int const reach_columns = layout_.columns_within(cutoff);
    int const reach_rows = layout_.rows_within(cutoff);
    for (std::size_t i = 0; i < cell_.size(); ++i) {
      if (cell_[i] == outside) continue;
      for_each_in_block(cell_[i], reach_columns, reach_rows, [&](std::size_t j) {
        if (j < i) visit(i, j);
      });
    }
  }

  /// Returns whether every list is linked both ways, holds only agents of its cell, and all agents are in a list.
  /// Cost: O(agents + cells); for tests and audits.
  [[nodiscard]] bool is_consistent() const;

 private:
  static constexpr std::int32_t none = -1;
  static constexpr int outside = -1;

  void grow(std::size_t agents);
  void link(std::size_t agent, int cell);
  void unlink(std::size_t agent);

  CellLayout layout_;
  std::vector<std::int32_t> heads_;
  std::vector<std::int32_t> next_;
  std::vector<std::int32_t> previous_;
  std::vector<int> cell_;
  std::size_t size_ = 0;
};

}  // namespace gridlock
