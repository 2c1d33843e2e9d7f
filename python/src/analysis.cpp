#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "gridlock/analysis/dynamics.hpp"
#include "gridlock/analysis/pair_correlation.hpp"
#include "gridlock/analysis/voronoi.hpp"
#include "gridlock/observe/clusters.hpp"
#include "gridlock/observe/observable.hpp"

namespace gridlock::python {

namespace {

using Frames = nb::ndarray<double const, nb::shape<-1, -1, 2>, nb::c_contig, nb::device::cpu>;
using Numbers = nb::ndarray<double const, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Kinds = nb::ndarray<std::uint32_t const, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

std::span<std::uint32_t const> span_of(std::optional<Kinds> const& kinds) {
  return kinds ? std::span(kinds->data(), kinds->shape(0)) : std::span<std::uint32_t const>{};
}

/// Returns a curve of all kinds as two arrays of shape (kinds, lags): values, and errors or NaN.
template <class Curves, class Of>
nb::object arrays_of(Curves const& of_kinds, std::vector<Estimate> Of::*curve) {
  std::size_t const kinds = of_kinds.size();
  std::size_t const lags = (of_kinds.front().*curve).size();
  if (lags == 0) return nb::none();
  std::vector<double> values;
  std::vector<double> errors;
  for (Of const& of_kind : of_kinds) {
    for (Estimate const& estimate : of_kind.*curve) {
      values.push_back(estimate.value);
      errors.push_back(estimate.error.value_or(no_value));
    }
  }
  return nb::make_tuple(owned_array(std::move(values), {kinds, lags}), owned_array(std::move(errors), {kinds, lags}));
}

using Begins = nb::ndarray<std::uint64_t const, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
/// The neighbours that displacements are relative to: those within a cutoff, Voronoi neighbours where the cutoff is 0,
/// or lists of every frame.
using Surroundings = std::tuple<double, std::optional<BoxValues>, std::vector<std::pair<Begins, Kinds>>>;

/// Returns the neighbours of all agents in a frame.
std::function<NeighbourLists(std::size_t)> finder(Surroundings const& surroundings, Frames const& positions,
                                                  std::uint64_t threads) {
  return [&, threads](std::size_t frame) -> NeighbourLists {
    auto const& [cutoff, sides, lists] = surroundings;
    if (!lists.empty()) {
      auto const& [begin, neighbours] = lists[frame];
      return {.begin = {begin.data(), begin.data() + begin.shape(0)},
              .neighbours = {neighbours.data(), neighbours.data() + neighbours.shape(0)}};
    }
    std::size_t const agents = positions.shape(1);
    double const* const first = positions.data() + 2 * frame * agents;
    PointsInMemory const points{.x = first, .y = first + 1, .count = agents, .stride = 2};
    if (!sides) return find_neighbour_lists(cutoff, points, threads);
    if (cutoff > 0.0) return find_neighbour_lists(box_of(*sides), cutoff, points, threads);
    return find_voronoi_cells(box_of(*sides), points, threads).neighbours;
  };
}

NamedValues dynamics(Frames const& positions, Numbers const& times, std::optional<Kinds> const& kinds,
                     double wave_number, double overlap_length, std::size_t max_lags, bool keeps_drift,
                     std::uint64_t threads, std::optional<Surroundings> const& surroundings) {
  Dynamics found;
  {
    nb::gil_scoped_release const released;
    DynamicsSettings settings{.wave_number = wave_number,
                              .overlap_length = overlap_length,
                              .max_lags = max_lags,
                              .keeps_drift = keeps_drift,
                              .threads = threads};
    if (surroundings) settings.neighbours = finder(*surroundings, positions, threads);
    found = find_dynamics({.positions = positions.data(),
                           .frames = positions.shape(0),
                           .agents = positions.shape(1),
                           .times = std::span(times.data(), times.shape(0)),
                           .kinds = span_of(kinds)},
                          settings);
  }
  NamedValues result;
  result["msd"] = arrays_of(found.kinds, &DynamicsOfKind::squared_displacement);
  result["non_gaussian"] = arrays_of(found.kinds, &DynamicsOfKind::non_gaussian);
  result["scattering"] = arrays_of(found.kinds, &DynamicsOfKind::scattering);
  result["overlap"] = arrays_of(found.kinds, &DynamicsOfKind::overlap);
  result["susceptibility"] = arrays_of(found.kinds, &DynamicsOfKind::susceptibility);
  result["total_susceptibility"] = arrays_of(std::span(&found, 1), &Dynamics::susceptibility);
  result["lag"] = owned_array(std::move(found.lag));
  result["origins"] = owned_array(std::move(found.origins));
  result["independent_origins"] = owned_array(std::move(found.independent_origins));
  return result;
}

/// Returns distances of shape (bins,) and g(r) of shape (kinds, kinds, bins).
auto pair_correlation(Points const& points, BoxValues const& box, double range, std::size_t bins,
                      std::optional<Kinds> const& kinds, std::uint64_t threads) {
  PairCorrelations found;
  {
    nb::gil_scoped_release const released;
    found = find_pair_correlations(box_of(box), view_of(points), range, bins, span_of(kinds), threads);
  }
  std::size_t const count = found.kinds;
  return std::pair(owned_array(std::move(found.distance)), owned_array(std::move(found.g), {count, count, bins}));
}

/// Returns the index of each point's first neighbour in the list of neighbours, that list, and the areas of the cells.
auto voronoi(Points const& points, BoxValues const& box, std::uint64_t threads) {
  VoronoiCells found;
  {
    nb::gil_scoped_release const released;
    found = find_voronoi_cells(box_of(box), view_of(points), threads);
  }
  return std::tuple(owned_array(std::move(found.neighbours.begin)), owned_array(std::move(found.neighbours.neighbours)),
                    owned_array(std::move(found.areas)));
}

/// Returns the number of the cluster of each of `count` agents, where agents i[k] and j[k] are in one.
auto clusters(std::size_t count, Kinds const& i, Kinds const& j) {
  std::vector<std::uint32_t> found;
  {
    nb::gil_scoped_release const released;
    found = cluster_of_each(count, std::span(i.data(), i.shape(0)), std::span(j.data(), j.shape(0)));
  }
  return owned_array(std::move(found));
}

using ValuesOfRuns = nb::ndarray<double const, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

/// Combines values and errors of shape (runs, points), where a missing error is NaN. Returns for every point: mean,
/// error, error from the scatter, error from the runs, and χ².
auto combine_runs(ValuesOfRuns const& values, ValuesOfRuns const& errors) {
  std::size_t const points = values.shape(1);
  auto const number = [](std::optional<double> const& value) { return value.value_or(no_value); };
  std::vector<double> result(5 * points);
  for (std::size_t point = 0; point < points; ++point) {
    std::vector<Estimate> runs;
    for (std::size_t run = 0; run < values.shape(0); ++run) {
      double const error = errors(run, point);
      runs.push_back({.value = values(run, point), .error = std::isnan(error) ? std::nullopt : std::optional(error)});
    }
    CombinedEstimate const found = combine(runs);
    result[point] = found.mean.value;
    result[points + point] = number(found.mean.error);
    result[2 * points + point] = number(found.error_by_scatter);
    result[3 * points + point] = number(found.error_by_runs);
    result[4 * points + point] = number(found.chi_squared);
  }
  return owned_array(std::move(result), {5, points});
}

}  // namespace

void bind_analysis(nb::module_& module) {
  module.def("dynamics", &dynamics, nb::arg("positions"), nb::arg("times"), nb::arg("kinds").none(),
             nb::arg("wave_number"), nb::arg("overlap_length"), nb::arg("most_lags"), nb::arg("keeps_drift"),
             nb::arg("threads"), nb::arg("surroundings").none());
  module.def("pair_correlation", &pair_correlation, nb::arg("points"), nb::arg("box"), nb::arg("range"),
             nb::arg("bins"), nb::arg("kinds").none(), nb::arg("threads"));
  module.def("clusters", &clusters, nb::arg("count"), nb::arg("i"), nb::arg("j"));
  module.def("combine", &combine_runs, nb::arg("values"), nb::arg("errors"));
  module.def("voronoi", &voronoi, nb::arg("points"), nb::arg("box"), nb::arg("threads"));
}

}  // namespace gridlock::python
