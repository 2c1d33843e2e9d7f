#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "gridlock/core/box.hpp"
#include "gridlock/core/frame.hpp"
#include "gridlock/grid/neighbour_lists.hpp"
#include "gridlock/io/table.hpp"

namespace gridlock::python {

namespace nb = nanobind;

using NamedValues = nb::typed<nb::dict, nb::str, nb::any>;
/// Points of the plane, an array of shape (N, 2).
using Points = nb::ndarray<double const, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;
/// Width, height, whether the box is periodic along x and along y, and the shift of its images above.
using BoxValues = std::tuple<double, double, bool, bool, double>;

/// Ids, columns, box, step, time, fields and networks of a frame.
using FrameValuesOfPython =
    std::tuple<nb::object, NamedValues, BoxValues, std::uint64_t, double, NamedValues, NamedValues>;
FrameValuesOfPython values_of_frame(Frame frame);

inline PointsInMemory view_of(Points const& points) {
  return {.x = points.data(), .y = points.data() + 1, .count = points.shape(0), .stride = 2};
}

inline BoxValues box_values(Box const& box) {
  return {box.width(), box.height(), box.is_periodic_x(), box.is_periodic_y(), box.shift()};
}

inline Box box_of(BoxValues const& values) {
  auto const& [width, height, is_periodic_x, is_periodic_y, shift] = values;
  auto const edge = [](bool is_periodic) { return is_periodic ? Edge::periodic : Edge::wall; };
  return Box(width, height, edge(is_periodic_x), edge(is_periodic_y)).shifted(shift);
}

/// Returns an array that takes over the memory of `values`, a vector with any allocator, without a copy.
template <class Values>
auto owned_array(Values&& values, std::initializer_list<std::size_t> shape,
                 std::initializer_list<std::int64_t> strides = {}) {
  using Vector = std::remove_cvref_t<Values>;
  auto* const kept = new Vector(std::forward<Values>(values));
  nb::capsule const owner(kept, [](void* memory) noexcept { delete static_cast<Vector*>(memory); });
  return nb::ndarray<nb::numpy, typename Vector::value_type>(kept->data(), shape, owner, strides);
}

/// Returns a one-dimensional array that takes over the memory of `values`.
template <class Values>
auto owned_array(Values&& values) {
  std::size_t const size = values.size();
  return owned_array(std::forward<Values>(values), {size});
}

/// Returns the pairs of a search as an array of shape (2, pairs).
inline auto array_of_pairs(PointPairs&& found) {
  std::size_t const count = found.size();
  return owned_array(std::move(found.indices), {2, count});
}

/// Returns the lists of a search: the index of each point's first neighbour, and all neighbours.
inline auto arrays_of_lists(NeighbourLists&& found) {
  return std::pair(owned_array(std::move(found.begin)), owned_array(std::move(found.neighbours)));
}

/// Returns a column of a table as an array of numbers or a list of words.
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

void bind_analysis(nb::module_& module);
void bind_files(nb::module_& module);
void bind_grid(nb::module_& module);
void bind_model(nb::module_& module);
void bind_packing(nb::module_& module);
void bind_simulation(nb::module_& module);

}  // namespace gridlock::python
