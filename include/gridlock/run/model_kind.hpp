#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/core/setting.hpp"
#include "gridlock/run/model_experiment.hpp"

namespace gridlock {

/// A kind of model with its settings, whatever it is: what `model.kind` names.
class ModelKind {
 public:
  ModelKind() = default;
  ModelKind& operator=(ModelKind const&) = delete;
  virtual ~ModelKind() = default;

  [[nodiscard]] virtual std::string_view name() const = 0;
  [[nodiscard]] virtual std::string_view documentation() const = 0;
  virtual void describe(SettingVisitor& visitor) = 0;
  [[nodiscard]] virtual std::unique_ptr<ModelKind> copy() const = 0;
  /// Refuses a box the model cannot live in, and a start it cannot make. Errors: Error.
  virtual void check(Box const& box, std::uint64_t seed) const = 0;
  [[nodiscard]] virtual std::unique_ptr<Experiment> make(Box const& box, std::uint64_t seed,
                                                         ModelEngineSettings const& settings) const = 0;

 protected:
  ModelKind(ModelKind const&) = default;
};

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
  [[nodiscard]] std::unique_ptr<ModelKind> copy() const override { return std::make_unique<ModelKindOf>(*this); }
  void check(Box const& box, std::uint64_t seed) const override {
    if constexpr (requires { model_.reach(); }) {
      require_reach(box, model_.reach(), Model::name);
    } else {
      World<Model> world{.box = box, .seed = seed};
      try {
        model_.start(world);
      } catch (Error const& error) {
        // What is wrong with the start is one of the model's own settings.
        std::vector<Problem> problems = error.problems();
        for (Problem& problem : problems) problem.key = std::string(Model::name) + "." + problem.key;
        throw Error(std::move(problems));
      }
      require_reach(box, model_.reach(world), Model::name);
    }
  }
  [[nodiscard]] std::unique_ptr<Experiment> make(Box const& box, std::uint64_t seed,
                                                 ModelEngineSettings const& settings) const override {
    return std::make_unique<ModelExperiment<Model>>(model_, box, seed, settings);
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

/// What a Configuration knows from the start: those of the folder models/ and those that make_known() was told of.
ModelKinds known_models();
void make_known(std::unique_ptr<ModelKind> kind);

/// From now on the program can run, resume, sweep and draw this model by its name (`model.kind`), as those of the folder
/// models/. To be called before there are other threads. Errors: Error where a model of that name is known already.
template <class Model>
void make_known() {
  make_known(std::make_unique<ModelKindOf<Model>>());
}

}  // namespace gridlock
