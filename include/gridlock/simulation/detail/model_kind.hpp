#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/core/setting.hpp"

namespace gridlock {

struct Configuration;
struct Setup;
struct SetupOptions;

/// A table of settings, `[name]`.
struct SettingTable {
  std::string name;
  std::string documentation;
  std::function<void(SettingVisitor&)> describe;
};

/// Something that a run needs memory for.
struct MemoryDemand {
  std::string what;
  std::string key;  ///< the setting to blame
  double bytes = 0.0;
  std::string hint;
};

/// Type-erased factory for one model and its settings, selected by `model.kind`; hard disks are one of them.
class ModelKind {
 public:
  ModelKind() = default;
  ModelKind& operator=(ModelKind const&) = delete;
  virtual ~ModelKind() = default;

  [[nodiscard]] virtual std::unique_ptr<ModelKind> copy() const = 0;

  [[nodiscard]] virtual std::string_view name() const = 0;
  [[nodiscard]] virtual std::string_view documentation() const = 0;
  /// The name of its agents.
  [[nodiscard]] virtual std::string_view agents_name() const { return "agents"; }
  /// The name of what advances the agents: "model flocking", "engine exact".
  [[nodiscard]] virtual std::string title(Configuration const& configuration) const = 0;
  /// The names of the numbers 0, 1, 2 … of a column of its agents; empty where the model gives them none.
  [[nodiscard]] virtual std::vector<std::string> value_names(std::string_view column) const = 0;

  /// The tables of its settings, besides those of every run.
  [[nodiscard]] virtual std::vector<SettingTable> tables(Configuration& configuration) = 0;
  /// The setting because of which a run does not depend on another one, with its value: `engine.grid = "packed"`. Empty
  /// where it may depend on it.
  [[nodiscard]] virtual std::string unused_because_of(Configuration const& configuration,
                                                      std::string_view key) const = 0;
  /// Whether more threads than one are of any use.
  [[nodiscard]] virtual bool uses_threads(Configuration const& configuration) const = 0;
  /// The part of a run that several processes cannot share, its setting and a hint; nothing where they can share all.
  [[nodiscard]] virtual std::optional<Problem> not_shared(Configuration const& configuration) const;
  /// Whether a run can end within a step.
  [[nodiscard]] virtual bool ends_within_steps(Configuration const& /*configuration*/) const { return false; }
  /// Whether a run can be given a length in collisions.
  [[nodiscard]] virtual bool counts_collisions() const { return false; }
  /// The settings that pick among several dynamics of this model, for summary.json: "engine" and its kind.
  [[nodiscard]] virtual std::vector<std::pair<std::string, std::string>> choices(
      Configuration const& /*configuration*/) const {
    return {};
  }

  /// The demands of the agents for memory, as far as the settings say; on the low side.
  [[nodiscard]] virtual std::vector<MemoryDemand> memory(Configuration const& configuration) const = 0;
  /// The bytes that a run of so many agents is expected to need.
  [[nodiscard]] virtual double expected_bytes(Configuration const& configuration, std::size_t agents) const = 0;

  /// Refuses settings with which no run is possible, as far as that is plain without a start. Errors: Error.
  virtual void check(Configuration const& configuration) const = 0;
  /// Fills in what was left out of setup.configuration, makes the simulation, and notes what is worth telling.
  /// All processes that share the run call it. Errors: Error, in all of them.
  virtual void build(Setup& setup, SetupOptions const& options) const = 0;

 protected:
  ModelKind(ModelKind const&) = default;
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

  void add(std::unique_ptr<ModelKind> kind) { kinds_.push_back(std::move(kind)); }

  [[nodiscard]] std::vector<std::unique_ptr<ModelKind>> const& all() const { return kinds_; }
  /// The kind of that name, or nothing.
  [[nodiscard]] ModelKind const* find(std::string_view name) const {
    for (auto const& kind : kinds_) {
      if (kind->name() == name) return kind.get();
    }
    return nullptr;
  }
  void remove(std::string_view name) {
    std::erase_if(kinds_, [&](auto const& kind) { return kind->name() == name; });
  }
  /// Forgets all others.
  void keep_only(std::string_view name) {
    std::erase_if(kinds_, [&](auto const& kind) { return kind->name() != name; });
  }

 private:
  std::vector<std::unique_ptr<ModelKind>> kinds_;
};

/// Hard disks, and those of the folder models/.
ModelKinds shipped_models();

/// The models that a Configuration knows from the start: the shipped ones and those that register_model() was told of.
ModelKinds known_models();
/// Errors: Error where a model of that name is known already.
void register_model(std::unique_ptr<ModelKind> kind);
/// Forgets a model that register_model() was told of; configurations that know it keep it.
void forget_model(std::string_view name);

}  // namespace gridlock
