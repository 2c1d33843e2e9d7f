#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cstddef>
#include <initializer_list>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "gridlock/io/table.hpp"

namespace gridlock::python {

namespace nb = nanobind;

/// An array that owns what `values` has held, without a copy. `values` is a vector of any allocator.
template <class Values>
auto owned_array(Values&& values, std::initializer_list<std::size_t> shape,
                 std::initializer_list<std::int64_t> strides = {}) {
  using Vector = std::remove_cvref_t<Values>;
  auto* const kept = new Vector(std::forward<Values>(values));
  nb::capsule const owner(kept, [](void* memory) noexcept { delete static_cast<Vector*>(memory); });
  return nb::ndarray<nb::numpy, typename Vector::value_type>(kept->data(), shape, owner, strides);
}

/// The same for a list of numbers.
template <class Values>
auto owned_array(Values&& values) {
  std::size_t const size = values.size();
  return owned_array(std::forward<Values>(values), {size});
}

/// A column of a table: an array of numbers, or a list of words.
inline nb::object array_of_cells(CellColumn const& column) {
  return std::visit(
      [](auto values) -> nb::object {
        if constexpr (std::is_same_v<decltype(values), std::vector<std::string>>) {
          return nb::cast(values);
        } else {
          return nb::cast(owned_array(std::move(values)));
        }
      },
      column);
}

void bind_files(nb::module_& module);
void bind_grid(nb::module_& module);
void bind_model(nb::module_& module);
void bind_simulation(nb::module_& module);

}  // namespace gridlock::python
