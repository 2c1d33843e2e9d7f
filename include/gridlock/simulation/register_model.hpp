#pragma once

/// \file
/// Registers a model under its name, for configurations and the command line.
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

#include "gridlock/model/detail/on_device.hpp"
#include "gridlock/model/detail/shared_model_engine.hpp"
#include "gridlock/simulation/detail/model_kind.hpp"
#include "gridlock/simulation/model_simulation.hpp"
#include "gridlock/simulation/setup.hpp"

namespace gridlock {

namespace detail {

/// Sets `names` to Column::value_names if the column is named `name` and has value_names.
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

/// Calls act(). Errors: an Error or a RunFailure of act() becomes an Error that names the table of settings of the
/// model.
void blame_table(std::string_view model, std::function<void()> const& act);

/// The part of ModelKindOf that does not depend on the type of the model.
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

  virtual void describe_model(SettingVisitor& visitor) = 0;
  [[nodiscard]] virtual bool can_be_shared() const { return false; }
  /// Return the number of agents at the start (0 if the model does not tell it), and the least memory in bytes for each
  /// agent.
  [[nodiscard]] virtual std::uint64_t agents_at_start() const = 0;
  [[nodiscard]] virtual std::size_t bytes_per_agent() const = 0;
  /// Returns the fields of the model in a box.
  [[nodiscard]] virtual std::vector<FieldShape> shapes_of_fields(Box const& /*box*/) const { return {}; }
  [[nodiscard]] virtual bool has_networks() const { return false; }
  /// Returns the least memory of a field, in copies of its values.
  [[nodiscard]] virtual double copies_of_fields() const { return 1.0; }
  /// Returns the number of random positions that the start will try, each about 0.15 µs; 0 if the model does not tell
  /// it.
  [[nodiscard]] virtual double attempts_at_start(Box const& box, std::uint64_t seed) const = 0;
  /// Makes the simulation, and sets `notes` to the notes of the model. Contract: several processes only if
  /// can_be_shared(). Errors: Error.
  [[nodiscard]] virtual std::unique_ptr<Simulation> make(Box const& box, std::uint64_t seed,
                                                         ModelEngineSettings const& settings,
                                                         ObserveSettings const& observed,
                                                         std::vector<std::string>& notes,
                                                         AllProcesses processes) const = 0;
};

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
  [[nodiscard]] bool can_use_device(Configuration const& /*configuration*/) const override {
    return runs_on_device<Model>();
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
    // Three copies: the values now, after the step, and sorted; 40 bytes for the Id, the slot and the position in the
    // grid.
    constexpr std::size_t copies =
        Model::schedule == Schedule::synchronous || Model::schedule == Schedule::tiled ? 3 : 1;
    return copies * sizeof(typename Model::Agents::Values) + 40;
  }
  [[nodiscard]] std::vector<FieldShape> shapes_of_fields(Box const& box) const override {
    if constexpr (has_fields<Model>()) {
      return gridlock::shapes_of_fields(model_, box);
    } else {
      return {};
    }
  }
  [[nodiscard]] bool has_networks() const override { return gridlock::has_networks<Model>(); }
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
  /// Puts the first agents into an empty world, and makes the engine for it.
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
      require_fields(model_, world);
      require_networks(world);
    });
    if constexpr (runs_on_device<Model>()) {
      if (settings.is_on_device) {
        std::unique_ptr<EngineFor<Model>> engine = model_engine_on_device(model_, world.box, settings);
        engine->require_valid(world);
        return engine;
      }
    }
    return std::make_unique<ModelEngine<Model>>(model_, world.box, settings);
  }

  Model model_;
};

}  // namespace detail

/// Registers a model: the program can then run, resume, sweep and draw it by its name (`model.kind`), like the models
/// of the folder models/. Call it before starting other threads. Errors: Error if a model of this name is already
/// registered.
template <class Model>
void register_model() {
  register_model(std::make_unique<detail::ModelKindOf<Model>>());
}

}  // namespace gridlock
