#pragma once

#include <algorithm>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

#include "gridlock/core/look_ahead.hpp"
#include "gridlock/model/world.hpp"

namespace gridlock {

/// What the agents of one part of the world asked for in their turns: kept until the turns are over, so that nobody's
/// row moves while neighbours are being visited.
template <class Model>
struct Requests {
  struct Birth {
    Id parent;
    std::uint64_t number;  ///< of the births of this parent in this step
    typename World<Model>::Agents::Values values;
  };

  std::vector<Birth> births;
  std::vector<Id> deaths;  ///< an Id may stand there twice
  EventCounts<Model> events{};
  std::vector<std::uint32_t> found;  ///< rows of neighbours, a stack: a search within a search comes on top
  std::size_t found_top = 0;

  void clear() {
    births.clear();
    deaths.clear();
    events = {};
  }
};

/// Lets everything that was asked for take effect: first the deaths in the order of the Ids, then the births in the
/// order of their parents' Ids. The state alone decides that order, so that also the names of the newborn are the same
/// on any number of threads. Says whether there was any birth or death.
template <class Model>
bool settle(World<Model>& world, std::span<Requests<Model>> parts) {
  using Birth = typename Requests<Model>::Birth;
  std::vector<Id> deaths;
  std::vector<Birth> births;
  for (Requests<Model>& part : parts) {
    deaths.insert(deaths.end(), part.deaths.begin(), part.deaths.end());
    births.insert(births.end(), part.births.begin(), part.births.end());
    for (std::size_t k = 0; k < world.events.size(); ++k) world.events[k] += part.events[k];
    part.clear();
  }
  std::ranges::sort(deaths);
  deaths.erase(std::unique(deaths.begin(), deaths.end()), deaths.end());
  std::ranges::sort(births, [](Birth const& a, Birth const& b) {
    return std::tie(a.parent, a.number) < std::tie(b.parent, b.number);
  });
  carry_out_with_look_ahead(
      deaths.size(), [&](std::size_t k) { world.agents.prefetch(deaths[k]); },
      [&](std::size_t k) { world.agents.prefetch_row(deaths[k]); },
      [&](std::size_t k) { world.agents.remove(deaths[k]); });
  for (Birth const& birth : births) {
    std::apply([&](auto... values) { world.agents.add(values...); }, birth.values);
  }
  return !deaths.empty() || !births.empty();
}

}  // namespace gridlock
