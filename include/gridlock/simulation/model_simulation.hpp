#pragma once

/// \file
/// The simulation of a model that is defined in code.
///
/// ```cpp
/// struct Walkers {
///   static constexpr std::string_view name = "walkers";
///   static constexpr std::string_view documentation = "Points that walk at random.";
///   static constexpr Schedule schedule = Schedule::synchronous;
///   using Agents = Population<X, Y>;
///   double cutoff() const { return 0.1; }
///   double time_step() const { return 1.0; }
///   void start(World<Walkers>& world) const { world.agents.add(0.5, 0.5); }
///   void turn(Turn<Walkers>& self) const { self.move_by({0.01, 0.0}); }
/// };
/// inline void walk() {
///   ModelSimulation<Walkers> simulation({}, Box(1.0, 1.0, Edge::periodic), 7);
///   simulation.advance({.step = 100});
/// }
/// ```

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "gridlock/model/model.hpp"
#include "gridlock/observe/observable.hpp"
#include "gridlock/simulation/world_simulation.hpp"

namespace gridlock {

/// The observable of a model: the number of agents, the number of times that each event has happened since the start,
/// and the quantities of Model::observe(); with averages of all but the events.
template <class Model>
class ModelObservations final : public AveragingObservable {
 public:
  /// Keeps a reference to the world, which has the agents of this process.
  ModelObservations(Model model, World<Model> const& world) : model_(std::move(model)), world_(world) {}

  [[nodiscard]] Requirements requirements(Box const& /*box*/) const override { return {}; }

  void begin(Snapshot const& start) override {
    std::vector<ColumnInfo> columns{{"agents", "", "Agents alive."}};
    for (auto const name : event_names<Model>()) columns.push_back({std::string(name), "", "Times since the start."});
    for (auto const& [name, value, documentation] : observe(start)) columns.push_back({name, "", documentation});
    reset(std::move(columns));
  }

  void sample(Snapshot const& now, std::span<double> row, bool counts_for_average) override {
    std::vector<Observations::Entry> const seen = observe(now);
    row[0] = static_cast<double>(now.count());
    if (counts_for_average) average(0, row[0]);
    for (std::size_t k = 0; k < world_.events.size(); ++k) row[1 + k] = static_cast<double>(world_.events[k]);
    std::size_t const first = 1 + world_.events.size();
    for (std::size_t k = 0; k < seen.size(); ++k) {
      bool const is_defined = std::isfinite(seen[k].value);
      row[first + k] = is_defined ? seen[k].value : no_value;
      if (is_defined && counts_for_average) average(first + k, seen[k].value);
    }
  }

 private:
  [[nodiscard]] std::vector<Observations::Entry> observe(Snapshot const& now) const {
    Observations seen;
    AgentSums<Model> const agents(world_, now.processes);
    if constexpr (requires { model_.observe(agents, seen); }) {
      model_.observe(agents, seen);
    } else if constexpr (requires { model_.observe(world_, seen); }) {
      model_.observe(world_, seen);
    }
    return seen.entries();
  }

  Model model_;
  World<Model> const& world_;
};

/// The simulation of a model: the world of Model::start(), advanced by a ModelEngine.
///
/// The series has the quantities of the model first, then those of every observable whose columns its agents have.
template <class Model>
class ModelSimulation final : public WorldSimulation<Model> {
 public:
  /// Errors: those of ModelEngine and of Model::start().
  ModelSimulation(Model const& model, Box const& box, std::uint64_t seed, ModelEngineSettings const& settings = {},
                  ObserveSettings const& observed = {})
      : ModelSimulation(model, started(model, box, seed), std::make_unique<ModelEngine<Model>>(model, box, settings),
                        observed) {}

  /// Makes a simulation of a world with its first agents and an engine for it; see WorldSimulation for shared worlds.
  ModelSimulation(Model const& model, World<Model>&& world, std::unique_ptr<EngineFor<Model>> engine,
                  ObserveSettings const& observed, AllProcesses processes = {})
      : WorldSimulation<Model>(std::move(engine), std::move(world), processes) {
    this->observe(std::make_unique<ModelObservations<Model>>(model, this->world()));
    this->observe(observed, {.keeps_counters = keeps_counters<Model>()});
  }

 private:
  static World<Model> started(Model const& model, Box const& box, std::uint64_t seed) {
    World<Model> world{.box = box, .agents = {}, .clock = {}, .seed = seed};
    start_agents(model, world);
    return world;
  }
};

}  // namespace gridlock
