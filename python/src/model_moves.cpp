// The moves of the agents of a model in Python.

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <variant>
#include <vector>

#include "gridlock/core/random.hpp"
#include "gridlock/model/detail/checks.hpp"
#include "gridlock/model/detail/motion.hpp"
#include "model_world.hpp"
#include "moves_apart.hpp"

namespace gridlock::python {

namespace {

/// Returns the column that counts crossings of edges; empty if the model has no such column.
std::span<std::int32_t> images(AgentTable& agents, std::string_view name) {
  for (NamedColumn const& column : agents.columns()) {
    if (column.name == name) return std::get<std::span<std::int32_t>>(column.values);
  }
  return {};
}

/// Adds a crossing to an image. Errors: Error if the count exceeds its type.
void count_crossing(std::int32_t& image, int crossed, std::string_view name) {
  if (!__builtin_add_overflow(image, crossed, &image)) return;
  throw Error({.what = "an agent crosses more edges than the column " + std::string(name) + " can count",
               .hint = "it holds whole numbers from -2147483648 to 2147483647; begin with 0"});
}

}  // namespace

void ModelWorld::require_displacements(Displacements const& displacements, std::size_t first) const {
  require_rows({first, first + displacements.shape(0)});
  for (std::size_t k = 0; k < displacements.shape(0); ++k) {
    Vector const displacement{displacements(k, 0), displacements(k, 1)};
    if (!is_shorter_than_box(world_.box, displacement)) {
      throw_long_displacement(world_.clock.step, world_.agents.ids()[first + k], displacement, world_.box);
    }
  }
}

nb::object ModelWorld::move(Displacements const& displacements, std::size_t first) {
  require_displacements(displacements, first);
  for (char const* const name : {X::name, Y::name, ImageX::name, ImageY::name}) keep_before(name);
  AgentTable& agents = world_.agents;
  std::vector<std::uint8_t> bounces(2 * displacements.shape(0));
  auto const images_x = images(agents, ImageX::name);
  auto const images_y = images(agents, ImageY::name);
  for (std::size_t k = 0; k < displacements.shape(0); ++k) {
    std::size_t const row = first + k;
    Vector const displacement{displacements(k, 0), displacements(k, 1)};
    Motion const moved = motion(world_.box, place_of(row), displacement);
    agents.x()[row] = moved.end.x;
    agents.y()[row] = moved.end.y;
    if (!images_x.empty()) count_crossing(images_x[row], moved.crossed_x, ImageX::name);
    if (!images_y.empty()) count_crossing(images_y[row], moved.crossed_y, ImageY::name);
    bounces[2 * k] = static_cast<std::uint8_t>(moved.bounce.x);
    bounces[2 * k + 1] = static_cast<std::uint8_t>(moved.bounce.y);
  }
  return nb::cast(owned_array(std::move(bounces), {displacements.shape(0), 2}));
}

nb::object ModelWorld::move_apart(Displacements const& displacements, std::size_t first, Amounts const& radii,
                                  std::uint64_t parts, bool is_shuffled) {
  require_displacements(displacements, first);
  std::size_t const count = displacements.shape(0);
  for (char const* const name : {X::name, Y::name, ImageX::name, ImageY::name}) keep_before(name);
  AgentTable& agents = world_.agents;
  std::vector<std::uint32_t> const order = order_of_turns({first, first + count}, is_shuffled);
  MovesApart ends;
  {
    nb::gil_scoped_release const released;
    ends = gridlock::python::move_apart({.box = world_.box,
                                         .x = agents.x().subspan(first, count),
                                         .y = agents.y().subspan(first, count),
                                         .radius = {radii.data(), radii.shape(0)},
                                         .order = order,
                                         .parts = parts},
                                        {displacements.data(), 2 * count});
  }
  auto const images_x = images(agents, ImageX::name);
  auto const images_y = images(agents, ImageY::name);
  for (std::size_t k = 0; k < count; ++k) {
    if (!images_x.empty()) count_crossing(images_x[first + k], ends.crossed[2 * k], ImageX::name);
    if (!images_y.empty()) count_crossing(images_y[first + k], ends.crossed[2 * k + 1], ImageY::name);
  }
  return nb::make_tuple(owned_array(std::move(ends.walls), {count, 2}), owned_array(std::move(ends.partners)));
}

/// Returns rows, counted from the first, in the order of their Ids or in one that is drawn for this step.
std::vector<std::uint32_t> ModelWorld::order_of_turns(RowsFromTo rows, bool is_shuffled) const {
  std::vector<std::tuple<double, Id, std::uint32_t>> turns;
  for (std::size_t row = rows.first; row < rows.second; ++row) {
    Id const id = world_.agents.ids()[row];
    RandomStream stream(world_.seed, world_.clock.step, id, Purpose::model_take);
    turns.emplace_back(is_shuffled ? stream.uniform() : 0.0, id, static_cast<std::uint32_t>(row - rows.first));
  }
  std::ranges::sort(turns);
  std::vector<std::uint32_t> order;
  for (auto const& [chance, id, row] : turns) order.push_back(row);
  return order;
}

}  // namespace gridlock::python
