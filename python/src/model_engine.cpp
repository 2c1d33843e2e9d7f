#include "model_engine.hpp"

#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>

#include "core/copy_if_finite.hpp"
#include "gridlock/grid/cell_layout.hpp"
#include "gridlock/model/detail/checks.hpp"

namespace gridlock::python {

namespace {

constexpr std::uint64_t steps_between_sorts = 32;

/// Returns a layout of cells with about one agent per cell.
CellLayout layout_of(World<TableModel> const& world) {
  std::size_t const agents = std::bit_ceil(std::max<std::size_t>(16, world.agents.size()));
  return layout_for_cutoff(world.box, std::sqrt(world.box.area() / static_cast<double>(agents)), agents);
}

}  // namespace

void require_finite(World<TableModel> const& world, std::optional<std::span<std::string const>> names) {
  AgentTable const& agents = world.agents;
  for (TableColumn const& column : agents.others()) {
    auto const* const values = std::get_if<LargeArray<double>>(&column.values);
    if (values == nullptr || (names && std::ranges::find(*names, column.name) == names->end())) continue;
    std::size_t const place = find_not_finite(*values);
    for (std::size_t kind = 0; place < values->size() && kind < agents.kinds(); ++kind) {
      RowSpan const places = agents.places_in(column, kind);
      if (place < places.first || place >= places.end) continue;
      std::size_t const row = agents.rows_of(kind).first + place - places.first;
      double const value = (*values)[place];
      throw RunFailure("step " + std::to_string(world.clock.step) + ": agent " + std::to_string(agents.ids()[row]) +
                       " has the value " +
                       (std::isnan(value) ? "nan"
                        : value > 0       ? "inf"
                                          : "-inf") +
                       " in the column " + column.name +
                       "\n  hint: this is a mistake of the model: a division, a root or a logarithm may have no finite "
                       "result; mark what is "
                       "not known by a number such as -1");
    }
  }
}

void require_inside(World<TableModel> const& world) {
  auto const x = world.agents.x();
  auto const y = world.agents.y();
  std::size_t const row = find_outside(world.box, x, y);
  if (row < x.size()) throw_outside(world.clock.step, world.agents.ids()[row], {x[row], y[row]}, world.box);
}

PythonModelEngine::PythonModelEngine(ModelInstance model) : model_(std::move(model)), thread_pool_(model_.threads) {}

void PythonModelEngine::advance(World<TableModel>& world, Counters& /*counters*/, StopCondition const& stop_condition) {
  expect_changes();
  before_.fields.forget(world.fields.size());
  while (!stop_condition.is_reached(world.clock, 0)) {
    step(world);
    ++world.clock.step;
    world.clock.time += model_.time_step;
    if (stop_condition.stops_here()) break;
  }
}

void PythonModelEngine::require_valid(World<TableModel> const& world) const {
  try {
    require_inside(world);
    require_finite(world);
    require_living_ends(world);
  } catch (RunFailure const& failure) {
    throw Error(Problem{.what = failure.what()});
  }
  if (!world.agents.has_kinds_in_order()) {
    throw Error(Problem{.what = "the column kind was changed", .hint = "an agent keeps its kind for its whole life"});
  }
}

std::vector<Count> PythonModelEngine::counts(World<TableModel> const& /*world*/, Counters const& /*counters*/) const {
  std::vector<Count> counts;
  for (std::size_t k = 0; k < model_.events->size(); ++k) {
    counts.push_back({model_.definition->events[k], (*model_.events)[k]});
  }
  return counts;
}

void PythonModelEngine::serialize(Archive& archive, World<TableModel> const& /*world*/) {
  for (std::size_t k = 0; k < model_.events->size(); ++k) {
    archive.visit(model_.definition->events[k], (*model_.events)[k]);
  }
}

void PythonModelEngine::step(World<TableModel>& world) {
  if (world.clock.step % steps_between_sorts == 0 && !is_sorted_) sort_rows(world);
  world.agents.put_vectors_side_by_side();
  world.agents.forget_view();
  if (try_step(world)) return;
  // A second KeyboardInterrupt was raised by the model itself, not by Ctrl-C.
  if (!try_step(world)) {
    nb::gil_scoped_acquire const acquired;
    PyErr_SetNone(PyExc_KeyboardInterrupt);
    throw nb::python_error();
  }
  // The interrupt is set again, so that Python handles Ctrl-C after the step.
  nb::gil_scoped_acquire const acquired;
  PyErr_SetInterrupt();
}

/// Carries out a step. Returns false and restores the agents if KeyboardInterrupt is raised, as by Ctrl-C.
bool PythonModelEngine::try_step(World<TableModel>& world) {
  nb::gil_scoped_acquire const acquired;
  ShownWorld const shown(world, *model_.definition, model_.threads, *model_.searches, ModelWorld::Phase::step,
                         &before_);
  auto const restore = [&] {
    expect_changes();
    shown->close();
    shown->restore();
  };
  try {
    model_.object.get().attr("_step")(shown.object());
    shown->close();
    if (shown->has_changed_positions()) require_inside(world);
    require_finite(world, shown->columns_changed());
    before_.fields.check(world.fields, world.clock.step);
    if (shown->has_changed_places_or_number()) expect_changes();
    apply(world, *shown.operator->());
    before_.fields.accept();
  } catch (nb::python_error& error) {
    restore();
    if (error.matches(PyExc_KeyboardInterrupt)) return false;
    throw failure_of(error, model_.definition->name, world.clock.step);
  } catch (...) {
    restore();
    throw;
  }
  return true;
}

void PythonModelEngine::apply(World<TableModel>& world, ModelWorld const& asked) {
  for (NewAgents const& born : asked.births()) {
    std::size_t const outside = find_outside(world.box, born.x, born.y);
    if (outside < born.x.size()) {
      throw_birth_outside(world.clock.step, {}, {born.x[outside], born.y[outside]}, world.box);
    }
  }
  std::vector<Id> const deaths = asked.deaths();
  std::vector<Id> ids;  // of the agents before the step, and of newborn ones
  if (!asked.edges_of_newborn().empty()) ids.assign(world.agents.ids().begin(), world.agents.ids().end());
  world.agents.remove(deaths);
  for (NewAgents const& born : asked.births()) {
    std::vector<Id> const newborn = world.agents.add(born.kind, born.x, born.y, born.others);
    ids.insert(ids.end(), newborn.begin(), newborn.end());
  }
  for (Network& network : world.networks) network.remove_agents(deaths);
  if (!asked.edges_of_newborn().empty()) connect_newborn(world, asked.edges_of_newborn(), ids);
  for (std::size_t k = 0; k < asked.events().size(); ++k) (*model_.events)[k] += asked.events()[k];
}

void PythonModelEngine::sort_rows(World<TableModel>& world) {
  if (world.agents.size() == 0) return;
  order_.sort(layout_of(world), world.agents.x(), world.agents.y(), world.agents.ids(), thread_pool_);
  world.agents.reorder(order_.indices());
  model_.searches->expect_changes();
  is_sorted_ = true;
}

void PythonModelEngine::expect_changes() {
  model_.searches->expect_changes();
  is_sorted_ = false;
}

PythonModelObservations::PythonModelObservations(ModelInstance model, World<TableModel>& world)
    : model_(std::move(model)), world_(world) {}

void PythonModelObservations::begin(Snapshot const& /*start*/) {
  std::vector<ColumnInfo> columns{{"agents", "", "Agents alive."}};
  for (std::string const& event : model_.definition->events) columns.push_back({event, "", "Times since the start."});
  observed_.clear();
  {
    nb::gil_scoped_acquire const acquired;
    ShownWorld const shown(world_, *model_.definition, model_.threads, *model_.searches,
                           ModelWorld::Phase::observation);
    nb::object const described = call_python([&] { return model_.object.get().attr("_observed")(shown.object()); });
    for (nb::handle const entry : described) {
      auto const [name, unit, documentation] = nb::cast<std::tuple<std::string, std::string, std::string>>(entry);
      observed_.push_back({name, unit, documentation});
    }
  }
  columns.insert(columns.end(), observed_.begin(), observed_.end());
  reset(std::move(columns));
}

void PythonModelObservations::sample(Snapshot const& now, std::span<double> row, bool counts_for_average) {
  row[0] = static_cast<double>(now.agents.size());
  if (counts_for_average) average(0, row[0]);
  for (std::size_t k = 0; k < model_.events->size(); ++k) row[1 + k] = static_cast<double>((*model_.events)[k]);
  if (observed_.empty()) return;
  std::vector<double> const values = observe(now.clock.step);
  std::size_t const first = 1 + model_.events->size();
  for (std::size_t k = 0; k < values.size(); ++k) {
    bool const is_defined = std::isfinite(values[k]);
    row[first + k] = is_defined ? values[k] : no_value;
    if (is_defined && counts_for_average) average(first + k, values[k]);
  }
}

std::vector<double> PythonModelObservations::observe(std::uint64_t step) {
  nb::gil_scoped_acquire const acquired;
  try {
    ShownWorld const shown(world_, *model_.definition, model_.threads, *model_.searches,
                           ModelWorld::Phase::observation);
    nb::list names;
    for (ColumnInfo const& column : observed_) names.append(column.name);
    return nb::cast<std::vector<double>>(model_.object.get().attr("_observe")(shown.object(), names));
  } catch (nb::python_error& error) {
    if (error.matches(PyExc_KeyboardInterrupt)) throw;
    throw failure_of(error, model_.definition->name, step);
  }
}

}  // namespace gridlock::python
