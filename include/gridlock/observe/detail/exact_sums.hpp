#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "gridlock/core/detail/exact_sum.hpp"

namespace gridlock {

/// Adds the terms of agents 0 … agents − 1 to sums; terms_of(i) returns one term for each sum. Sums are exact, so that
/// their bits do not depend on the order of the rows or on their division among processes.
/// Cost: about 1 ns a term.
template <std::size_t count, class TermsOf>
void add_terms(std::array<ExactSum, count>& sums, std::size_t agents, TermsOf terms_of) {
  constexpr std::size_t at_once = 512;
  std::array<std::array<double, at_once>, count> terms;
  for (std::size_t first = 0; first < agents; first += at_once) {
    std::size_t const some = std::min(at_once, agents - first);
    for (std::size_t k = 0; k < some; ++k) {
      std::array<double, count> const of_agent = terms_of(first + k);
      for (std::size_t s = 0; s < count; ++s) terms[s][k] = of_agent[s];
    }
    for (std::size_t s = 0; s < count; ++s) sums[s].add(std::span<double const>(terms[s]).first(some));
  }
}

/// Adds terms to `count` exact sums for each of several blocks of agents.
template <std::size_t blocks, std::size_t count>
class SumsOfBlocks {
 public:
  /// Adds one term to each sum of a block.
  void add(std::size_t block, std::array<double, count> const& terms) {
    Gathered& gathered = gathered_[block];
    for (std::size_t s = 0; s < count; ++s) gathered.terms[s][gathered.agents] = terms[s];
    if (++gathered.agents == at_once) take(block);
  }
  /// Returns all sums; those of block b begin at index b · count.
  [[nodiscard]] std::vector<ExactSum> take_all() {
    for (std::size_t block = 0; block < blocks; ++block) take(block);
    return std::move(sums_);
  }

 private:
  static constexpr std::size_t at_once = 256;
  /// Terms that are added to the sums together later, which is faster.
  struct Gathered {
    std::array<std::array<double, at_once>, count> terms;
    std::size_t agents = 0;
  };
  void take(std::size_t block) {
    Gathered& gathered = gathered_[block];
    for (std::size_t s = 0; s < count; ++s) {
      sums_[block * count + s].add(std::span<double const>(gathered.terms[s]).first(gathered.agents));
    }
    gathered.agents = 0;
  }

  std::vector<Gathered> gathered_ = std::vector<Gathered>(blocks);
  std::vector<ExactSum> sums_ = std::vector<ExactSum>(blocks * count);
};

}  // namespace gridlock
