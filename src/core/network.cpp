#include "gridlock/core/network.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <tuple>
#include <utility>

#include "gridlock/core/error.hpp"
#include "gridlock/core/world.hpp"

namespace gridlock {

namespace {

std::pair<Id, Id> ends_of(NetworkEdge const& edge) { return {edge.from, edge.to}; }

void require_finite_weight(std::string const& network, NetworkEdge const& edge) {
  if (std::isfinite(edge.weight)) return;
  throw Error({.what = fmt::format("an edge of the network {} between the agents {} and {} has the weight {}", network,
                                   edge.from, edge.to, edge.weight),
               .hint = "use finite numbers"});
}

[[noreturn]] void refuse_edge(char const* what, std::string const& network, NetworkEdge const& edge, char const* hint) {
  throw Error(
      {.what = fmt::format("{} in the network {}: agents {} and {}", what, network, edge.from, edge.to), .hint = hint});
}

/// Throws Error for the first edge of an agent to itself, and for two between the same agents. Contract: sorted edges.
void require_simple(std::string const& network, std::span<NetworkEdge const> edges) {
  for (NetworkEdge const& edge : edges) {
    require_finite_weight(network, edge);
    if (edge.from == edge.to) {
      throw Error({.what = fmt::format("agent {} has an edge to itself in the network {}", edge.from, network),
                   .hint = "join two agents"});
    }
  }
  auto const twice = std::ranges::adjacent_find(edges, {}, ends_of);
  if (twice != edges.end())
    refuse_edge("an edge is there twice", network, *twice, "add an edge once, and give it a weight");
}

}  // namespace

Network::Network(std::string name, bool is_directed) : name_(std::move(name)), is_directed_(is_directed) {}

bool Network::has(Id from, Id to) const {
  if (!is_directed_ && to < from) std::swap(from, to);
  return std::ranges::binary_search(edges_, std::pair(from, to), {}, ends_of);
}

void Network::put_in_order(std::vector<NetworkEdge>& edges) const {
  if (!is_directed_) {
    for (NetworkEdge& edge : edges) {
      if (edge.to < edge.from) std::swap(edge.from, edge.to);
    }
  }
  std::ranges::sort(edges, {}, ends_of);
}

void Network::connect(std::vector<NetworkEdge> edges) {
  put_in_order(edges);
  require_simple(name_, edges);
  std::vector<NetworkEdge> all;
  all.reserve(edges_.size() + edges.size());
  std::ranges::merge(edges_, edges, std::back_inserter(all), {}, ends_of, ends_of);
  require_simple(name_, all);
  edges_ = std::move(all);
}

void Network::disconnect(std::vector<NetworkEdge> edges) {
  put_in_order(edges);
  require_simple(name_, edges);
  std::vector<NetworkEdge> left;
  left.reserve(edges_.size());
  std::ranges::set_difference(edges_, edges, std::back_inserter(left), {}, ends_of, ends_of);
  if (left.size() + edges.size() != edges_.size()) {
    auto const missing = std::ranges::find_if(edges, [&](NetworkEdge const& edge) { return !has(edge.from, edge.to); });
    refuse_edge("there is no such edge", name_, *missing, "remove edges that there are, each once");
  }
  edges_ = std::move(left);
}

void Network::set_weight(std::size_t edge, double weight) {
  NetworkEdge changed = edges_.at(edge);
  changed.weight = weight;
  require_finite_weight(name_, changed);
  edges_[edge] = changed;
}

void Network::remove_agents(std::span<Id const> ids) {
  if (ids.empty()) return;
  auto const is_gone = [&](Id id) { return std::ranges::binary_search(ids, id); };
  std::erase_if(edges_, [&](NetworkEdge const& edge) { return is_gone(edge.from) || is_gone(edge.to); });
}

void Network::serialize(Archive& archive) {
  std::vector<Id> ends;
  std::vector<double> weights;
  for (NetworkEdge const& edge : edges_) {
    ends.insert(ends.end(), {edge.from, edge.to});
    weights.push_back(edge.weight);
  }
  serialize_inside(archive, name_, [&] {
    bool is_directed = is_directed_;
    archive.visit("directed", is_directed);
    archive.require(is_directed == is_directed_, "a network is directed in one of checkpoint and model only");
    archive.visit("ends", ends);
    archive.visit("weights", weights);
  });
  if (!archive.is_restoring()) return;
  archive.require(ends.size() == 2 * weights.size(), "a network has another number of weights than of edges");
  std::vector<NetworkEdge> edges(weights.size());
  for (std::size_t k = 0; k < edges.size(); ++k) edges[k] = {ends[2 * k], ends[2 * k + 1], weights[k]};
  edges_.clear();
  connect(std::move(edges));
}

std::uint64_t hash_with_networks(std::uint64_t hash_without, std::span<Network const> networks) {
  if (networks.empty()) return hash_without;
  std::vector<std::uint64_t> record{hash_without};
  std::vector<std::uint64_t> words;
  for (Network const& network : networks) {
    words.clear();
    words.reserve(3 * network.size());
    for (NetworkEdge const& edge : network.edges())
      words.insert(words.end(), {edge.from, edge.to, word_of(edge.weight)});
    record.insert(record.end(), {network.is_directed() ? 1U : 0U, network.size(), hash_words(words)});
  }
  return hash_words(record);
}

}  // namespace gridlock
