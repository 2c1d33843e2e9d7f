#pragma once

/// \file
/// Networks: edges between agents, wherever in the box these are.
///
/// ```cpp
/// Network friends("friends");  // an edge joins both of its agents
/// friends.connect({{.from = 3, .to = 5}, {.from = 5, .to = 4, .weight = 0.5}});
/// bool const is_joined = friends.has(4, 5);
/// friends.disconnect({{.from = 3, .to = 5}});
/// ```

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "gridlock/core/archive.hpp"
#include "gridlock/core/population.hpp"

namespace gridlock {

/// An edge of a network, with a weight; its direction counts in directed networks only.
struct NetworkEdge {
  Id from = 0;
  Id to = 0;
  double weight = 1.0;

  friend bool operator==(NetworkEdge const&, NetworkEdge const&) = default;
};

/// Edges between agents, which agents keep wherever they move. No agent has an edge to itself, and no two edges join
/// the same agents; in a directed network they may if they lead both ways.
///
/// Edges are sorted by `from`, then by `to`; in an undirected network `from` is the smaller Id. Cost: 24 bytes an edge;
/// a change costs one pass over all edges, and a sort of those that change.
class Network {
 public:
  explicit Network(std::string name, bool is_directed = false);

  [[nodiscard]] std::string const& name() const { return name_; }
  [[nodiscard]] bool is_directed() const { return is_directed_; }
  [[nodiscard]] std::size_t size() const { return edges_.size(); }
  [[nodiscard]] std::span<NetworkEdge const> edges() const { return edges_; }
  /// Returns whether there is an edge, in a directed network one from `from` to `to`. Cost: a binary search.
  [[nodiscard]] bool has(Id from, Id to) const;

  /// Adds edges. Errors: Error for an edge from an agent to itself, for one that there is, and for a weight that is
  /// infinite or no number; the network then stays as it was.
  void connect(std::vector<NetworkEdge> edges);
  /// Removes edges, whatever their weights are. Errors: Error for an edge that there is not; the network then stays as
  /// it was.
  void disconnect(std::vector<NetworkEdge> edges);
  /// Gives an edge, by its index in edges(), another weight. Errors: Error for one that is infinite or no number.
  void set_weight(std::size_t edge, double weight);
  /// Removes the edges of agents. Contract: `ids` are sorted.
  void remove_agents(std::span<Id const> ids);

  /// Serializes the edges. Errors: Error for restored edges that no network can have.
  void serialize(Archive& archive);

  friend bool operator==(Network const&, Network const&) = default;

 private:
  /// Sorts edges as those of the network are.
  void put_in_order(std::vector<NetworkEdge>& edges) const;

  std::string name_;
  bool is_directed_;
  std::vector<NetworkEdge> edges_;
};

/// Returns the state hash of a world with networks from that without them; the same if there are none.
std::uint64_t hash_with_networks(std::uint64_t hash_without, std::span<Network const> networks);

}  // namespace gridlock
