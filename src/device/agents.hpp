#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "device/model_kernels.hpp"
#include "device/sorted_points.hpp"
#include "gridlock/core/detail/rows_in_order.hpp"
#include "gridlock/core/world.hpp"
#include "gridlock/model/detail/cells_of_step.hpp"

namespace gridlock::device {

/// The columns of a population in the memory of the device.
template <class Agents>
struct ColumnArrays;
template <class... Column>
struct ColumnArrays<Population<Column...>> {
  std::tuple<Array<typename Column::type>...> arrays;

  explicit ColumnArrays(std::size_t agents) : arrays{(static_cast<void>(std::type_identity<Column>{}), agents)...} {}

  [[nodiscard]] Columns<Population<Column...>> columns() {
    return std::apply([](auto&... array) { return Columns<Population<Column...>>{{array.data()...}}; }, arrays);
  }
  template <class Visit>
  void for_each(Visit visit) {
    (visit(std::type_identity<Column>{}, std::get<Population<Column...>::template place_of<Column>>(arrays)), ...);
  }
  static constexpr std::size_t bytes_per_agent = (sizeof(typename Column::type) + ...);
};

/// The agents of a world on the device, in the order of their Ids.
template <class Model>
class Agents {
  using Population = typename Model::Agents;

 public:
  Agents(Launcher& launcher, Model const& model, World<Model> const& world, CellsOfStep const& cells)
      : launcher_(launcher),
        model_(model),
        rows_(rows_in_order(world.agents.ids())),
        ids_(std::span<Id const>(ids_of(world))),
        present_(rows_.size()),
        next_(rows_.size()),
        points_(launcher, world.box, cells.layout, rows_.size()),
        may_crowd_(cells.finer.has_value()),
        result_(1) {
    present_.for_each([&]<class Column>(std::type_identity<Column>, Array<typename Column::type>& array) {
      auto const values = world.agents.template column<Column>();
      std::vector<typename Column::type> in_order(rows_.size());
      for (std::size_t k = 0; k < rows_.size(); ++k) in_order[k] = values[rows_[k]];
      array.upload(in_order);
    });
  }

  /// Takes a step. Returns false, and changes nothing, if the cores must take it.
  bool take_step(World<Model>& world, double time_step) {
    Columns<Population> const present = present_.columns();
    if (!points_.sort(&present.template at<X>(0), &present.template at<Y>(0), may_crowd_)) return false;
    result_.clear();
    launcher_.for_each(rows_.size(), TakeTurns<Model>{{.model = model_,
                                                       .points = points_.memory(),
                                                       .population = rows_.size(),
                                                       .seed = world.seed,
                                                       .step = world.clock.step,
                                                       .cutoff = model_.cutoff(),
                                                       .time_step = time_step,
                                                       .ids = ids_.data(),
                                                       .present = present,
                                                       .next = next_.columns(),
                                                       .result = result_.data()}});
    StepResult<Model> result{};
    result_.download(std::span(&result, 1));
    if (result.left_to_cores != 0) return false;
    std::swap(present_, next_);
    for (std::size_t k = 0; k < result.events.size(); ++k) world.events[k] += result.events[k];
    return true;
  }

  void download(World<Model>& world) {
    present_.for_each([&]<class Column>(std::type_identity<Column>, Array<typename Column::type>& array) {
      std::vector<typename Column::type> in_order(rows_.size());
      array.download(in_order);
      auto const values = world.agents.template column<Column>();
      for (std::size_t k = 0; k < rows_.size(); ++k) values[rows_[k]] = in_order[k];
    });
  }

  static std::size_t bytes(std::size_t agents, CellLayout const& layout) {
    return agents * (2 * ColumnArrays<Population>::bytes_per_agent + sizeof(Id)) + SortedPoints::bytes(agents, layout);
  }

 private:
  std::vector<Id> ids_of(World<Model> const& world) const {
    std::vector<Id> ids;
    for (std::uint32_t const row : rows_) ids.push_back(world.agents.ids()[row]);
    return ids;
  }

  Launcher& launcher_;
  Model model_;
  std::vector<std::uint32_t> rows_;  ///< row of each agent in the world
  Array<Id> ids_;
  ColumnArrays<Population> present_;
  ColumnArrays<Population> next_;
  SortedPoints points_;
  bool may_crowd_;  ///< whether the cores would use finer cells where agents crowd
  Array<StepResult<Model>> result_;
};

}  // namespace gridlock::device
