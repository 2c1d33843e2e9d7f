#pragma once

/// \file
/// A snapshot gives observables the agents of a world, and sums over all of its agents.
///
/// ```cpp
/// State state{.box = Box(2.0, 1.0, Edge::wall)};
/// state.agents.add(0.5, 0.5, 3.0, 4.0, 0.1, 1.0, 0, 0);
/// state.agents.add(1.5, 0.5, 0.0, 1.0, 0.1, 1.0, 0, 0);
/// Counters const counters;
/// Snapshot const now(state, counters);
/// auto const vx = now.agents.column<VelocityX>();
/// auto const vy = now.agents.column<VelocityY>();
/// auto const speed = [&](std::size_t i) { return std::hypot(vx[i], vy[i]); };
/// double const mean_speed = now.sum(speed) / static_cast<double>(now.count());  // 3
/// double const max_speed = now.max(speed);                                      // 5
/// ```

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>

#include "gridlock/core/agents_view.hpp"
#include "gridlock/core/box.hpp"
#include "gridlock/core/counters.hpp"
#include "gridlock/core/detail/exact_sum.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/core/vector.hpp"
#include "gridlock/core/world.hpp"
#include "gridlock/observe/detail/attached.hpp"
#include "gridlock/observe/detail/exact_sums.hpp"
#include "gridlock/parallel/detail/all_processes.hpp"

namespace gridlock {

/// The kinetic energy and the temperature at one time; see src/observe/motion.hpp.
struct MeasuredMotion {
  double kinetic_energy = 0.0;
  std::optional<double> temperature;
  std::size_t moving = 0;  ///< number of agents that are not fixed
};

/// Two agents nearer than a cutoff.
struct NearPair {
  std::size_t i;      ///< number of the first agent: in a run of one process its row
  std::size_t j;      ///< number of the second agent
  Vector separation;  ///< r_j − r_i, to the nearest image in a periodic box
  /// Number of the two agents that this process owns: its sum over the pairs of all processes is twice the number of
  /// pairs.
  std::uint32_t own;
};

/// A world of any model at one time: the agents, the clock, and the counters since the start of the run.
///
/// If several processes share a run, each has a snapshot with the agents of this process in `agents`, while the
/// functions below combine all agents. Each process calls them in the same order, and gets the same bits as a run of
/// one process. So an observable that uses them gives the same results on any number of processes.
struct Snapshot {
  template <class Model>
  Snapshot(World<Model> const& world, Counters const& what_happened)
      : Snapshot(world, what_happened, AllProcesses(), world.agents.size()) {}
  /// Makes the snapshot of one of several processes, which have `count` agents together.
  template <class Model>
  Snapshot(World<Model> const& world, Counters const& what_happened, AllProcesses sharing, std::size_t count,
           AttachedColumns attached_to_agents = {})
      : box(world.box),
        clock(world.clock),
        agents(world.agents),
        counters(what_happened),
        processes(sharing),
        count_(count),
        attached_(std::move(attached_to_agents)) {}

  /// Returns the number of agents of all processes.
  [[nodiscard]] std::size_t count() const { return count_; }

  /// Returns Σ_i term_of(i) over all agents, where i is a row of `agents`; term_of() returns a number, or an array of
  /// numbers with a sum for each. The sum is exact and rounded once, so it does not depend on the order of the rows.
  /// Cost: about 1 ns a term.
  template <class TermOf>
  requires std::invocable<TermOf&, std::size_t>
  [[nodiscard]] auto sum(TermOf term_of) const {
    using Term = std::invoke_result_t<TermOf&, std::size_t>;
    if constexpr (std::is_convertible_v<Term, double>) {
      auto const one = [&](std::size_t i) { return std::array{static_cast<double>(term_of(i))}; };
      return values_of_sums<1>(one)[0];
    } else {
      return values_of_sums<std::tuple_size_v<Term>>(term_of);
    }
  }
  /// Replaces each sum over the agents of this process by the sum over all agents.
  void sum(std::span<ExactSum> sums) const { processes.sum(sums); }
  /// Replaces each count of agents of this process by the count of all agents.
  void counts(std::span<std::uint64_t> own) const { processes.sum(own); }

  /// Returns min_i value_of(i) over all agents; infinity for no agents.
  template <class ValueOf>
  [[nodiscard]] double min(ValueOf value_of) const {
    double min = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < agents.size(); ++i) min = std::min<double>(min, value_of(i));
    return processes.min(min);
  }
  /// Returns max_i value_of(i) over all agents; −infinity for no agents.
  template <class ValueOf>
  [[nodiscard]] double max(ValueOf value_of) const {
    return -min([&](std::size_t i) { return -static_cast<double>(value_of(i)); });
  }

  /// Calls visit(NearPair) for every pair nearer than the cutoff with an agent of this process. Include
  /// gridlock/observe/pairs.hpp, which defines it. Contract: the agents have x and y; in a periodic box the cutoff is
  /// at most half the shorter side.
  /// Cost: O(N) for a cutoff of a few diameters.
  template <class Visit>
  void pairs(double cutoff, Visit visit) const;

  /// Attaches value_of(i) to each agent: in later snapshots, find(id, row) of the result returns the value.
  template <class Value, class ValueOf>
  [[nodiscard]] Attached<Value> attached(ValueOf value_of) const {
    return Attached<Value>(attached_, agents, std::move(value_of));
  }
  /// Attaches no values yet; values restored from a checkpoint are put there.
  template <class Value>
  [[nodiscard]] Attached<Value> attached() const {
    return Attached<Value>(attached_);
  }

  Box const& box;
  Clock clock;
  AgentsView agents;                                  ///< agents of this process
  Counters const& counters;                           ///< sums over all processes
  AllProcesses processes;                             ///< processes that share the run
  mutable std::optional<MeasuredMotion> motion = {};  ///< stored by the first observable that computes it, for the
                                                      ///< others

 private:
  template <std::size_t terms, class TermsOf>
  [[nodiscard]] std::array<double, terms> values_of_sums(TermsOf const& terms_of) const {
    std::array<ExactSum, terms> sums;
    add_terms(sums, agents.size(), terms_of);
    sum(sums);
    std::array<double, terms> values;
    for (std::size_t k = 0; k < terms; ++k) values[k] = sums[k].value();
    return values;
  }

  std::size_t count_;
  AttachedColumns attached_;  ///< columns attached to the agents of the simulation
};

}  // namespace gridlock
