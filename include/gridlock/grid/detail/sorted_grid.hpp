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

class SortedPoints;

/// Copies of the points in the order of their cells, for points that crowd: cells as fine as the cutoff, of which only
/// the occupied ones are stored. Points that come to other cells are put there, and all are sorted anew where many do.
///
/// Memory: 20 bytes a point, 4 more where points have moved, 4 an occupied cell and at most 16 a point for which cells
/// are occupied.
class SortedGrid {
 public:
  using OnAgents = std::function<void(std::span<std::uint32_t const>)>;

  /// Point i is at (x[i], y[i]). Contract: the points are finite.
  SortedGrid(Box const& box, CellLayout const& layout, std::span<double const> x, std::span<double const> y);

  SortedGrid(SortedGrid const& other);
  SortedGrid(SortedGrid&& other) noexcept;
  SortedGrid& operator=(SortedGrid other) noexcept;
  ~SortedGrid();

  /// Point i of as many is at (x[i], y[i]). Returns how many have come to other cells, or the number of all where these
  /// are many.
  /// Contract: the points are finite. Cost: about that of a counting sort where many come to other cells, half as much
  /// where few do.
  std::size_t move_all(std::span<double const> x, std::span<double const> y);

  /// As those of PackedGrid. Contract: the cutoff is at most the shorter side of a cell.

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
  /// The squared distance of the copies that no pair nearer than `cutoff` exceeds, whatever has rounded.
  [[nodiscard]] double squared_limit(double cutoff) const;

  Box box_;
  std::unique_ptr<SortedPoints> points_;
};

}  // namespace gridlock
