#include "analysis/relative_positions.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "gridlock/core/error.hpp"

namespace gridlock {

void find_relative_positions(double const* positions, NeighbourLists const& neighbours,
                             std::span<std::uint32_t const> agents, Vector drift, double* x, double* y) {
  std::uint32_t const* const list = neighbours.neighbours.data();
  for (std::size_t k = 0; k < agents.size(); ++k) {
    std::size_t const i = agents[k];
    std::uint64_t const begin = neighbours.begin[i];
    std::uint64_t const end = neighbours.begin[i + 1];
    Vector sum{};
    for (std::uint64_t n = begin; n < end; ++n) {
      double const* const neighbour = positions + 2 * std::size_t{list[n]};
      sum = sum + Vector{neighbour[0], neighbour[1]};
    }
    Vector const middle = begin == end ? drift : (1.0 / static_cast<double>(end - begin)) * sum;
    x[k] = positions[2 * i] - middle.x;
    y[k] = positions[2 * i + 1] - middle.y;
  }
}

void require_lists(NeighbourLists const& neighbours, std::size_t agents, std::size_t frame) {
  if (neighbours.begin.size() != agents + 1 || neighbours.begin.front() != 0 ||
      neighbours.begin.back() != neighbours.neighbours.size() || !std::ranges::is_sorted(neighbours.begin)) {
    throw Error({.what = fmt::format("the neighbours in frame {} are not lists of {} agents", frame, agents),
                 .hint = "give one list for each agent, one after the other"});
  }
  for (std::uint32_t const neighbour : neighbours.neighbours) {
    if (neighbour < agents) continue;
    throw Error(
        {.what = fmt::format("agent {} is a neighbour in frame {}, and there are {} agents", neighbour, frame, agents),
         .hint = "number agents from 0 in the order of their positions"});
  }
}

}  // namespace gridlock
