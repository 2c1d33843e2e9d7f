#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "gridlock/model/detail/world.hpp"

namespace gridlock {

/// A difference between the agents found by a search and by brute force.
struct SearchDifference {
  std::uint64_t step = 0;
  Vector point;
  double cutoff = 0.0;
  std::size_t found = 0;
  std::size_t expected = 0;
  Id id = 0;  ///< an agent at the first difference of the sorted Ids
};

[[noreturn]] void throw_search_difference(SearchDifference const& difference);

/// Compares the agents that a search found with those that brute force finds; throws RunFailure if they differ.
/// counts(row) returns whether the search may find the agent of a row. Cost: O(agents).
template <class Model, class Counts>
void verify_search(World<Model> const& world, Vector p, double cutoff, std::vector<Id> found, Counts counts) {
  std::vector<Id> expected;
  auto const x = world.agents.template column<X>();
  auto const y = world.agents.template column<Y>();
  for (std::size_t row = 0; row < world.agents.size(); ++row) {
    Vector const separation = world.box.displacement(p, {x[row], y[row]});
    if (squared_length(separation) < cutoff * cutoff && counts(row)) expected.push_back(world.agents.ids()[row]);
  }
  std::ranges::sort(found);
  std::ranges::sort(expected);
  if (found == expected) return;
  auto const [one, other] = std::ranges::mismatch(found, expected);
  throw_search_difference({.step = world.clock.step,
                           .point = p,
                           .cutoff = cutoff,
                           .found = found.size(),
                           .expected = expected.size(),
                           .id = one != found.end() ? *one : *other});
}

}  // namespace gridlock
