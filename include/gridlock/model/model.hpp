#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "gridlock/core/disks.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/core/setting.hpp"
#include "gridlock/core/vector.hpp"
#include "gridlock/model/agent_sums.hpp"
#include "gridlock/model/model_engine.hpp"
#include "gridlock/model/move_apart.hpp"
#include "gridlock/model/networks.hpp"

namespace gridlock {

/// The quantities that a model measures at one time, each with a name and a number. The names are the same at all
/// times.
///
/// ```cpp
/// Observations now;
/// now.add("temperature", 1.5, "Mean kinetic energy.");
/// double const value = now.entries().front().value;
/// ```
class Observations {
 public:
  struct Entry {
    std::string name;
    double value = 0.0;
    std::string documentation;
  };

  void add(std::string_view name, double value, std::string_view documentation = {}) {
    entries_.push_back({std::string(name), value, std::string(documentation)});
  }

  /// Adds the number of agents with the value k in a column under names[k], for k = 0, 1, 2 …
  template <class Column, class Agents>
  void add_counts(Agents const& agents, std::initializer_list<std::string_view> names) {
    add_counts<Column>(agents, std::span(names.begin(), names.size()));
  }
  /// Adds the number of agents with the value k in a column under Column::value_names[k].
  template <class Column, class Agents>
  void add_counts(Agents const& agents) {
    add_counts<Column>(agents, std::span<std::string_view const>(Column::value_names));
  }
  template <class Column, class Agents>
  void add_counts(Agents const& agents, std::span<std::string_view const> names) {
    std::vector<double> counts(names.size());
    for (auto const group : agents.template column<Column>()) {
      auto const k = static_cast<std::size_t>(group);
      if (k < counts.size()) counts[k] += 1.0;
    }
    add_each(names, counts, "Agents of this kind.");
  }

  /// Adds the number of agents with the value k in a column under names[k], counted in all processes.
  template <class Column, class Model>
  void add_counts(AgentSums<Model> const& agents, std::initializer_list<std::string_view> names) {
    add_counts<Column>(agents, std::span(names.begin(), names.size()));
  }
  template <class Column, class Model>
  void add_counts(AgentSums<Model> const& agents) {
    add_counts<Column>(agents, std::span<std::string_view const>(Column::value_names));
  }
  template <class Column, class Model>
  void add_counts(AgentSums<Model> const& agents, std::span<std::string_view const> names) {
    std::vector<std::uint64_t> const counts = agents.template counts<Column>(names.size());
    add_each(names, {counts.begin(), counts.end()}, "Agents of this kind.");
  }

  /// Adds, under names[k], the mean of measure(row) over the agents with the value k in a column; NaN if there are
  /// none.
  template <class Column, class Agents, class Measure>
  void add_means(Agents const& agents, std::initializer_list<std::string_view> names, Measure measure) {
    std::vector<double> sums(names.size());
    std::vector<double> counts(names.size());
    for (std::size_t row = 0; row < agents.size(); ++row) {
      auto const k = static_cast<std::size_t>(agents.template column<Column>()[row]);
      if (k >= sums.size()) continue;
      sums[k] += measure(row);
      counts[k] += 1.0;
    }
    for (std::size_t k = 0; k < sums.size(); ++k) sums[k] /= counts[k];
    add_each({names.begin(), names.size()}, sums, "Mean over the agents of this kind.");
  }

  [[nodiscard]] std::vector<Entry> const& entries() const { return entries_; }

 private:
  void add_each(std::span<std::string_view const> names, std::vector<double> const& values,
                std::string_view documentation) {
    std::size_t k = 0;
    for (std::string_view const name : names) add(name, values[k++], documentation);
  }

  std::vector<Entry> entries_;
};

/// Returns whether processes can divide the agents of a model, so that no process has all of them. The model must be
/// synchronous or tiled, read all agents only through AgentSums, and have no fields, networks and is_awake().
template <class Model>
consteval bool can_be_divided() {
  constexpr bool observes_world = requires(Model const& model, World<Model> const& world, Observations& seen) {
    model.observe(world, seen);
  };
  constexpr bool notes_of_world = requires(Model const& model, World<Model> const& world) { model.notes(world); };
  constexpr bool fixes_cells = requires(Model const& model, AgentSums<Model> const& agents) { model.cells(agents); };
  if (asks_world_in_every_step<Model>() || observes_world || notes_of_world) return false;
  if (has_fields<Model>() || has_networks<Model>() || has_sleepers<Model>()) return false;
  return Model::schedule == Schedule::tiled || (Model::schedule == Schedule::synchronous && !fixes_cells);
}

/// Returns the notes of a model on its start: reasons why its results will mislead.
template <class Model>
std::vector<std::string> notes_of(Model const& model, World<Model> const& world, AllProcesses processes = {}) {
  constexpr bool asks_world = requires { model.notes(world); };
  constexpr bool asks_agents = requires { model.notes(AgentSums<Model>(world)); };
  if constexpr (asks_world) {
    return model.notes(world);
  } else if constexpr (asks_agents) {
    return model.notes(AgentSums<Model>(world, processes));
  } else {
    return {};
  }
}

/// Puts the fields, the first agents and the networks of a model into an empty world: agents one by one by
/// Model::first_agent(), or by Model::start().
template <class Model>
void start_agents(Model const& model, World<Model>& world) {
  start_fields(model, world);
  if constexpr (has_networks<Model>()) world.networks = empty_networks<Model>();
  if constexpr (has_first_agents<Model>()) {
    for (std::uint64_t number = 0; number < model.agents_at_start(); ++number) {
      std::apply([&](auto... values) { world.agents.add(values...); }, model.first_agent(world, number));
    }
  } else {
    model.start(world);
  }
  if constexpr (requires { model.start_networks(world); }) model.start_networks(world);
}

/// This header includes all that a model needs; see ModelEngine for the members of a model.
///
/// ```cpp
/// struct Walkers {
///   static constexpr std::string_view name = "walkers";
///   static constexpr std::string_view documentation = "Points that walk at random.";
///   static constexpr Schedule schedule = Schedule::synchronous;
///   using Agents = Population<X, Y>;
///   double cutoff() const { return 0.1; }
///   double time_step() const { return 1.0; }
///   std::uint64_t agents_at_start() const { return 100; }
///   Agents::Values first_agent(World<Walkers> const& world, std::uint64_t number) const {
///     RandomStream random = world.start_random(number);
///     Vector const p = world.anywhere(random);
///     return {p.x, p.y};
///   }
///   void turn(Turn<Walkers>& self) const {
///     RandomStream random = self.random();
///     self.move_by(0.01 * random.in_unit_disk());
///   }
///   void observe(AgentSums<Walkers> const& agents, Observations& observations) const {
///     observations.add("agents", static_cast<double>(agents.size()));
///   }
/// };
/// ```

}  // namespace gridlock
