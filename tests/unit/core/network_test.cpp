#include "gridlock/core/network.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <set>
#include <utility>
#include <vector>

#include "gridlock/core/disks.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/core/random_graphs.hpp"
#include "gridlock/core/world.hpp"

namespace gridlock {
namespace {

std::vector<NetworkEdge> edges_of(Network const& network) { return {network.edges().begin(), network.edges().end()}; }

Network path_of_four() {
  Network network("path");
  network.connect({{.from = 3, .to = 2}, {.from = 0, .to = 1, .weight = 0.5}, {.from = 1, .to = 2}});
  return network;
}

TEST(Network, SortsItsEdgesWhateverTheirOrderWas) {
  std::vector<NetworkEdge> const sorted{{0, 1, 0.5}, {1, 2, 1.0}, {2, 3, 1.0}};
  EXPECT_EQ(edges_of(path_of_four()), sorted);
  Network again("path");
  again.connect({{.from = 2, .to = 3}});
  again.connect({{.from = 2, .to = 1}});
  again.connect({{.from = 1, .to = 0, .weight = 0.5}});
  EXPECT_EQ(again, path_of_four());
}

TEST(Network, HasAnEdgeInBothDirectionsUnlessItIsDirected) {
  Network network("net");
  network.connect({{.from = 4, .to = 2}});
  EXPECT_TRUE(network.has(2, 4));
  EXPECT_TRUE(network.has(4, 2));
  Network directed("net", true);
  directed.connect({{.from = 4, .to = 2}});
  EXPECT_FALSE(directed.has(2, 4));
  EXPECT_TRUE(directed.has(4, 2));
  directed.connect({{.from = 2, .to = 4}});
  EXPECT_EQ(directed.size(), 2);
}

TEST(Network, LosesEdgesByTheirEndsAndByTheirAgents) {
  Network network = path_of_four();
  network.disconnect({{.from = 2, .to = 1, .weight = 9.0}});
  EXPECT_EQ(edges_of(network), (std::vector<NetworkEdge>{{0, 1, 0.5}, {2, 3, 1.0}}));
  network.remove_agents(std::vector<Id>{1, 7});
  EXPECT_EQ(edges_of(network), (std::vector<NetworkEdge>{{2, 3, 1.0}}));
}

TEST(Network, StaysAsItWasWhenItRefusesEdges) {
  double const nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<std::vector<NetworkEdge>> const wrong{
      {{5, 6, 1.0}, {7, 7, 1.0}}, {{5, 6, 1.0}, {6, 5, 1.0}}, {{5, 6, 1.0}, {1, 0, 1.0}}, {{5, 6, 1.0}, {0, 2, nan}}};
  Network network = path_of_four();
  for (auto const& edges : wrong) EXPECT_THROW(network.connect(edges), Error);
  EXPECT_THROW(network.disconnect({{.from = 0, .to = 1}, {.from = 0, .to = 2}}), Error);
  EXPECT_THROW(network.set_weight(0, nan), Error);
  EXPECT_EQ(network, path_of_four());
}

TEST(Network, ChangesTheHashOfItsWorldWithEachEdgeAndWeight) {
  struct Walkers {
    using Agents = Population<X, Y>;
  };
  World<Walkers> world{.box = Box(1.0, 1.0, Edge::periodic), .seed = 7};
  std::set<std::uint64_t> hashes{hash(world)};
  world.networks.emplace_back("path");
  EXPECT_TRUE(hashes.insert(hash(world)).second);
  world.networks[0] = path_of_four();
  EXPECT_TRUE(hashes.insert(hash(world)).second);
  world.networks[0].set_weight(1, 2.0);
  EXPECT_TRUE(hashes.insert(hash(world)).second);
  world.networks.clear();
  EXPECT_FALSE(hashes.insert(hash(world)).second);
}

/// The bits of graphs are the same on all processors; they are those of their first version.
TEST(RandomGraphs, KeepTheirBits) {
  auto const hash_of = [](NodePairs const& pairs) {
    std::vector<std::uint64_t> words;
    for (auto const& pair : pairs) words.insert(words.end(), {pair[0], pair[1]});
    return hash_words(words);
  };
  RandomStream random(5, 0, 0, Purpose::model_network);
  EXPECT_EQ(hash_of(random_graph(500, 0.02, PairsOfNodes::once, random)), 0x98ad0255b19cddd4U);
  EXPECT_EQ(hash_of(random_graph(60, 0.8, PairsOfNodes::both_ways, random)), 0xc92527ead3921a76U);
  EXPECT_EQ(hash_of(random_graph_of(500, 700, PairsOfNodes::once, random)), 0x4c755535f2c6b3e0U);
  EXPECT_EQ(hash_of(small_world_graph(500, {.degree = 6, .rewiring = 0.3}, random)), 0x11506d8b728fa489U);
  EXPECT_EQ(hash_of(scale_free_graph(500, 3, random)), 0xb3ac5b12e0a267c5U);
}

TEST(RandomGraphs, HaveNoEdgeTwiceAndNoneFromANodeToItself) {
  RandomStream random(6, 0, 0, Purpose::model_network);
  for (std::uint32_t const nodes : {2U, 3U, 8U, 9U, 40U}) {
    for (double const probability : {0.1, 0.5, 0.9, 1.0}) {
      for (PairsOfNodes const pairs : {PairsOfNodes::once, PairsOfNodes::both_ways}) {
        Network network("net", pairs == PairsOfNodes::both_ways);
        std::vector<NetworkEdge> edges;
        for (auto const& pair : random_graph(nodes, probability, pairs, random)) edges.push_back({pair[0], pair[1]});
        EXPECT_NO_THROW(network.connect(edges)) << nodes << " nodes, probability " << probability;
        std::uint64_t const all = nodes * (nodes - 1) / (network.is_directed() ? 1 : 2);
        if (probability == 1.0) {
          EXPECT_EQ(network.size(), all);
        }
      }
    }
  }
}

TEST(RandomGraphs, OfNoNodesHaveNoEdges) {
  RandomStream random(6, 0, 0, Purpose::model_network);
  EXPECT_TRUE(random_graph(0, 0.5, PairsOfNodes::once, random).empty());
  EXPECT_TRUE(random_graph(1, 1.0, PairsOfNodes::both_ways, random).empty());
  EXPECT_THROW(scale_free_graph(0, 1, random), Error);
  EXPECT_THROW(small_world_graph(2, {.degree = 2, .rewiring = 0.5}, random), Error);
}

}  // namespace
}  // namespace gridlock
