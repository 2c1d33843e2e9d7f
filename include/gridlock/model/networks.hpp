#pragma once

/// \file
/// The networks of a model: edges between agents, which keep them wherever they move.
///
/// ```cpp
/// #include "gridlock/model/model.hpp"
/// struct Friends {
///   static constexpr std::string_view name = "friends";
/// };
/// struct Opinion {
///   using type = double;
///   static constexpr char const* name = "opinion";
/// };
/// struct Debaters {
///   static constexpr Schedule schedule = Schedule::synchronous;
///   using Agents = Population<X, Y, Opinion>;
///   using Networks = NetworkSet<Friends>;
///   double cutoff() const { return 0.1; }
///   double time_step() const { return 1.0; }
///   void start_networks(World<Debaters>& world) const {
///     RandomStream random = start_random_of_network<Friends>(world);
///     NodePairs const pairs = scale_free_graph(static_cast<std::uint32_t>(world.agents.size()), 3, random);
///     network_of<Friends>(world).connect(edges_of(pairs, world.agents.ids()));
///   }
///   void turn(Turn<Debaters>& self) const {
///     double sum = 0.0;
///     self.for_each_neighbour<Friends>([&](Neighbour<Debaters> const& other, double weight) {
///       sum += weight * other.get<Opinion>();
///     });
///     self.set<Opinion>(sum / static_cast<double>(self.degree<Friends>()));
///   }
/// };
/// ```

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/core/network.hpp"
#include "gridlock/core/random_graphs.hpp"
#include "gridlock/core/world.hpp"
#include "gridlock/model/detail/named_set.hpp"
#include "gridlock/model/detail/neighbours_on_network.hpp"

namespace gridlock {

/// The networks of a model, each a tag `struct Friends { static constexpr std::string_view name = "friends"; };`. A tag
/// with `static constexpr bool is_directed = true` is a network whose edges have a direction.
///
/// ```cpp
/// struct Friends {
///   static constexpr std::string_view name = "friends";
/// };
/// struct Debts {
///   static constexpr std::string_view name = "debts";
///   static constexpr bool is_directed = true;
/// };
/// using Networks = NetworkSet<Friends, Debts>;
/// static_assert(Networks::place_of<Debts> == 0);  // World::networks has the order of the names
/// ```
template <class... Tags>
struct NetworkSet : NamedSet<Tags...> {};

template <class Model>
struct NetworksOfModel {
  using type = NetworkSet<>;
};
template <class Model>
requires requires { typename Model::Networks; }
struct NetworksOfModel<Model> {
  using type = typename Model::Networks;
};
/// The NetworkSet of a model, `Model::Networks`; empty if the model declares no networks.
template <class Model>
using NetworksOf = typename NetworksOfModel<Model>::type;

template <class Model>
consteval bool has_networks() {
  return NetworksOf<Model>::count > 0;
}

/// Return a network of a world. Cost: none.
template <class Tag, class Model>
Network& network_of(World<Model>& world) {
  static_assert(NetworksOf<Model>::template has<Tag>, "the model names each of its networks in Networks");
  return world.networks[NetworksOf<Model>::template place_of<Tag>];
}
template <class Tag, class Model>
Network const& network_of(World<Model> const& world) {
  static_assert(NetworksOf<Model>::template has<Tag>, "the model names each of its networks in Networks");
  return world.networks[NetworksOf<Model>::template place_of<Tag>];
}

/// Returns the edges of a graph whose node k is the agent ids[k]. Contract: there is an Id for each node.
std::vector<NetworkEdge> edges_of(NodePairs const& pairs, std::span<Id const> ids);

/// Returns the random numbers with which a model connects a network at the start; different purposes 0, 1, 2 … give
/// independent numbers.
template <class Tag, class Model>
RandomStream start_random_of_network(World<Model> const& world, std::uint64_t purpose = 0) {
  return random_of_network(world.seed, {}, NetworksOf<Model>::template place_of<Tag>, purpose);
}

/// A birth in a step, with the Ids of both; the parent may have died.
struct Birth {
  Id parent = 0;
  Id child = 0;
};

/// The networks of a world at the end of a step, after its deaths and births, which Model::step_networks() changes.
/// Edges of the dead are gone then.
///
/// ```cpp
/// struct Kin {
///   static constexpr std::string_view name = "kin";
/// };
/// struct Settlers {
///   using Agents = Population<X, Y>;
///   using Networks = NetworkSet<Kin>;
///   void step_networks(NetworksOfStep<Settlers>& networks) const {
///     std::vector<NetworkEdge> edges;
///     for (auto const& [parent, child] : networks.births()) {
///       if (networks.world().agents.contains(parent)) edges.push_back({.from = parent, .to = child});
///     }
///     networks.get<Kin>().connect(edges);
///   }
/// };
/// ```
template <class Model>
class NetworksOfStep {
 public:
  NetworksOfStep(World<Model>& world, std::span<Birth const> births) : world_(world), births_(births) {}

  [[nodiscard]] World<Model> const& world() const { return world_; }
  [[nodiscard]] Clock const& clock() const { return world_.clock; }
  /// Returns the births of this step, in the order of the parents' Ids.
  [[nodiscard]] std::span<Birth const> births() const { return births_; }
  /// Returns a network to change. Errors: those of Network, which end the run as RunFailure.
  template <class Tag>
  [[nodiscard]] Network& get() {
    is_changed_[NetworksOf<Model>::template place_of<Tag>] = true;
    return network_of<Tag>(world_);
  }
  /// Returns the random numbers of a network in this step; different purposes 0, 1, 2 … give independent numbers.
  template <class Tag>
  [[nodiscard]] RandomStream random(std::uint64_t purpose = 0) const {
    return random_of_network(world_.seed, world_.clock.step, NetworksOf<Model>::template place_of<Tag>, purpose);
  }
  [[nodiscard]] bool is_changed(std::size_t place) const { return is_changed_[place]; }

 private:
  World<Model>& world_;
  std::span<Birth const> births_;
  std::array<bool, NetworksOf<Model>::count> is_changed_{};
};

/// Returns the networks of a model, without edges, in the order of their names.
template <class Model>
std::vector<Network> empty_networks() {
  auto const network = [](auto tag) {
    using Tag = typename decltype(tag)::type;
    if constexpr (requires { Tag::is_directed; }) {
      return Network(std::string(Tag::name), Tag::is_directed);
    } else {
      return Network(std::string(Tag::name));
    }
  };
  std::vector<Network> networks = [&]<class... Tags>(std::type_identity<NetworkSet<Tags...>>) {
    return std::vector<Network>{network(std::type_identity<Tags>{})...};
  }(std::type_identity<NetworksOf<Model>>{});
  std::ranges::sort(networks, {}, &Network::name);
  return networks;
}

/// Throws RunFailure for an edge of a network that leads to an agent that does not live.
template <class Model>
void require_living_ends(World<Model> const& world, Network const& network) {
  for (NetworkEdge const& edge : network.edges()) {
    for (Id const id : {edge.from, edge.to}) {
      if (!world.agents.contains(id)) throw_dead_end(world.clock.step, network, id);
    }
  }
}

/// Throws Error for a world without the networks of its model, and RunFailure for edges to agents that do not live.
template <class Model>
void require_networks(World<Model> const& world) {
  if constexpr (has_networks<Model>()) {
    require_same_networks(world.networks, empty_networks<Model>());
    for (Network const& network : world.networks) require_living_ends(world, network);
  }
}

}  // namespace gridlock
