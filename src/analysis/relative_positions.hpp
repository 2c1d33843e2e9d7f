#pragma once

#include <cstdint>
#include <span>

#include "gridlock/core/vector.hpp"
#include "gridlock/grid/neighbour_lists.hpp"

namespace gridlock {

/// Writes the positions of agents relative to the mean position of their neighbours, agents[k] to x[k] and y[k].
///
/// `positions` has x and y of all agents of a frame. An agent without neighbours has its position relative to `drift`.
/// Contract: x and y have room for all agents.
void find_relative_positions(double const* positions, NeighbourLists const& neighbours,
                             std::span<std::uint32_t const> agents, Vector drift, double* x, double* y);

/// Errors: Error unless there is a list for each agent, whose entries are agents.
void require_lists(NeighbourLists const& neighbours, std::size_t agents, std::size_t frame);

}  // namespace gridlock
