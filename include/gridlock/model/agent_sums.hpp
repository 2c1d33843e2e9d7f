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
#include <limits>
#include <span>
#include <vector>

#include "gridlock/core/detail/exact_sum.hpp"
#include "gridlock/core/world.hpp"
#include "gridlock/parallel/detail/all_processes.hpp"

namespace gridlock {

/// Sums over all agents of the world of a model, and extremes. Sums are exact and rounded once, so that their bits
/// depend neither on the order of the agents nor on how several processes divide them among themselves; no process
/// needs all for it.
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

  explicit AgentSums(World<Model> const& world, AllProcesses processes = {}) : world_(world), processes_(processes) {}

  [[nodiscard]] Box const& box() const { return world_.box; }
  [[nodiscard]] Clock const& clock() const { return world_.clock; }

  /// How many agents there are.
  [[nodiscard]] std::uint64_t size() const {
    std::array<std::uint64_t, 1> count{world_.agents.size()};
    processes_.sum(count);
    return count[0];
  }
  /// Σ term(agent), a number for each agent.
  template <class Term>
  [[nodiscard]] double sum(Term term) const {
    std::array<ExactSum, 1> sum;
    for (std::size_t row = 0; row < world_.agents.size(); ++row) sum[0].add(term(Agent(world_.agents, row)));
    processes_.sum(sum);
    return sum[0].value();
  }
  /// The minimum and the maximum of term(agent); infinite where there are no agents.
  template <class Term>
  [[nodiscard]] double min(Term term) const {
    double min = std::numeric_limits<double>::infinity();
    for (std::size_t row = 0; row < world_.agents.size(); ++row) min = std::min(min, term(Agent(world_.agents, row)));
    return processes_.min(min);
  }
  template <class Term>
  [[nodiscard]] double max(Term term) const {
    return -min([&](Agent const& agent) { return -term(agent); });
  }
  /// How many agents have the number 0, 1, 2 … values − 1 in a column.
  template <class Column>
  [[nodiscard]] std::vector<std::uint64_t> counts(std::size_t values) const {
    std::vector<std::uint64_t> counts(values);
    for (auto const value : world_.agents.template column<Column>()) {
      auto const k = static_cast<std::size_t>(value);
      if (k < counts.size()) ++counts[k];
    }
    processes_.sum(counts);
    return counts;
  }

 private:
  World<Model> const& world_;
  AllProcesses processes_;
};

}  // namespace gridlock
