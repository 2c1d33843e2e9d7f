#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <type_traits>

namespace gridlock {

/// Two agents by their numbers. Kernels write it as one number of 64 bits, the first agent in its lower half.
struct AgentPair {
  std::uint32_t first;
  std::uint32_t second;
  friend bool operator==(AgentPair const&, AgentPair const&) = default;
};

/// Takes a portion of pairs, none to 1,024 of them.
using OnPairs = std::function<void(std::span<AgentPair const>)>;

/// Whether most pairs of a portion are of agents whose numbers are far from each other, by a sample.
bool are_scattered(std::span<AgentPair const> pairs);

/// Asks for nothing before a pair is visited.
struct ExpectNothing {
  void operator()(std::size_t, std::size_t) const {}
};

/// visit_pairs() for scattered ones. By itself, or it would change how the loop over agents near each other in memory
/// is compiled.
template <class Visit, class Expect>
[[gnu::noinline]] void visit_pairs_ahead(std::span<AgentPair const> pairs, Visit& visit, Expect& expect) {
  constexpr std::size_t ahead = 48;
  auto const first = pairs.first(std::min(ahead, pairs.size()));
  for (AgentPair const& pair : first) expect(std::size_t{pair.first}, std::size_t{pair.second});
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (k + ahead < pairs.size()) expect(std::size_t{pairs[k + ahead].first}, std::size_t{pairs[k + ahead].second});
    visit(std::size_t{pairs[k].first}, std::size_t{pairs[k].second});
  }
}

/// Calls visit(i, j) for each pair of a portion. Where agents near each other have numbers far from each other,
/// expect(i, j) is called some pairs before, to ask for memory.
template <class Visit, class Expect>
void visit_pairs(std::span<AgentPair const> pairs, Visit& visit, Expect& expect) {
  if constexpr (!std::is_same_v<Expect, ExpectNothing>) {
    if (are_scattered(pairs)) [[unlikely]] {
      visit_pairs_ahead(pairs, visit, expect);
      return;
    }
  }
  for (AgentPair const& pair : pairs) visit(std::size_t{pair.first}, std::size_t{pair.second});
}

}  // namespace gridlock
