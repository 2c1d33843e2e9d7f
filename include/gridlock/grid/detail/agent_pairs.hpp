#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <type_traits>

namespace gridlock {

/// The numbers of two agents. Kernels write a pair as an integer of 64 bits with the first agent in its lower half.
struct AgentPair {
  std::uint32_t first;
  std::uint32_t second;
  friend bool operator==(AgentPair const&, AgentPair const&) = default;
};

/// A function that takes a portion of 0 to 1,024 pairs.
using OnPairs = std::function<void(std::span<AgentPair const>)>;

/// Returns whether the two agents of most pairs have numbers far from each other, by a sample of the pairs.
bool are_scattered(std::span<AgentPair const> pairs);

/// Prefetches nothing before a pair is visited.
struct ExpectNothing {
  void operator()(std::size_t, std::size_t) const {}
};

/// Visits pairs and prefetches later ones, see visit_pairs(). Not inlined: otherwise the compiler makes the loop of
/// visit_pairs() slower.
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

/// Calls visit(i, j) for each pair of a portion. If are_scattered(pairs), it calls expect(i, j) some pairs earlier, to
/// prefetch memory.
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
