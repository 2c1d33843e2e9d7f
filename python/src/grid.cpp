#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>

#include <cstdint>
#include <optional>
#include <tuple>
#include <utility>

#include "arrays.hpp"
#include "gridlock/grid/neighbour_lists.hpp"

namespace gridlock::python {

namespace {

auto pairs(Points const& points, double cutoff, std::optional<BoxValues> const& box, std::uint64_t threads) {
  PointPairs found;
  {
    nb::gil_scoped_release const released;
    found =
        box ? find_pairs(box_of(*box), cutoff, view_of(points), threads) : find_pairs(cutoff, view_of(points), threads);
  }
  std::size_t const count = found.size();
  return owned_array(std::move(found.indices), {2, count});
}

auto neighbor_lists(Points const& points, double cutoff, std::optional<BoxValues> const& box, std::uint64_t threads) {
  NeighbourLists found;
  {
    nb::gil_scoped_release const released;
    found = box ? find_neighbour_lists(box_of(*box), cutoff, view_of(points), threads)
                : find_neighbour_lists(cutoff, view_of(points), threads);
  }
  return std::pair(owned_array(std::move(found.begin)), owned_array(std::move(found.neighbours)));
}

}  // namespace

void bind_grid(nb::module_& module) {
  module.def("pairs", &pairs, nb::arg("points"), nb::arg("cutoff"), nb::arg("box").none(), nb::arg("threads"));
  module.def("neighbor_lists", &neighbor_lists, nb::arg("points"), nb::arg("cutoff"), nb::arg("box").none(),
             nb::arg("threads"));
}

}  // namespace gridlock::python
