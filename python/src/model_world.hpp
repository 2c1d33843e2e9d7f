#pragma once

#include <nanobind/nanobind.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "column_lender.hpp"
#include "gridlock/core/world.hpp"
#include "model.hpp"

namespace gridlock::python {

/// New agents: one array for each column, x and y first.
struct NewAgents {
  std::vector<double> x;
  std::vector<double> y;
  std::vector<ColumnValues> others;
};

/// What a model of Python sees of its world in its start, in a step or in an observation, and what it asks for.
///
/// Deaths and births take effect when the step is over: rows keep their meaning within it.
class ModelWorld {
 public:
  enum class Phase { start, step, observation };

  ModelWorld(World<TableModel>& world, ModelDefinition const& definition, std::uint64_t threads, Phase phase)
      : world_(world), definition_(definition), threads_(threads), phase_(phase) {}

  [[nodiscard]] std::tuple<double, double, bool> box() const;
  [[nodiscard]] std::pair<std::uint64_t, double> clock() const;
  [[nodiscard]] std::uint64_t seed() const;
  [[nodiscard]] std::size_t size() const;

  nb::object column(std::string const& name);
  nb::object positions();
  nb::object ids();

  /// `each` random numbers for each agent, or in the start for each of `count` agents to come: shape (agents, each).
  nb::object numbers(std::optional<std::uint64_t> count, std::size_t each, std::uint64_t purpose, bool is_normal) const;
  /// Random numbers of the whole model in this step.
  nb::object numbers_of_step(std::size_t count) const;

  nb::object neighbor_lists(double cutoff) const;
  nb::object pairs(double cutoff) const;

  /// Moves every agent by its row; where walls turned it back, shape (N, 2).
  nb::object move(nb::ndarray<double const, nb::shape<-1, 2>, nb::device::cpu> const& displacements);

  /// Values of every column, x and y first, as arrays of the types of the columns.
  void add(nb::typed<nb::list, nb::object> const& columns);
  void remove(nb::ndarray<std::uint64_t const, nb::ndim<1>, nb::c_contig, nb::device::cpu> const& rows);
  void count(std::size_t event, std::uint64_t times);

  /// The step is over: arrays that are still held get memory of their own, and nothing can be asked for any more. Waits
  /// for searches that other threads have begun.
  void close();

  /// What was asked for; of the rows of deaths each once, in the order of their Ids.
  [[nodiscard]] std::vector<Id> deaths() const;
  [[nodiscard]] std::vector<NewAgents> const& births() const { return births_; }
  [[nodiscard]] std::vector<std::uint64_t> const& events() const { return events_; }

 private:
  void require_open() const;
  /// What `search` finds among the agents, without the lock of the interpreter.
  template <class Search>
  auto find(Search search) const;

  World<TableModel>& world_;
  ModelDefinition const& definition_;
  std::uint64_t threads_;
  Phase phase_;
  bool is_closed_ = false;
  mutable std::atomic<int> searches_ = 0;  ///< that have begun and not ended
  ColumnLender lender_;
  std::vector<std::uint64_t> dead_rows_;
  std::vector<NewAgents> births_;
  std::vector<std::uint64_t> events_ = std::vector<std::uint64_t>(definition_.events.size());
};

/// A world as a method of a model sees it, until the end of the scope: Python may keep the object, but sees nothing by
/// it then.
class ShownWorld {
 public:
  /// `others` are the arguments of ModelWorld after the world.
  template <class... Others>
  explicit ShownWorld(World<TableModel>& world, Others const&... others)
      : world_(new ModelWorld(world, others...)), object_(nb::cast(world_, nb::rv_policy::take_ownership)) {}
  ~ShownWorld() { world_->close(); }
  ShownWorld(ShownWorld const&) = delete;
  ShownWorld& operator=(ShownWorld const&) = delete;

  [[nodiscard]] nb::object const& object() const { return object_; }
  ModelWorld* operator->() const { return world_; }

 private:
  ModelWorld* world_;
  nb::object object_;
};

void bind_model_world(nb::module_& module);

}  // namespace gridlock::python
