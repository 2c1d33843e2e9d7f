#pragma once

/// \file
/// Graphs that are drawn at random, as the edges of networks are at a start. Nodes are 0 … N − 1.
///
/// ```cpp
/// RandomStream random(7, 0, 0, Purpose::model_network);
/// NodePairs const ring = small_world_graph(1000, {.degree = 6, .rewiring = 0.1}, random);
/// NodePairs const hubs = scale_free_graph(1000, 3, random);
/// std::uint32_t const oldest = hubs[0][0];
/// ```

#include <array>
#include <cstdint>
#include <vector>

#include "gridlock/core/random.hpp"

namespace gridlock {

/// The two nodes of each edge. No edge joins a node with itself, none is there twice.
using NodePairs = std::vector<std::array<std::uint32_t, 2>>;

/// The pairs of nodes that may have an edge: each pair once, or once in each direction.
enum class PairsOfNodes { once, both_ways };

/// Returns the graph G(N, p), in which each pair of nodes has an edge with the same probability, without regard to the
/// others (E. N. Gilbert, 1959, doi:10.1214/aoms/1177706098).
///
/// No logarithm is needed: the pairs are taken in blocks, each with a binomial number of edges, so all processors draw
/// the same graph. Errors: Error for a probability outside 0 to 1, and for more edges than memory is for. Cost: about
/// 150 ns an edge.
NodePairs random_graph(std::uint32_t nodes, double probability, PairsOfNodes pairs, RandomStream& random);

/// Returns the graph G(N, M), in which all sets of M pairs of nodes are equally probable (P. Erdős and A. Rényi, 1959,
/// Publicationes Mathematicae 6, 290). Errors: Error for more edges than pairs. Cost: about 150 ns an edge.
NodePairs random_graph_of(std::uint32_t nodes, std::uint64_t edges, PairsOfNodes pairs, RandomStream& random);

/// A ring in which each node has edges to its `degree` nearest nodes, an even number, of which each edge is moved with
/// the probability `rewiring`.
struct SmallWorld {
  std::uint64_t degree = 4;
  double rewiring = 0.1;
};
/// Returns the small-world graph of D. J. Watts and S. H. Strogatz, 1998, doi:10.1038/30918: a moved edge keeps one of
/// its nodes, and the other is drawn among those that it has no edge to. Errors: Error for an odd degree, for one
/// that is not below N, and a probability outside 0 to 1. Cost: about 150 ns an edge.
NodePairs small_world_graph(std::uint32_t nodes, SmallWorld const& settings, RandomStream& random);

/// Returns the scale-free graph of A.-L. Barabási and R. Albert, 1999, doi:10.1126/science.286.5439.509: nodes come one
/// after the other, each with `edges_per_node` edges to nodes that are drawn with a probability proportional to their
/// degrees. It begins with a star of edges_per_node + 1 nodes. Errors: Error unless 1 ≤ edges_per_node < N. Cost: about
/// 100 ns an edge.
NodePairs scale_free_graph(std::uint32_t nodes, std::uint64_t edges_per_node, RandomStream& random);

}  // namespace gridlock
