#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

#include "gridlock/core/random_graphs.hpp"
#include "model_world.hpp"

namespace gridlock::python {

namespace {

/// The step of the random numbers of networks at the start; no step of a run has this number.
constexpr std::uint64_t step_of_start = std::numeric_limits<std::uint64_t>::max();

nb::object array_of_rows(std::vector<std::array<std::uint32_t, 2>> const& pairs) {
  UninitializedArray<std::uint32_t> rows(2 * pairs.size());
  for (std::size_t k = 0; k < pairs.size(); ++k) std::ranges::copy(pairs[k], rows.begin() + 2 * k);
  return nb::cast(owned_array(std::move(rows), {pairs.size(), 2}));
}

NodePairs pairs_at_random(std::string const& kind, std::uint32_t nodes, double first, double second, PairsOfNodes pairs,
                          RandomStream& random) {
  auto const number = static_cast<std::uint64_t>(first);
  if (kind == "probability") return random_graph(nodes, first, pairs, random);
  if (kind == "edges") return random_graph_of(nodes, number, pairs, random);
  if (kind == "small world") return small_world_graph(nodes, {.degree = number, .rewiring = second}, random);
  return scale_free_graph(nodes, number, random);
}

}  // namespace

Network& ModelWorld::find_network(std::string const& name) const {
  require_open();
  return *std::ranges::find(world_.networks, name, &Network::name);
}

Network& ModelWorld::network_to_change(std::string const& name) {
  Network& network = find_network(name);
  auto const before = std::ranges::find(networks_before_, name, &Network::name);
  if (before == networks_before_.end()) networks_before_.push_back(network);
  return network;
}

std::vector<std::array<std::uint32_t, 2>> ModelWorld::rows_of(Network const& network) const {
  auto const row_of = [&](Id id) {
    return static_cast<std::uint32_t>(phase_ == Phase::start ? id : world_.agents.index_of(id));
  };
  std::vector<std::array<std::uint32_t, 2>> rows;
  rows.reserve(network.size());
  for (NetworkEdge const& edge : network.edges()) rows.push_back({row_of(edge.from), row_of(edge.to)});
  return rows;
}

Id ModelWorld::id_of(std::uint64_t row) const { return phase_ == Phase::start ? row : world_.agents.ids()[row]; }

std::vector<NetworkEdge> ModelWorld::edges_of(Rows const& rows, Amounts const* weights) const {
  std::vector<NetworkEdge> edges(rows.shape(0));
  for (std::size_t k = 0; k < edges.size(); ++k) {
    for (std::size_t const end : {0, 1}) {
      if (rows(k, end) < size()) continue;
      throw Error(
          {.what = "there is no agent in row " + std::to_string(rows(k, end)) + " among " + std::to_string(size()),
           .hint = "rows are those of the arrays in this step; those of newborn agents can be connected only"});
    }
    edges[k] = {.from = id_of(rows(k, 0)), .to = id_of(rows(k, 1)), .weight = weights != nullptr ? (*weights)(k) : 1.0};
  }
  return edges;
}

nb::object ModelWorld::network_edges(std::string const& name) const {
  Network const& network = find_network(name);
  UninitializedArray<double> weights(network.size());
  std::ranges::transform(network.edges(), weights.begin(), &NetworkEdge::weight);
  return nb::make_tuple(array_of_rows(rows_of(network)), owned_array(std::move(weights)));
}

nb::object ModelWorld::network_lists(std::string const& name, bool incoming) const {
  Network const& network = find_network(name);
  auto rows = rows_of(network);
  bool const is_directed = network.is_directed();
  if (is_directed && incoming) {
    for (auto& [from, to] : rows) std::swap(from, to);
  }
  std::vector<std::uint64_t> begin(size() + 1);
  for (auto const& [from, to] : rows) {
    ++begin[from + 1];
    if (!is_directed) ++begin[to + 1];
  }
  for (std::size_t row = 0; row < size(); ++row) begin[row + 1] += begin[row];
  UninitializedArray<std::uint32_t> neighbours(begin.back());
  UninitializedArray<double> weights(begin.back());
  // Edges are sorted by their Ids, so each list is in the order of the Ids, in whichever rows the agents are.
  std::vector<std::uint64_t> next(begin.begin(), begin.end() - 1);
  auto const put = [&](std::uint32_t owner, std::uint32_t neighbour, double weight) {
    neighbours[next[owner]] = neighbour;
    weights[next[owner]++] = weight;
  };
  for (std::size_t k = 0; k < rows.size(); ++k) {
    put(rows[k][0], rows[k][1], network.edges()[k].weight);
    if (!is_directed) put(rows[k][1], rows[k][0], network.edges()[k].weight);
  }
  return nb::make_tuple(owned_array(std::move(begin)), owned_array(std::move(neighbours)),
                        owned_array(std::move(weights)));
}

std::uint64_t ModelWorld::rows_with_newborn() const {
  std::uint64_t rows = size();
  for (NewAgents const& born : births_) rows += born.x.size();
  return rows;
}

void ModelWorld::connect(std::string const& name, Rows const& rows, Amounts const& weights) {
  Network& network = network_to_change(name);
  std::uint64_t const agents = size();
  if (rows_with_newborn() == agents) return network.connect(edges_of(rows, &weights));
  std::vector<NetworkEdge> edges;
  // Newborn agents have no Ids before the end of the step: a network of rows refuses what their edges may not be.
  Network of_newborn = edges_of_newborn(name);
  std::vector<NetworkEdge> waiting;
  for (std::size_t k = 0; k < rows.shape(0); ++k) {
    std::uint64_t const last = std::max(rows(k, 0), rows(k, 1));
    if (last >= rows_with_newborn()) {
      throw Error({.what = "there is no agent in row " + std::to_string(last) + " among " + std::to_string(agents) +
                           " and " + std::to_string(rows_with_newborn() - agents) + " newborn ones",
                   .hint = "rows are those of the arrays in this step, and those that add() returns"});
    }
    if (last < agents) {
      edges.push_back({.from = id_of(rows(k, 0)), .to = id_of(rows(k, 1)), .weight = weights(k)});
    } else {
      waiting.push_back({.from = rows(k, 0), .to = rows(k, 1), .weight = weights(k)});
    }
  }
  of_newborn.connect(std::move(waiting));
  network.connect(std::move(edges));
  std::erase_if(edges_of_newborn_, [&](Network const& known) { return known.name() == name; });
  edges_of_newborn_.push_back(std::move(of_newborn));
}

Network ModelWorld::edges_of_newborn(std::string const& name) const {
  auto const known = std::ranges::find(edges_of_newborn_, name, &Network::name);
  return known != edges_of_newborn_.end() ? *known : Network(name, find_network(name).is_directed());
}

void ModelWorld::disconnect(std::string const& name, Rows const& rows) {
  network_to_change(name).disconnect(edges_of(rows, nullptr));
}

void ModelWorld::set_weights(std::string const& name, Amounts const& weights) {
  Network& network = network_to_change(name);
  if (weights.shape(0) != network.size()) {
    throw Error({.what = "there are " + std::to_string(weights.shape(0)) + " weights for the " +
                         std::to_string(network.size()) + " edges of the network " + name,
                 .hint = "give a number, or one for each edge"});
  }
  for (std::size_t edge = 0; edge < network.size(); ++edge) network.set_weight(edge, weights(edge));
}

nb::object ModelWorld::has_edges(std::string const& name, Rows const& rows) const {
  Network const& network = find_network(name);
  std::vector<NetworkEdge> const edges = edges_of(rows, nullptr);
  std::vector<std::uint8_t> found(edges.size());
  std::ranges::transform(edges, found.begin(),
                         [&](NetworkEdge const& edge) { return network.has(edge.from, edge.to) ? 1 : 0; });
  return nb::cast(owned_array(std::move(found)));
}

nb::object ModelWorld::random_pairs(std::string const& name, std::string const& kind, double first, double second,
                                    std::uint64_t purpose) const {
  Network const& network = find_network(name);
  auto const place = static_cast<std::uint64_t>(&network - world_.networks.data());
  constexpr std::uint64_t max_networks = 65536;
  std::uint64_t const step = phase_ == Phase::start ? step_of_start : world_.clock.step;
  RandomStream random(world_.seed, step, purpose * max_networks + place, Purpose::model_network);
  PairsOfNodes const pairs = network.is_directed() ? PairsOfNodes::both_ways : PairsOfNodes::once;
  return array_of_rows(pairs_at_random(kind, static_cast<std::uint32_t>(size()), first, second, pairs, random));
}

void connect_newborn(World<TableModel>& world, std::vector<Network> const& edges, std::span<Id const> ids) {
  for (Network const& of_rows : edges) {
    std::vector<NetworkEdge> alive;
    for (NetworkEdge const& edge : of_rows.edges()) {
      NetworkEdge const born{.from = ids[edge.from], .to = ids[edge.to], .weight = edge.weight};
      if (world.agents.contains(born.from) && world.agents.contains(born.to)) alive.push_back(born);
    }
    std::ranges::find(world.networks, of_rows.name(), &Network::name)->connect(std::move(alive));
  }
}

void require_living_ends(World<TableModel> const& world) {
  for (Network const& network : world.networks) {
    for (NetworkEdge const& edge : network.edges()) {
      for (Id const id : {edge.from, edge.to}) {
        if (world.agents.contains(id)) continue;
        throw Error({.what = "an edge of the network " + network.name() + " leads to agent " + std::to_string(id) +
                             ", which does not live",
                     .hint = "is this the checkpoint of this run?"});
      }
    }
  }
}

}  // namespace gridlock::python
