#pragma once

#include <functional>
#include <iterator>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/core/setting.hpp"
#include "gridlock/simulation/model_simulation.hpp"

namespace gridlock {

/// Type-erased factory for one model and its settings, selected by `model.kind`.
class ModelKind {
 public:
  ModelKind() = default;
  ModelKind& operator=(ModelKind const&) = delete;
  virtual ~ModelKind() = default;

  [[nodiscard]] virtual std::string_view name() const = 0;
  [[nodiscard]] virtual std::string_view documentation() const = 0;
  virtual void describe(SettingVisitor& visitor) = 0;
  /// What the model calls the numbers 0, 1, 2 … of a column of its agents; empty where it gives them no names.
  [[nodiscard]] virtual std::vector<std::string> value_names(std::string_view column) const = 0;
  [[nodiscard]] virtual std::unique_ptr<ModelKind> copy() const = 0;
  /// Refuses settings with which no run in this box is possible, as far as that is plain without a start. Errors: Error.
  virtual void check_settings(Box const& box) const = 0;
  /// How many agents the model starts with, where it says so before, and the bytes that each of them takes at least.
  [[nodiscard]] virtual std::uint64_t agents_at_start() const = 0;
  [[nodiscard]] virtual std::size_t bytes_per_agent() const = 0;
  /// How many random places the start will try in all, each about 0.15 µs, where the model says so; else 0.
  [[nodiscard]] virtual double attempts_at_start(Box const& box, std::uint64_t seed) const = 0;
  /// Makes a start only to see whether the model can, and that its agents are in the box; returns where the model says that
  /// its results mislead. Errors: Error.
  [[nodiscard]] virtual std::vector<std::string> check_start(Box const& box, std::uint64_t seed) const = 0;
  [[nodiscard]] virtual std::unique_ptr<Simulation> make(Box const& box, std::uint64_t seed,
                                                         ModelEngineSettings const& settings) const = 0;

 protected:
  ModelKind(ModelKind const&) = default;
};

/// Calls `act`; what is wrong with a model is then one of the settings in its own table, and what its start does wrong
/// is refused like any other input. Errors: Error.
void blame_table(std::string_view model, std::function<void()> const& act);

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

}  // namespace detail

/// The kind a model is.
template <class Model>
class ModelKindOf final : public ModelKind {
 public:
  [[nodiscard]] std::string_view name() const override { return Model::name; }
  [[nodiscard]] std::string_view documentation() const override {
    if constexpr (requires { Model::documentation; }) {
      return Model::documentation;
    } else {
      return {};
    }
  }
  void describe(SettingVisitor& visitor) override {
    if constexpr (requires { model_.describe(visitor); }) model_.describe(visitor);
  }
  [[nodiscard]] std::vector<std::string> value_names(std::string_view column) const override {
    return detail::value_names(std::type_identity<typename Model::Agents>{}, column);
  }
  [[nodiscard]] std::unique_ptr<ModelKind> copy() const override { return std::make_unique<ModelKindOf>(*this); }
  void check_settings(Box const& box) const override {
    blame_table(Model::name, [&] {
      if constexpr (requires { model_.check(box); }) model_.check(box);
    });
    if constexpr (requires { model_.cutoff(); }) require_cutoff_fits(box, model_.cutoff(), Model::name);
  }
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
  [[nodiscard]] std::vector<std::string> check_start(Box const& box, std::uint64_t seed) const override {
    World<Model> world{.box = box, .seed = seed};
    blame_table(Model::name, [&] {
      model_.start(world);
      ModelEngine<Model>::require_inside(world);
    });
    require_cutoff_fits(box, cutoff_of(model_, world), Model::name);
    if constexpr (requires { model_.notes(world); }) {
      return model_.notes(world);
    } else {
      return {};
    }
  }
  [[nodiscard]] std::unique_ptr<Simulation> make(Box const& box, std::uint64_t seed,
                                                 ModelEngineSettings const& settings) const override {
    return std::make_unique<ModelSimulation<Model>>(model_, box, seed, settings);
  }

 private:
  Model model_;
};

/// Kinds of model, each with its own settings; copies are independent.
class ModelKinds {
 public:
  ModelKinds() = default;
  ModelKinds(ModelKinds const& other) {
    for (auto const& kind : other.kinds_) kinds_.push_back(kind->copy());
  }
  ModelKinds(ModelKinds&&) = default;
  ModelKinds& operator=(ModelKinds other) {
    std::swap(kinds_, other.kinds_);
    return *this;
  }
  ~ModelKinds() = default;

  template <class Model>
  void add() {
    add(std::make_unique<ModelKindOf<Model>>());
  }
  void add(std::unique_ptr<ModelKind> kind) { kinds_.push_back(std::move(kind)); }

  [[nodiscard]] std::vector<std::unique_ptr<ModelKind>> const& all() const { return kinds_; }
  /// The kind of that name, or nothing.
  [[nodiscard]] ModelKind const* find(std::string_view name) const {
    for (auto const& kind : kinds_) {
      if (kind->name() == name) return kind.get();
    }
    return nullptr;
  }
  void clear() { kinds_.clear(); }

 private:
  std::vector<std::unique_ptr<ModelKind>> kinds_;
};

/// Those of the folder models/.
ModelKinds shipped_models();

/// What a Configuration knows from the start: those of the folder models/ and those that register_model() was told of.
ModelKinds known_models();
void register_model(std::unique_ptr<ModelKind> kind);

/// From now on the program can run, resume, sweep and draw this model by its name (`model.kind`), as those of the folder
/// models/. To be called before there are other threads. Errors: Error where a model of that name is known already.
template <class Model>
void register_model() {
  register_model(std::make_unique<ModelKindOf<Model>>());
}

}  // namespace gridlock
