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

/// A demand of a run for memory.
struct MemoryDemand {
  std::string what;
  std::string key;  ///< the setting that causes the demand
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
  [[nodiscard]] virtual std::string_view agents_name() const { return "agents"; }
  /// Returns the name of the model or engine that advances the agents: "model flocking", "engine exact".
  [[nodiscard]] virtual std::string title(Configuration const& configuration) const = 0;
  /// Returns the names of the values 0, 1, 2 … of a column of its agents; empty if the values have no names.
  [[nodiscard]] virtual std::vector<std::string> value_names(std::string_view column) const = 0;

  /// Returns the tables of its settings, without those of every run.
  [[nodiscard]] virtual std::vector<SettingTable> tables(Configuration& configuration) = 0;
  /// Returns the setting, with its value, that makes the setting `key` have no effect: `engine.grid = "packed"`. Empty
  /// if `key` may have an effect.
  [[nodiscard]] virtual std::string unused_because_of(Configuration const& configuration,
                                                      std::string_view key) const = 0;
  /// Returns whether more than one thread makes a run faster.
  [[nodiscard]] virtual bool uses_threads(Configuration const& configuration) const = 0;
  /// Returns whether a graphics processor can take the steps of a run.
  [[nodiscard]] virtual bool can_use_device(Configuration const& /*configuration*/) const { return false; }
  /// Returns the part of a run that several processes cannot share, with its setting and a hint; nothing if they can.
  [[nodiscard]] virtual std::optional<Problem> not_shared(Configuration const& configuration) const;
  [[nodiscard]] virtual bool ends_within_steps(Configuration const& /*configuration*/) const { return false; }
  /// Returns whether a run can be given a length in collisions.
  [[nodiscard]] virtual bool counts_collisions() const { return false; }
  /// Returns the settings that select the dynamics of this model, for summary.json: "engine" and its kind.
  [[nodiscard]] virtual std::vector<std::pair<std::string, std::string>> choices(
      Configuration const& /*configuration*/) const {
    return {};
  }

  /// Returns lower bounds on the memory that the agents need, as far as the settings determine them.
  [[nodiscard]] virtual std::vector<MemoryDemand> memory(Configuration const& configuration) const = 0;
  /// Returns the bytes that a run of `agents` agents is expected to need.
  [[nodiscard]] virtual double expected_bytes(Configuration const& configuration, std::size_t agents) const = 0;

  /// Refuses settings with which no run is possible, as far as this can be checked without a start. Errors: Error.
  virtual void check(Configuration const& configuration) const = 0;
  /// Fills in the settings that setup.configuration leaves out, makes the simulation, and adds notes. All processes
  /// that share the run call it. Errors: Error, in all processes.
  virtual void build(Setup& setup, SetupOptions const& options) const = 0;

 protected:
  ModelKind(ModelKind const&) = default;
};

/// The models of a configuration, each with its own settings; a copy has settings of its own.
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
  /// Returns the model named `name`, or nullptr.
  [[nodiscard]] ModelKind const* find(std::string_view name) const {
    for (auto const& kind : kinds_) {
      if (kind->name() == name) return kind.get();
    }
    return nullptr;
  }
  void remove(std::string_view name) {
    std::erase_if(kinds_, [&](auto const& kind) { return kind->name() == name; });
  }
  /// Removes all models but the one named `name`.
  void keep_only(std::string_view name) {
    std::erase_if(kinds_, [&](auto const& kind) { return kind->name() != name; });
  }

 private:
  std::vector<std::unique_ptr<ModelKind>> kinds_;
};

/// Returns hard disks and the models of the folder models/.
ModelKinds shipped_models();

/// Returns the models of a new Configuration: shipped_models() and those added by register_model().
ModelKinds known_models();
/// Registers a model. Errors: Error if a model of this name is already registered.
void register_model(std::unique_ptr<ModelKind> kind);
/// Removes a model that register_model() added; existing configurations keep it.
void forget_model(std::string_view name);

}  // namespace gridlock
