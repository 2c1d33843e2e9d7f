#include "gridlock/core/random_graphs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <unordered_set>

#include "gridlock/core/error.hpp"

namespace gridlock {

namespace {

/// More edges than this are a mistake: they take 6 GB.
constexpr std::uint64_t max_edges = std::uint64_t{1} << 28;

void require_room_for(double edges) {
  if (edges <= static_cast<double>(max_edges)) return;
  throw Error({.what = fmt::format("a network is to have about {:.3g} edges", edges),
               .hint = fmt::format("use fewer than {}", max_edges)});
}

void require_probability(char const* what, double probability) {
  if (probability >= 0.0 && probability <= 1.0) return;
  throw Error({.what = fmt::format("the probability {} is {}", what, probability), .hint = "use a number from 0 to 1"});
}

std::uint64_t number_of_pairs(std::uint64_t nodes, PairsOfNodes pairs) {
  if (nodes == 0) return 0;
  return pairs == PairsOfNodes::once ? nodes * (nodes - 1) / 2 : nodes * (nodes - 1);
}

/// Returns pair number `number`: those of neighbours on a ring first, then those of second neighbours, and so on. With
/// half of the distances each pair comes once.
std::array<std::uint32_t, 2> pair_of(std::uint64_t number, std::uint64_t nodes) {
  std::uint64_t const first = number % nodes;
  std::uint64_t const second = (first + number / nodes + 1) % nodes;
  return {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(second)};
}

/// Draws `count` different numbers below `bound`, all sets with the same probability (R. W. Floyd, 1987,
/// doi:10.1145/30401.315746), and appends their pairs.
void draw_pairs(std::uint64_t first, std::uint64_t bound, std::uint64_t count, std::uint64_t nodes,
                RandomStream& random, NodePairs& drawn) {
  std::unordered_set<std::uint64_t> taken;
  taken.reserve(count);
  for (std::uint64_t last = bound - count; last < bound; ++last) {
    std::uint64_t const number = random.below(last + 1);
    std::uint64_t const added = taken.insert(number).second ? number : last;
    if (added == last) taken.insert(last);
    drawn.push_back(pair_of(first + added, nodes));
  }
}

/// Draws a binomial number by inversion; `none` is (1 − p)^trials. Contract: p ≤ 1/2, and trials · p is a few tens.
std::uint64_t binomial(std::uint64_t trials, double probability, double none, RandomStream& random) {
  double left = random.uniform();
  double chance = none;
  std::uint64_t count = 0;
  while (left >= chance && count < trials) {
    left -= chance;
    chance *=
        static_cast<double>(trials - count) / static_cast<double>(count + 1) * (probability / (1.0 - probability));
    ++count;
  }
  return count;
}

double power(double base, std::uint64_t exponent) {
  double result = 1.0;
  for (; exponent > 0; exponent /= 2, base *= base) {
    if (exponent % 2 == 1) result *= base;
  }
  return result;
}

std::uint64_t key_of(std::uint64_t a, std::uint64_t b) { return std::min(a, b) << 32 | std::max(a, b); }

}  // namespace

NodePairs random_graph(std::uint32_t nodes, double probability, PairsOfNodes pairs, RandomStream& random) {
  require_probability("of an edge", probability);
  std::uint64_t const all = number_of_pairs(nodes, pairs);
  require_room_for(probability * static_cast<double>(all));
  NodePairs drawn;
  if (probability == 0.0 || all == 0) return drawn;
  // The missing edges are drawn where there are many, so that (1 − p)^block stays far above the smallest numbers.
  bool const draws_missing = probability > 0.5;
  double const chance = draws_missing ? 1.0 - probability : probability;
  constexpr double mean_of_block = 16.0;
  constexpr double longest_block = 1e15;
  auto const block =
      static_cast<std::uint64_t>(chance > 0.0 ? std::min(mean_of_block / chance, longest_block) : longest_block);
  double const none = power(1.0 - chance, block);
  for (std::uint64_t first = 0; first < all; first += block) {
    std::uint64_t const size = std::min(block, all - first);
    std::uint64_t const count = binomial(size, chance, size == block ? none : power(1.0 - chance, size), random);
    draw_pairs(first, size, count, nodes, random, drawn);
  }
  if (!draws_missing) return drawn;
  std::unordered_set<std::uint64_t> missing;
  auto const key = [](auto const& pair) { return std::uint64_t{pair[0]} << 32 | pair[1]; };
  for (auto const& pair : drawn) missing.insert(key(pair));
  NodePairs present;
  for (std::uint64_t number = 0; number < all; ++number) {
    if (auto const pair = pair_of(number, nodes); !missing.contains(key(pair))) present.push_back(pair);
  }
  return present;
}

NodePairs random_graph_of(std::uint32_t nodes, std::uint64_t edges, PairsOfNodes pairs, RandomStream& random) {
  std::uint64_t const all = number_of_pairs(nodes, pairs);
  if (edges > all) {
    throw Error({.what = fmt::format("a network of {} agents is to have {} edges", nodes, edges),
                 .hint = fmt::format("they have {} pairs", all)});
  }
  require_room_for(static_cast<double>(edges));
  NodePairs drawn;
  draw_pairs(0, all, edges, nodes, random, drawn);
  return drawn;
}

NodePairs small_world_graph(std::uint32_t nodes, SmallWorld const& settings, RandomStream& random) {
  require_probability("that an edge is moved", settings.rewiring);
  if (settings.degree % 2 == 1 || settings.degree == 0 || settings.degree >= nodes) {
    throw Error(
        {.what = fmt::format("each of {} agents of a small world is to have {} neighbours", nodes, settings.degree),
         .hint = "use an even number from 2 on, below the number of agents"});
  }
  std::uint64_t const rings = settings.degree / 2;
  require_room_for(static_cast<double>(rings) * nodes);
  NodePairs pairs;
  for (std::uint64_t number = 0; number < rings * nodes; ++number) pairs.push_back(pair_of(number, nodes));
  std::unordered_set<std::uint64_t> present;
  std::vector<std::uint64_t> degrees(nodes, settings.degree);
  for (auto const& pair : pairs) present.insert(key_of(pair[0], pair[1]));
  for (auto& [kept, moved] : pairs) {
    if (random.uniform() >= settings.rewiring || degrees[kept] + 1 >= nodes) continue;
    auto other = static_cast<std::uint32_t>(random.below(nodes));
    while (other == kept || present.contains(key_of(kept, other)))
      other = static_cast<std::uint32_t>(random.below(nodes));
    present.erase(key_of(kept, moved));
    present.insert(key_of(kept, other));
    --degrees[moved];
    ++degrees[other];
    moved = other;
  }
  return pairs;
}

NodePairs scale_free_graph(std::uint32_t nodes, std::uint64_t edges_per_node, RandomStream& random) {
  if (edges_per_node == 0 || edges_per_node >= nodes) {
    throw Error({.what = fmt::format("each of {} agents of a scale-free network is to come with {} edges", nodes,
                                     edges_per_node),
                 .hint = "use a number from 1 on, below the number of agents"});
  }
  auto const first = static_cast<std::uint32_t>(edges_per_node);
  require_room_for(static_cast<double>(edges_per_node) * (nodes - first));
  NodePairs pairs;
  for (std::uint32_t leaf = 1; leaf <= first; ++leaf) pairs.push_back({0, leaf});
  std::vector<std::uint32_t> chosen;
  for (std::uint32_t node = first + 1; node < nodes; ++node) {
    chosen.clear();
    std::uint64_t const ends = 2 * pairs.size();
    while (chosen.size() < first) {
      // Each node is an end of as many edges as its degree is.
      std::uint64_t const end = random.below(ends);
      std::uint32_t const target = pairs[end / 2][end % 2];
      if (std::ranges::find(chosen, target) == chosen.end()) chosen.push_back(target);
    }
    for (std::uint32_t const target : chosen) pairs.push_back({target, node});
  }
  return pairs;
}

}  // namespace gridlock
