#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>

#include <cstdint>
#include <optional>
#include <tuple>
#include <utility>

#include "arrays.hpp"
#include "gridlock/device/neighbour_lists.hpp"
#include "gridlock/grid/neighbour_lists.hpp"

namespace gridlock::python {

namespace {

/// Returns whether a graphics processor searches. It searches boxes.
bool is_on_device(std::optional<bool> wish, std::optional<BoxValues> const& box) {
  return box && (wish ? *wish : device_of(Device::cpu) == Device::gpu);
}

auto pairs(Points const& points, double cutoff, std::optional<BoxValues> const& box, std::uint64_t threads,
           std::optional<bool> device) {
  PointPairs found;
  {
    nb::gil_scoped_release const released;
    if (is_on_device(device, box)) {
      found = find_pairs_on_device(box_of(*box), cutoff, view_of(points), threads);
    } else {
      found = box ? find_pairs(box_of(*box), cutoff, view_of(points), threads)
                  : find_pairs(cutoff, view_of(points), threads);
    }
  }
  return array_of_pairs(std::move(found));
}

using Radii = nb::ndarray<double const, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

auto pairs_of_disks(Points const& centers, Radii const& radius, double factor, double gap, BoxValues const& box,
                    std::uint64_t threads) {
  PointPairs found;
  {
    nb::gil_scoped_release const released;
    found = find_pairs_of_disks(box_of(box), {.factor = factor, .gap = gap}, view_of(centers),
                                {radius.data(), radius.shape(0)}, threads);
  }
  return array_of_pairs(std::move(found));
}

auto neighbor_lists(Points const& points, double cutoff, std::optional<BoxValues> const& box, std::uint64_t threads,
                    std::optional<bool> device) {
  NeighbourLists found;
  {
    nb::gil_scoped_release const released;
    if (is_on_device(device, box)) {
      found = find_neighbour_lists_on_device(box_of(*box), cutoff, view_of(points), threads);
    } else {
      found = box ? find_neighbour_lists(box_of(*box), cutoff, view_of(points), threads)
                  : find_neighbour_lists(cutoff, view_of(points), threads);
    }
  }
  return arrays_of_lists(std::move(found));
}

using Indices = nb::ndarray<std::uint32_t const, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Ends = nb::ndarray<std::uint64_t const, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Rows = nb::ndarray<double const, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

/// Sums the rows of `values` over the neighbours of each point, in the order of the lists.
template <std::size_t Columns>
void add_neighbors(Ends const& ends, Indices const& indices, Rows const& values, double* sums) {
  std::size_t const columns = Columns != 0 ? Columns : values.shape(1);
  for (std::size_t point = 0; point + 1 < ends.shape(0); ++point, sums += columns) {
    for (std::uint64_t k = ends(point); k < ends(point + 1); ++k) {
      double const* const row = values.data() + indices(k) * columns;
      for (std::size_t column = 0; column < columns; ++column) sums[column] += row[column];
    }
  }
}

auto neighbor_sums(Ends const& ends, Indices const& indices, Rows const& values) {
  std::size_t const points = ends.shape(0) - 1;
  std::size_t const columns = values.shape(1);
  LargeArray<double> sums(points * columns);
  {
    nb::gil_scoped_release const released;
    bool is_whole = ends(0) == 0 && ends(points) == indices.shape(0);
    for (std::size_t k = 0; k < points; ++k) is_whole = is_whole && ends(k) <= ends(k + 1);
    if (!is_whole) throw Error(Problem{.what = "the neighbours do not begin where those before them end"});
    for (std::size_t k = 0; k < indices.shape(0); ++k) {
      if (indices(k) >= values.shape(0)) throw Error(Problem{.what = "a neighbour has no row among the values"});
    }
    if (columns == 1) {
      add_neighbors<1>(ends, indices, values, sums.data());
    } else if (columns == 2) {
      add_neighbors<2>(ends, indices, values, sums.data());
    } else {
      add_neighbors<0>(ends, indices, values, sums.data());
    }
  }
  return owned_array(std::move(sums), {points, columns});
}

}  // namespace

void bind_grid(nb::module_& module) {
  module.def("pairs", &pairs, nb::arg("points"), nb::arg("cutoff"), nb::arg("box").none(), nb::arg("threads"),
             nb::arg("device").none());
  module.def("pairs_of_disks", &pairs_of_disks, nb::arg("centers"), nb::arg("radius"), nb::arg("factor"),
             nb::arg("gap"), nb::arg("box"), nb::arg("threads"));
  module.def("neighbor_lists", &neighbor_lists, nb::arg("points"), nb::arg("cutoff"), nb::arg("box").none(),
             nb::arg("threads"), nb::arg("device").none());
  module.def("neighbor_sums", &neighbor_sums, nb::arg("ends"), nb::arg("indices"), nb::arg("values"));
}

}  // namespace gridlock::python
