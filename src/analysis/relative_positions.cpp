#include "analysis/relative_positions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "gridlock/core/error.hpp"

namespace gridlock {

namespace {

using Two = double __attribute__((vector_size(2 * sizeof(double))));

Two load_two(double const* xy) {
  Two two;
  std::memcpy(&two, xy, sizeof two);
  return two;
}

}  // namespace

Cages::Cages(NeighbourLists const& neighbours, Agents const& agents) {
  std::vector<Agents> by_count;
  for (std::uint32_t const i : agents) {
    std::size_t const count = neighbours.begin[i + 1] - neighbours.begin[i];
    if (count >= by_count.size()) by_count.resize(count + 1);
    by_count[count].push_back(i);
  }
  begin_.push_back(0);
  for (Agents const& equal : by_count) {
    for (std::uint32_t const i : equal) {
      agents_.push_back(i);
      auto const list = std::span(neighbours.neighbours).subspan(neighbours.begin[i]);
      neighbours_.insert(neighbours_.end(), list.begin(),
                         list.begin() + (neighbours.begin[i + 1] - neighbours.begin[i]));
      begin_.push_back(neighbours_.size());
    }
  }
}

void Cages::find_relative_positions(double const* positions, std::size_t first, std::size_t count, Vector drift,
                                    double* x, double* y) const {
  std::uint32_t const* neighbour = neighbours_.data() + begin_[first];
  for (std::size_t k = 0; k < count; ++k) {
    std::size_t const i = agents_[first + k];
    std::uint64_t const neighbours = begin_[first + k + 1] - begin_[first + k];
    Two sum{};
    for (std::uint64_t n = 0; n < neighbours; ++n) sum += load_two(positions + 2 * std::size_t{neighbour[n]});
    neighbour += neighbours;
    Two const middle = neighbours == 0 ? Two{drift.x, drift.y} : sum / static_cast<double>(neighbours);
    Two const relative = load_two(positions + 2 * i) - middle;
    x[k] = relative[0];
    y[k] = relative[1];
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
