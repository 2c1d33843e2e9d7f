#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "gridlock/core/detail/thread_pool.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/grid/detail/cell_list.hpp"
#include "gridlock/observe/observable.hpp"
#include "model.hpp"
#include "model_world.hpp"

namespace gridlock::python {

/// A model in Python with its settings, an object of its class.
struct ModelInstance {
  std::shared_ptr<ModelDefinition const> definition;
  SharedObject object;
  double time_step = 1.0;
  std::uint64_t threads = 1;
  /// Counts of each event since the start; the engine counts and observations read.
  std::shared_ptr<std::vector<std::uint64_t>> events = {};
  std::shared_ptr<KeptSearches> searches = {};  ///< shared by steps and observations
};

/// Advances a world by the method `_step` of a model in Python.
///
/// A step that raises an exception leaves the world unchanged. Ctrl-C during a step takes effect after it. Every 32
/// steps rows are sorted by position, so that neighbours are close in memory; the step number alone decides when.
class PythonModelEngine final : public EngineFor<TableModel> {
 public:
  explicit PythonModelEngine(ModelInstance model);

  /// Errors: RunFailure if the model raises an exception or puts agents outside the box.
  void advance(World<TableModel>& world, Counters& counters, StopCondition const& stop_condition) override;
  [[nodiscard]] double time_step_of(World<TableModel> const& /*world*/) const override { return model_.time_step; }
  void require_valid(World<TableModel> const& world) const override;
  [[nodiscard]] std::vector<Count> counts(World<TableModel> const& world, Counters const& counters) const override;
  void serialize(Archive& archive, World<TableModel> const& world) override;

 private:
  void step(World<TableModel>& world);
  bool try_step(World<TableModel>& world);
  void apply(World<TableModel>& world, ModelWorld const& asked);
  void sort_rows(World<TableModel>& world);
  void expect_changes();

  ModelInstance model_;
  BeforeStep before_;
  ThreadPool thread_pool_;
  CellList order_;
  bool is_sorted_ = false;  ///< whether no agent has moved, died or been born since the rows were sorted
};

/// Throws RunFailure if an agent is outside the box.
void require_inside(World<TableModel> const& world);
/// Throws RunFailure if a column of numbers, one with one of these names if they are given, has a value that is infinite
/// or no number.
void require_finite(World<TableModel> const& world, std::optional<std::span<std::string const>> names = {});

/// Observes the number of agents, the events, and the results of the method `_observe` of a model in Python.
class PythonModelObservations final : public AveragingObservable {
 public:
  /// Keeps a reference to the world.
  PythonModelObservations(ModelInstance model, World<TableModel>& world);

  [[nodiscard]] Requirements requirements(Box const& /*box*/) const override { return {}; }
  void begin(Snapshot const& start) override;
  void sample(Snapshot const& now, std::span<double> row, bool counts_for_average) override;

 private:
  [[nodiscard]] std::vector<double> observe(std::uint64_t step);

  ModelInstance model_;
  World<TableModel>& world_;
  std::vector<ColumnInfo> observed_;
};

}  // namespace gridlock::python
