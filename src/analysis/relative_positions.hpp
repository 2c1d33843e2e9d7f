#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "analysis/trajectory.hpp"
#include "gridlock/core/vector.hpp"
#include "gridlock/grid/neighbour_lists.hpp"

namespace gridlock {

/// Some agents with their neighbours, in an order in which agents with equally many neighbours follow one another:
/// loops over neighbours then have lengths that the processor foresees.
class Cages {
 public:
  Cages(NeighbourLists const& neighbours, Agents const& agents);

  [[nodiscard]] std::size_t size() const { return agents_.size(); }
  /// Writes the positions of agents first … first + count − 1 relative to the mean position of their neighbours.
  ///
  /// `positions` has x and y of all agents of a frame. An agent without neighbours has its position relative to
  /// `drift`.
  void find_relative_positions(double const* positions, std::size_t first, std::size_t count, Vector drift, double* x,
                               double* y) const;

 private:
  Agents agents_;
  Agents neighbours_;                 ///< those of one agent after those of the other
  std::vector<std::uint64_t> begin_;  ///< index of the first neighbour of each agent, and their number
};

/// Errors: Error unless there is a list for each agent, whose entries are agents.
void require_lists(NeighbourLists const& neighbours, std::size_t agents, std::size_t frame);

}  // namespace gridlock
