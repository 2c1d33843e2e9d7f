#pragma once

/// \file
/// The fields of a model: grids of numbers over the box, which agents read and change.
///
/// ```cpp
/// #include "gridlock/model/model.hpp"
/// struct Grass {
///   static constexpr std::string_view name = "grass";
/// };
/// struct Grazers {
///   static constexpr Schedule schedule = Schedule::sequential;
///   using Agents = Population<X, Y>;
///   using Fields = FieldSet<Grass>;
///   std::size_t columns(Grass) const { return 100; }
///   double cutoff() const { return 0.1; }
///   double time_step() const { return 1.0; }
///   void start(World<Grazers>& world) const { std::ranges::fill(field_of<Grass>(world).values(), 1.0); }
///   void turn(Turn<Grazers>& self) const { self.take<Grass>(0.5); }
///   void step_fields(FieldsOfStep<Grazers>& fields) const { fields.spread<Grass>({.diffusion = 0.01}); }
/// };
/// ```

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "gridlock/core/detail/thread_pool.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/core/spread.hpp"
#include "gridlock/core/world.hpp"
#include "gridlock/model/detail/field_requests.hpp"
#include "gridlock/model/detail/named_set.hpp"

namespace gridlock {

/// The fields of a model, each a tag `struct Grass { static constexpr std::string_view name = "grass"; };`.
///
/// ```cpp
/// struct Scent {
///   static constexpr std::string_view name = "scent";
/// };
/// struct Food {
///   static constexpr std::string_view name = "food";
/// };
/// using Fields = FieldSet<Scent, Food>;
/// static_assert(Fields::place_of<Food> == 0);  // World::fields has the order of the names
/// ```
template <class... Tags>
struct FieldSet : NamedSet<Tags...> {};

template <class Model>
struct FieldsOfModel {
  using type = FieldSet<>;
};
template <class Model>
requires requires { typename Model::Fields; }
struct FieldsOfModel<Model> {
  using type = typename Model::Fields;
};
/// The FieldSet of a model, `Model::Fields`; empty if the model declares no fields.
template <class Model>
using FieldsOf = typename FieldsOfModel<Model>::type;

template <class Model>
consteval bool has_fields() {
  return FieldsOf<Model>::count > 0;
}

/// Return a field of a world. Cost: none.
template <class Tag, class Model>
Field& field_of(World<Model>& world) {
  static_assert(FieldsOf<Model>::template has<Tag>, "the model names each of its fields in Fields");
  return world.fields[FieldsOf<Model>::template place_of<Tag>];
}
template <class Tag, class Model>
Field const& field_of(World<Model> const& world) {
  static_assert(FieldsOf<Model>::template has<Tag>, "the model names each of its fields in Fields");
  return world.fields[FieldsOf<Model>::template place_of<Tag>];
}

/// Returns the random numbers with which a model fills a cell of its fields at the start; those of agents are others.
template <class Model>
RandomStream start_random_of_cell(World<Model> const& world, std::size_t cell) {
  return {world.seed, 1, cell, Purpose::model_start};
}

/// The name and the cells of a field.
struct FieldShape {
  std::string name;
  std::size_t columns = 0;
  std::size_t rows = 0;
};

/// Returns the point in the middle of a cell.
[[nodiscard]] Vector centre_of_cell(Field const& field, Box const& box, std::size_t cell);

/// Returns the rows with which cells in `columns` columns are most nearly squares; at least 1.
std::size_t rows_of_squares(Box const& box, std::size_t columns);

/// Returns the shapes of the fields of a model, in the order of their names, from Model::columns(Tag) and, where the
/// model has it, Model::rows(Tag).
template <class Model>
std::vector<FieldShape> shapes_of_fields(Model const& model, Box const& box) {
  auto const shape = [&](auto tag) -> FieldShape {
    using Tag = typename decltype(tag)::type;
    std::size_t const columns = model.columns(Tag{});
    if constexpr (requires { model.rows(Tag{}); }) {
      return {std::string(Tag::name), columns, model.rows(Tag{})};
    } else {
      return {std::string(Tag::name), columns, rows_of_squares(box, columns)};
    }
  };
  std::vector<FieldShape> shapes = [&]<class... Tags>(std::type_identity<FieldSet<Tags...>>) {
    return std::vector<FieldShape>{shape(std::type_identity<Tags>{})...};
  }(std::type_identity<FieldsOf<Model>>{});
  std::ranges::sort(shapes, {}, &FieldShape::name);
  return shapes;
}

/// The fields of a world at the end of a step, which Model::step_fields() changes as a whole: they spread, regrow, or
/// follow a rule of their own.
/// Errors: RunFailure for a field that has a value then that is infinite or no number.
///
/// ```cpp
/// struct Heat {
///   static constexpr std::string_view name = "heat";
/// };
/// struct Plate {
///   using Agents = Population<X, Y>;
///   using Fields = FieldSet<Heat>;
///   void step_fields(FieldsOfStep<Plate>& fields) const {
///     for (double& value : fields.get<Heat>().values()) value = 0.99 * value;
///   }
/// };
/// ```
template <class Model>
class FieldsOfStep {
 public:
  FieldsOfStep(World<Model>& world, double time_step, ThreadPool& threads)
      : world_(world), time_step_(time_step), threads_(threads) {}

  [[nodiscard]] Box const& box() const { return world_.box; }
  [[nodiscard]] Clock const& clock() const { return world_.clock; }
  [[nodiscard]] double time_step() const { return time_step_; }
  template <class Tag>
  [[nodiscard]] Field& get() {
    is_changed_[FieldsOf<Model>::template place_of<Tag>] = true;
    return field_of<Tag>(world_);
  }
  /// Spreads a field for one time step, see spread(): `diffusion` is an area over a time, `decay` 1 over a time.
  /// Errors: Error for rates that are negative, infinite or no numbers.
  template <class Tag>
  void spread(Spreading const& rates) {
    gridlock::spread(get<Tag>(), box(), {rates.diffusion * time_step_, rates.decay * time_step_}, threads_);
  }
  /// Returns the random numbers of a cell in this step; those of agents are others.
  [[nodiscard]] RandomStream random(std::size_t cell) const {
    return {world_.seed, world_.clock.step, cell + 1, Purpose::model_step};
  }
  void require_finite() const {
    for (std::size_t k = 0; k < is_changed_.size(); ++k) {
      if (is_changed_[k]) gridlock::require_finite(world_.fields[k], world_.clock.step);
    }
  }

 private:
  World<Model>& world_;
  double time_step_;
  ThreadPool& threads_;
  std::array<bool, FieldsOf<Model>::count> is_changed_{};
};

/// Puts the fields of a model into an empty world, of zeros, and lets Model::start_fields() fill them.
template <class Model>
void start_fields(Model const& model, World<Model>& world) {
  if constexpr (has_fields<Model>()) {
    world.fields.clear();
    for (auto const& [name, columns, rows] : shapes_of_fields(model, world.box)) {
      world.fields.emplace_back(name, columns, rows);
    }
    if constexpr (requires { model.start_fields(world); }) model.start_fields(world);
  }
}

/// Throws Error for a world without the fields of its model, or with values that are infinite or no numbers.
template <class Model>
void require_fields(Model const& model, World<Model> const& world) {
  if constexpr (has_fields<Model>()) require_good_fields(world.fields, shapes_of_fields(model, world.box));
}

}  // namespace gridlock
