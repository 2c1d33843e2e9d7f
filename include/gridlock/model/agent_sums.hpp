#pragma once

/// \file
/// Sums over the agents of a world, which several processes may share.
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

/// Sums, minima and maxima over all agents of the world of a model. A sum is exact and rounded once, so that its bits
/// depend neither on the order of the agents nor on how several processes divide them. Each process reads only its own
/// agents.
///
/// Cost: about 3 ns an agent for a sum, 1 ns for a minimum or maximum, and one round of messages among processes.
template <class Model>
class AgentSums {
 public:
  using Agents = typename World<Model>::Agents;

  /// Reads the columns of one agent.
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

  [[nodiscard]] std::uint64_t size() const {
    std::array<std::uint64_t, 1> count{world_.agents.size()};
    processes_.sum(count);
    return count[0];
  }
  /// Returns Σ term(agent) over all agents.
  template <class Term>
  [[nodiscard]] double sum(Term term) const {
    std::array<ExactSum, 1> sum;
    for (std::size_t row = 0; row < world_.agents.size(); ++row) sum[0].add(term(Agent(world_.agents, row)));
    processes_.sum(sum);
    return sum[0].value();
  }
  /// Return the minimum and the maximum of term(agent) over all agents; without agents +∞ and −∞.
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
  /// Returns the number of agents with each value 0, 1, 2 … values − 1 in a column.
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
