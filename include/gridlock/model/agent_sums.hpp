#pragma once

/// \file
/// Sums over the agents of a world, wherever they are.
///
/// ```cpp
/// #include "gridlock/core/disks.hpp"
///
/// struct Walkers {
///   using Agents = Population<X, Y>;
/// };
/// inline double mean_x(AgentSums<Walkers> const& agents) {
///   double const sum = agents.sum([](auto const& agent) { return agent.template get<X>(); });
///   return sum / static_cast<double>(agents.size());
/// }
/// ```

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "gridlock/core/detail/exact_sum.hpp"
#include "gridlock/core/detail/ranks.hpp"
#include "gridlock/core/world.hpp"

namespace gridlock {

/// Makes sums over the agents of one process those over all agents. Empty where it has all.
struct SumsOfAll {
  std::function<void(std::span<ExactSum>)> add_up;
  std::function<void(std::span<std::uint64_t>)> add_up_counts;
  std::function<double(double)> least;

  /// All ranks use it together, in the same order.
  static SumsOfAll over(Ranks& ranks);
};

/// What a model can ask of all agents of its world: sums over them, and extremes. Sums are exact and rounded once, so that their bits
/// depend neither on the order of the agents nor on how several processes divide them among themselves; no process needs all for it.
///
/// Cost: of a sum about 3 ns an agent, of an extreme 1 ns, and a round of messages where processes divide the agents.
template <class Model>
class AgentSums {
 public:
  using Agents = typename World<Model>::Agents;

  /// One agent, to be read.
  class Agent {
   public:
    Agent(Agents const& agents, std::size_t row) : agents_(agents), row_(row) {}
    [[nodiscard]] Id id() const { return agents_.ids()[row_]; }
    template <class Column>
    [[nodiscard]] typename Column::type get() const {
      return agents_.template column<Column>()[row_];
    }

   private:
    Agents const& agents_;
    std::size_t row_;
  };

  explicit AgentSums(World<Model> const& world, SumsOfAll of_all = {}) : world_(world), of_all_(std::move(of_all)) {}

  [[nodiscard]] Box const& box() const { return world_.box; }
  [[nodiscard]] Clock const& clock() const { return world_.clock; }

  /// How many agents there are.
  [[nodiscard]] std::uint64_t size() const {
    std::array<std::uint64_t, 1> count{world_.agents.size()};
    if (of_all_.add_up_counts) of_all_.add_up_counts(count);
    return count[0];
  }
  /// Σ term(agent), a number for each agent.
  template <class Term>
  [[nodiscard]] double sum(Term term) const {
    std::array<ExactSum, 1> sum;
    for (std::size_t row = 0; row < world_.agents.size(); ++row) sum[0].add(term(Agent(world_.agents, row)));
    if (of_all_.add_up) of_all_.add_up(sum);
    return sum[0].value();
  }
  /// The smallest and the largest term(agent); infinite where there are no agents.
  template <class Term>
  [[nodiscard]] double least(Term term) const {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t row = 0; row < world_.agents.size(); ++row)
      least = std::min(least, term(Agent(world_.agents, row)));
    return of_all_.least ? of_all_.least(least) : least;
  }
  template <class Term>
  [[nodiscard]] double largest(Term term) const {
    return -least([&](Agent const& agent) { return -term(agent); });
  }
  /// How many agents have the number 0, 1, 2 … values − 1 in a column.
  template <class Column>
  [[nodiscard]] std::vector<std::uint64_t> counts(std::size_t values) const {
    std::vector<std::uint64_t> counts(values);
    for (auto const value : world_.agents.template column<Column>()) {
      auto const k = static_cast<std::size_t>(value);
      if (k < counts.size()) ++counts[k];
    }
    if (of_all_.add_up_counts) of_all_.add_up_counts(counts);
    return counts;
  }

 private:
  World<Model> const& world_;
  SumsOfAll of_all_;
};

}  // namespace gridlock
