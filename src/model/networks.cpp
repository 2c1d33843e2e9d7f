#include "gridlock/model/networks.hpp"

#include <fmt/format.h>

#include <limits>

namespace gridlock {

NeighboursOnNetwork::NeighboursOnNetwork(Network const& network) : edges_(network.size()) {
  std::size_t slots = 0;
  for (NetworkEdge const& edge : network.edges())
    slots = std::max({slots, slot_of(edge.from) + 1, slot_of(edge.to) + 1});
  std::vector<std::size_t> next(slots + 1);
  for (NetworkEdge const& edge : network.edges()) {
    ++next[slot_of(edge.from) + 1];
    if (!network.is_directed()) ++next[slot_of(edge.to) + 1];
  }
  for (std::size_t slot = 0; slot < slots; ++slot) next[slot + 1] += next[slot];
  first_ = next;
  neighbours_.resize(first_.back());
  // Edges are sorted, and `from` is the smaller Id in an undirected network: an agent first gets the smaller Ids, then
  // the larger ones, both in their order.
  if (!network.is_directed()) {
    for (auto const& [from, to, weight] : network.edges()) neighbours_[next[slot_of(to)]++] = {from, weight};
  }
  for (auto const& [from, to, weight] : network.edges()) neighbours_[next[slot_of(from)]++] = {to, weight};
}

RandomStream random_of_network(std::uint64_t seed, std::optional<std::uint64_t> step, std::size_t place,
                               std::uint64_t purpose) {
  constexpr std::uint64_t max_networks = 65536;
  constexpr std::uint64_t step_of_start = std::numeric_limits<std::uint64_t>::max();
  return {seed, step.value_or(step_of_start), purpose * max_networks + place, Purpose::model_network};
}

std::vector<NetworkEdge> edges_of(NodePairs const& pairs, std::span<Id const> ids) {
  std::vector<NetworkEdge> edges;
  edges.reserve(pairs.size());
  for (auto const& [one, other] : pairs) edges.push_back({.from = ids[one], .to = ids[other]});
  return edges;
}

void require_same_networks(std::span<Network const> networks, std::span<Network const> of_model) {
  auto const is_same = [](Network const& one, Network const& other) {
    return one.name() == other.name() && one.is_directed() == other.is_directed();
  };
  if (std::ranges::equal(networks, of_model, is_same)) return;
  throw Error(Problem{.what = "a world has other networks than its model",
                      .hint = "start_agents() makes those of the model",
                      .key = "model.kind"});
}

void throw_dead_end(std::uint64_t step, Network const& network, Id agent) {
  throw RunFailure(fmt::format(
      "step {}: an edge of the network {} leads to agent {}, which does not live\n  hint: this is a mistake "
      "of the model, or the checkpoint of another run: connect agents that the world contains",
      step, network.name(), agent));
}

RunFailure failure_of_networks(std::uint64_t step, Error const& error) {
  return RunFailure(fmt::format("step {}: {}", step, error.what()));
}

}  // namespace gridlock
