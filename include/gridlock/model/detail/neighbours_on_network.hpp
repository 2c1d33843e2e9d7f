#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/core/network.hpp"
#include "gridlock/core/random.hpp"

namespace gridlock {

/// The neighbours of each agent on a network, in the order of their Ids; on a directed network those that its edges
/// lead to.
///
/// Cost: 16 bytes an edge and direction, 8 bytes a slot; two passes over the edges.
class NeighboursOnNetwork {
 public:
  struct Neighbour {
    Id id = 0;
    double weight = 1.0;
  };

  NeighboursOnNetwork() = default;
  explicit NeighboursOnNetwork(Network const& network);

  /// Returns the number of edges of the network.
  [[nodiscard]] std::size_t edges() const { return edges_; }
  /// Returns the neighbours of a living agent. Contract: no edge leads to an agent that is dead.
  [[nodiscard]] std::span<Neighbour const> of(Id agent) const {
    std::size_t const slot = slot_of(agent);
    if (slot + 1 >= first_.size()) return {};
    return std::span(neighbours_).subspan(first_[slot], first_[slot + 1] - first_[slot]);
  }

 private:
  static std::size_t slot_of(Id agent) { return static_cast<std::size_t>(agent & 0xFFFFFFFFU); }

  std::vector<Neighbour> neighbours_;
  std::vector<std::size_t> first_;  ///< the first neighbour of the agent in each slot, and the end of all
  std::size_t edges_ = 0;
};

/// Returns random numbers for the edges of a network in a step, or at the start.
RandomStream random_of_network(std::uint64_t seed, std::optional<std::uint64_t> step, std::size_t place,
                               std::uint64_t purpose);

/// Throws Error unless networks have the names and directions of those that the model makes.
void require_same_networks(std::span<Network const> networks, std::span<Network const> of_model);

/// Throws RunFailure for an edge that leads to an agent that does not live.
[[noreturn, gnu::cold]] void throw_dead_end(std::uint64_t step, Network const& network, Id agent);

/// Returns the failure of a step whose edges a network refuses.
RunFailure failure_of_networks(std::uint64_t step, Error const& error);

}  // namespace gridlock
