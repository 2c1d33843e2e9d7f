#pragma once

/// \file
/// Makes a model known by its name to configurations and to the command line.
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
///   void describe(SettingVisitor&) {}
/// };
/// inline void know_walkers() { register_model<Walkers>(); }
/// ```

#include <cstddef>
#include <cstdint>
#include <functional>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "gridlock/model/detail/shared_model_engine.hpp"
#include "gridlock/simulation/detail/model_kind.hpp"
#include "gridlock/simulation/model_simulation.hpp"
#include "gridlock/simulation/setup.hpp"

namespace gridlock {

namespace detail {

/// Takes Column::value_names where the column has that name and such names.
template <class Column>
void take_value_names(std::string_view name, std::vector<std::string>& names) {
  if constexpr (requires { Column::value_names; }) {
    if (name == Column::name) names.assign(std::begin(Column::value_names), std::end(Column::value_names));
  }
}

template <class... Columns>
std::vector<std::string> value_names(std::type_identity<Population<Columns...>>, std::string_view name) {
  std::vector<std::string> names;
  (take_value_names<Columns>(name, names), ...);
  return names;
}

/// Calls `act`; what is wrong with a model is then one of the settings in its own table, and what its start does wrong
/// is refused like any other input. Errors: Error.
void blame_table(std::string_view model, std::function<void()> const& act);

/// A kind without its model: what does not depend on the type.
class AgentsKind : public ModelKind {
 public:
  [[nodiscard]] std::string title(Configuration const& configuration) const override;
  [[nodiscard]] std::vector<SettingTable> tables(Configuration& configuration) override;
  [[nodiscard]] std::string unused_because_of(Configuration const& configuration, std::string_view key) const override;
  [[nodiscard]] std::vector<MemoryDemand> memory(Configuration const& configuration) const override;
  [[nodiscard]] double expected_bytes(Configuration const& configuration, std::size_t agents) const override;
  [[nodiscard]] std::optional<Problem> not_shared(Configuration const& configuration) const override;
  void build(Setup& setup, SetupOptions const& options) const override;

 protected:
  AgentsKind() = default;
  AgentsKind(AgentsKind const&) = default;

  /// The settings of the model itself.
  virtual void describe_model(SettingVisitor& visitor) = 0;
  [[nodiscard]] virtual bool can_be_shared() const { return false; }
  /// How many agents the model starts with, where it says so before, and the bytes that each of them takes at least.
  [[nodiscard]] virtual std::uint64_t agents_at_start() const = 0;
  [[nodiscard]] virtual std::size_t bytes_per_agent() const = 0;
  /// How many random places the start will try in all, each about 0.15 µs, where the model says so; else 0.
  [[nodiscard]] virtual double attempts_at_start(Box const& box, std::uint64_t seed) const = 0;
  /// Appends to `notes` where the model says that its results mislead. Contract: several processes share it only where
  /// can_be_shared(). Errors: Error.
  [[nodiscard]] virtual std::unique_ptr<Simulation> make(Box const& box, std::uint64_t seed,
                                                         ModelEngineSettings const& settings,
                                                         ObserveSettings const& observed,
                                                         std::vector<std::string>& notes,
                                                         AllProcesses processes) const = 0;
};

/// The kind a model is.
template <class Model>
class ModelKindOf final : public AgentsKind {
 public:
  [[nodiscard]] std::unique_ptr<ModelKind> copy() const override { return std::make_unique<ModelKindOf>(*this); }
  [[nodiscard]] std::string_view name() const override { return Model::name; }
  [[nodiscard]] std::string_view documentation() const override {
    if constexpr (requires { Model::documentation; }) {
      return Model::documentation;
    } else {
      return {};
    }
  }
  [[nodiscard]] std::vector<std::string> value_names(std::string_view column) const override {
    return detail::value_names(std::type_identity<typename Model::Agents>{}, column);
  }
  [[nodiscard]] bool uses_threads(Configuration const& /*configuration*/) const override {
    return Model::schedule == Schedule::synchronous || Model::schedule == Schedule::tiled;
  }
  void check(Configuration const& configuration) const override {
    Box const box = make_box(configuration.box);
    blame_table(Model::name, [&] {
      if constexpr (requires { model_.check(box); }) model_.check(box);
    });
    if constexpr (requires { model_.cutoff(); }) require_cutoff_fits(box, model_.cutoff(), Model::name);
  }

 protected:
  void describe_model(SettingVisitor& visitor) override {
    if constexpr (requires { model_.describe(visitor); }) model_.describe(visitor);
  }
  [[nodiscard]] bool can_be_shared() const override { return can_be_divided<Model>(); }
  [[nodiscard]] std::uint64_t agents_at_start() const override {
    if constexpr (requires { model_.agents_at_start(); }) {
      return model_.agents_at_start();
    } else {
      return 0;
    }
  }
  [[nodiscard]] std::size_t bytes_per_agent() const override {
    // The values, their successors and the room to sort them; Id, slot and the place in the grid.
    constexpr std::size_t copies =
        Model::schedule == Schedule::synchronous || Model::schedule == Schedule::tiled ? 3 : 1;
    return copies * sizeof(typename Model::Agents::Values) + 40;
  }
  [[nodiscard]] double attempts_at_start(Box const& box, std::uint64_t seed) const override {
    if constexpr (requires { model_.attempts_at_start(box, seed); }) {
      double attempts = 0.0;
      blame_table(Model::name, [&] { attempts = model_.attempts_at_start(box, seed); });
      return attempts;
    } else {
      return 0.0;
    }
  }
  [[nodiscard]] std::unique_ptr<Simulation> make(Box const& box, std::uint64_t seed,
                                                 ModelEngineSettings const& settings, ObserveSettings const& observed,
                                                 std::vector<std::string>& notes,
                                                 AllProcesses processes) const override {
    World<Model> world{.box = box, .agents = {}, .clock = {}, .seed = seed};
    std::unique_ptr<EngineFor<Model>> engine = started_engine(world, settings, processes);
    double const cutoff = cutoff_of(model_, world, processes);
    processes.agree([&] { require_cutoff_fits(box, cutoff, Model::name); });
    notes = notes_of(model_, world, processes);
    return std::make_unique<ModelSimulation<Model>>(model_, std::move(world), std::move(engine), observed, processes);
  }

 private:
  /// Fills an empty world, and makes the engine for it.
  [[nodiscard]] std::unique_ptr<EngineFor<Model>> started_engine(World<Model>& world,
                                                                 ModelEngineSettings const& settings,
                                                                 AllProcesses processes) const {
    auto const blame = [](std::function<void()> const& act) { blame_table(Model::name, act); };
    if constexpr (can_be_divided<Model>()) {
      if (processes.count() > 1) {
        start_together(model_, world, processes.communicator(), blame);
        return std::make_unique<SharedModelEngine<Model>>(model_, processes, settings.threads);
      }
    }
    blame([&] {
      start_agents(model_, world);
      ModelEngine<Model>::require_inside(world);
    });
    return std::make_unique<ModelEngine<Model>>(model_, world.box, settings);
  }

  Model model_;
};

}  // namespace detail

/// From now on the program can run, resume, sweep and draw this model by its name (`model.kind`), as those of the
/// folder models/. To be called before there are other threads. Errors: Error where a model of that name is known
/// already.
template <class Model>
void register_model() {
  register_model(std::make_unique<detail::ModelKindOf<Model>>());
}

}  // namespace gridlock
