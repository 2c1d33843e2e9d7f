#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>

#include "gridlock/core/box.hpp"
#include "gridlock/grid/cell_layout.hpp"
#include "gridlock/grid/detail/agent_pairs.hpp"

namespace gridlock {

class CellList;

/// Copies of points sorted by their cells, for points that crowd: cells are as small as the cutoff, and only occupied
/// cells are stored. move_all() puts single points into their new cells, or sorts all points if many have changed
/// cells.
///
/// Memory: 20 bytes a point, 4 more if points have moved, 4 bytes an occupied cell, and up to 16 bytes a point to list
/// which cells are occupied.
class SortedGrid {
 public:
  using OnAgents = std::function<void(std::span<std::uint32_t const>)>;

  /// Makes a grid with point i at (x[i], y[i]). Contract: the points are finite.
  SortedGrid(Box const& box, CellLayout const& layout, std::span<double const> x, std::span<double const> y);

  SortedGrid(SortedGrid const& other);
  SortedGrid(SortedGrid&& other) noexcept;
  SortedGrid& operator=(SortedGrid other) noexcept;
  ~SortedGrid();

  /// Moves point i to (x[i], y[i]). Returns the number of points that have changed cells, or of all points if these are
  /// many.
  /// Contract: the points are finite, and as many as before. Cost: about that of a counting sort if many points change
  /// cells, half as much if few do.
  std::size_t move_all(std::span<double const> x, std::span<double const> y);

  /// The functions below do the same as in PackedGrid. Contract: the cutoff is at most the shorter side of a cell.

  template <class Visit>
  void for_each_candidate(Vector p, double cutoff, Visit visit) const {
    find_candidates(p, cutoff, [&](std::span<std::uint32_t const> agents) {
      for (std::uint32_t const agent : agents) visit(std::size_t{agent});
    });
  }
  template <class Visit, class Expect = ExpectNothing>
  void for_each_candidate_pair(double cutoff, Visit visit, Expect expect = {}) const {
    find_candidate_pairs(cutoff, [&](std::span<AgentPair const> pairs) { visit_pairs(pairs, visit, expect); });
  }

 private:
  void find_candidates(Vector p, double cutoff, OnAgents const& on_agents) const;
  void find_candidate_pairs(double cutoff, OnPairs const& on_pairs) const;
  /// Returns an upper bound, despite rounding, on the squared distance of the copies of pairs nearer than `cutoff`.
  [[nodiscard]] double squared_limit(double cutoff) const;

  Box box_;
  std::unique_ptr<CellList> points_;
};

}  // namespace gridlock
