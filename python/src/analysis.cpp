#include <nanobind/stl/complex.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>

#include <cmath>
#include <complex>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "gridlock/analysis/collective_scattering.hpp"
#include "gridlock/analysis/dynamics.hpp"
#include "gridlock/analysis/pair_correlation.hpp"
#include "gridlock/analysis/strings.hpp"
#include "gridlock/analysis/structure_peak.hpp"
#include "gridlock/analysis/van_hove.hpp"
#include "gridlock/grid/voronoi.hpp"
#include "gridlock/observe/clusters.hpp"
#include "gridlock/observe/defects.hpp"
#include "gridlock/observe/observable.hpp"

namespace gridlock::python {

namespace {

using Frames = nb::ndarray<double const, nb::shape<-1, -1, 2>, nb::c_contig, nb::device::cpu>;
using Numbers = nb::ndarray<double const, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Kinds = nb::ndarray<std::uint32_t const, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

std::span<std::uint32_t const> span_of(std::optional<Kinds> const& kinds) {
  return kinds ? std::span(kinds->data(), kinds->shape(0)) : std::span<std::uint32_t const>{};
}

TrajectoryInMemory trajectory_of(Frames const& positions, Numbers const& times, std::optional<Kinds> const& kinds) {
  return {.positions = positions.data(),
          .frames = positions.shape(0),
          .agents = positions.shape(1),
          .times = std::span(times.data(), times.shape(0)),
          .kinds = span_of(kinds)};
}

/// The values and the errors, or NaN, of estimates.
class Curves {
 public:
  void add(Estimate const& estimate) {
    values_.push_back(estimate.value);
    errors_.push_back(estimate.error.value_or(no_value));
  }
  void add(std::vector<Estimate> const& estimates) {
    for (Estimate const& estimate : estimates) add(estimate);
  }
  auto values(std::initializer_list<std::size_t> shape) { return owned_array(std::move(values_), shape); }
  auto errors(std::initializer_list<std::size_t> shape) { return owned_array(std::move(errors_), shape); }

 private:
  std::vector<double> values_;
  std::vector<double> errors_;
};

/// Returns a curve of all kinds as two arrays of shape (kinds, lags): values, and errors or NaN.
template <class All, class Of>
nb::object arrays_of(All const& of_kinds, std::vector<Estimate> Of::*curve) {
  std::size_t const kinds = of_kinds.size();
  std::size_t const lags = (of_kinds.front().*curve).size();
  if (lags == 0) return nb::none();
  Curves curves;
  for (Of const& of_kind : of_kinds) curves.add(of_kind.*curve);
  return nb::make_tuple(curves.values({kinds, lags}), curves.errors({kinds, lags}));
}

using Begins = nb::ndarray<std::uint64_t const, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
/// The neighbours that displacements are relative to: those within a cutoff, Voronoi neighbours where the cutoff is 0,
/// or lists of every frame.
using Neighbourhood = std::tuple<double, std::optional<BoxValues>, std::vector<std::pair<Begins, Kinds>>>;

/// Returns the neighbours of all agents in a frame.
std::function<NeighbourLists(std::size_t)> finder(Neighbourhood const& neighbourhood, Frames const& positions,
                                                  std::uint64_t threads) {
  return [&, threads](std::size_t frame) -> NeighbourLists {
    auto const& [cutoff, sides, lists] = neighbourhood;
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
                     std::uint64_t threads, std::optional<Neighbourhood> const& neighbourhood) {
  Dynamics found;
  {
    nb::gil_scoped_release const released;
    DynamicsSettings settings{.wave_number = wave_number,
                              .overlap_length = overlap_length,
                              .max_lags = max_lags,
                              .keeps_drift = keeps_drift,
                              .threads = threads};
    if (neighbourhood) settings.neighbours = finder(*neighbourhood, positions, threads);
    found = find_dynamics(trajectory_of(positions, times, kinds), settings);
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

/// Returns wave number, number of wave vectors, lags, origins, independent origins, and F and its errors of shape
/// (kinds, kinds, lags).
auto collective_scattering(Frames const& positions, Numbers const& times, std::optional<Kinds> const& kinds,
                           BoxValues const& box, double wave_number, double width, std::size_t max_lags,
                           std::uint64_t threads) {
  CollectiveScattering found;
  {
    nb::gil_scoped_release const released;
    found = find_collective_scattering(
        box_of(box), trajectory_of(positions, times, kinds),
        {.wave_number = wave_number, .width = width, .max_lags = max_lags, .threads = threads});
  }
  std::initializer_list<std::size_t> const shape{found.kinds, found.kinds, found.lag.size()};
  Curves curves;
  curves.add(found.scattering);
  return std::make_tuple(found.wave_number, found.vectors, owned_array(std::move(found.lag)),
                         owned_array(std::move(found.origins)), owned_array(std::move(found.independent_origins)),
                         curves.values(shape), curves.errors(shape));
}

/// The lag, the origins and the independent origins of each lag.
struct LagsOfPython {
  std::vector<double> lag;
  std::vector<std::uint64_t> origins;
  std::vector<std::uint64_t> independent;

  void add(auto const& at) {
    lag.push_back(at.lag);
    origins.push_back(at.origins);
    independent.push_back(at.independent_origins);
  }
};

/// Returns distances, lags, the self part and its errors of shape (lags, kinds, bins), the distinct part and its errors
/// of shape (lags, kinds, kinds, bins) or nothing, origins and independent origins.
auto van_hove(Frames const& positions, Numbers const& times, std::optional<Kinds> const& kinds,
              std::optional<BoxValues> const& box, Numbers const& lags, double range, std::size_t bins,
              std::size_t max_origins, std::uint64_t threads) {
  VanHove found;
  {
    nb::gil_scoped_release const released;
    VanHoveSettings settings{.lags = {lags.data(), lags.data() + lags.shape(0)},
                             .range = range,
                             .bins = bins,
                             .max_origins = max_origins,
                             .threads = threads};
    if (box) settings.box = box_of(*box);
    found = find_van_hove(trajectory_of(positions, times, kinds), settings);
  }
  Curves self, distinct;
  LagsOfPython of_lags;
  for (VanHoveAtLag const& at : found.lags) {
    self.add(at.self);
    distinct.add(at.distinct);
    of_lags.add(at);
  }
  std::size_t const count = found.lags.size();
  std::initializer_list<std::size_t> const shape{box ? count : 0, found.kinds, found.kinds, bins};
  auto const where_box = [&](auto values) { return box ? std::optional(std::move(values)) : std::nullopt; };
  return std::make_tuple(owned_array(std::move(found.distance)), owned_array(std::move(of_lags.lag)),
                         self.values({count, found.kinds, bins}), self.errors({count, found.kinds, bins}),
                         where_box(distinct.values(shape)), where_box(distinct.errors(shape)),
                         owned_array(std::move(of_lags.origins)), owned_array(std::move(of_lags.independent)));
}

/// Returns lags, mean lengths and their errors, weighted lengths and theirs, the numbers of strings of each length for
/// each lag, the number of mobile agents, origins and independent origins.
auto string_lengths(Frames const& positions, Numbers const& times, std::optional<BoxValues> const& box,
                    Numbers const& lags, double distance, double mobile_share, std::size_t max_origins) {
  Strings found;
  {
    nb::gil_scoped_release const released;
    StringSettings settings{.lags = {lags.data(), lags.data() + lags.shape(0)},
                            .mobile_share = mobile_share,
                            .distance = distance,
                            .max_origins = max_origins};
    if (box) settings.box = box_of(*box);
    found = find_strings(trajectory_of(positions, times, std::nullopt), settings);
  }
  Curves mean, weighted;
  LagsOfPython of_lags;
  std::vector<decltype(owned_array(std::vector<double>{}))> strings;
  for (StringsAtLag& at : found.lags) {
    mean.add(at.mean_length);
    weighted.add(at.weighted_length);
    of_lags.add(at);
    strings.push_back(owned_array(std::move(at.strings)));
  }
  std::size_t const count = found.lags.size();
  return std::make_tuple(owned_array(std::move(of_lags.lag)), mean.values({count}), mean.errors({count}),
                         weighted.values({count}), weighted.errors({count}), strings, found.mobile_agents,
                         owned_array(std::move(of_lags.origins)), owned_array(std::move(of_lags.independent)));
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

using Orders = nb::ndarray<std::complex<double> const, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

std::span<std::complex<double> const> span_of(Orders const& orders) { return {orders.data(), orders.shape(0)}; }

/// Returns distances, g(r) and the correlation of the orders, each of shape (bins,).
auto order_correlation(Points const& points, Orders const& orders, BoxValues const& box, double range, std::size_t bins,
                       std::uint64_t threads) {
  PairCorrelations found;
  {
    nb::gil_scoped_release const released;
    found = find_pair_correlations(box_of(box), view_of(points), range, bins, {}, threads, span_of(orders));
  }
  return std::tuple(owned_array(std::move(found.distance)), owned_array(std::move(found.g)),
                    owned_array(std::move(found.order_correlation)));
}

/// Returns x of shape (columns,), y of shape (rows,), and g and the correlation of shape (rows, columns).
auto pair_correlation_map(Points const& points, BoxValues const& box, std::pair<double, double> half,
                          std::pair<std::size_t, std::size_t> bins, std::pair<double, double> along,
                          std::optional<Orders> const& orders, std::uint64_t threads) {
  PairCorrelationMap found;
  auto const [columns, rows] = bins;
  {
    nb::gil_scoped_release const released;
    found = find_pair_correlation_map(
        box_of(box), view_of(points),
        {.half = {half.first, half.second}, .columns = columns, .rows = rows, .along = {along.first, along.second}},
        orders ? span_of(*orders) : std::span<std::complex<double> const>{}, threads);
  }
  std::optional<nb::ndarray<nb::numpy, double>> correlation;
  if (orders) correlation = owned_array(std::move(found.order_correlation), {rows, columns});
  return std::tuple(owned_array(std::move(found.x)), owned_array(std::move(found.y)),
                    owned_array(std::move(found.g), {rows, columns}), correlation);
}

/// Returns vectors as an array of shape (N, 2).
auto array_of_vectors(std::vector<Vector> const& vectors) {
  std::vector<double> values;
  for (Vector const v : vectors) values.insert(values.end(), {v.x, v.y});
  return owned_array(std::move(values), {vectors.size(), 2});
}

/// Returns the wave vector of the peak, its height, all wave vectors of shape (M, 2) and S of shape (M,).
auto structure_peak(Points const& points, BoxValues const& box, std::pair<double, double> centre, double half_width,
                    std::uint64_t threads) {
  StructurePeak found;
  {
    nb::gil_scoped_release const released;
    found = find_structure_peak(box_of(box), view_of(points), {centre.first, centre.second}, half_width, threads);
  }
  return std::tuple(std::pair(found.at.x, found.at.y), found.height, array_of_vectors(found.wave_vectors),
                    owned_array(std::move(found.structure_factor)));
}

/// Returns the sides and the cluster of each point, and the kind, the number of points, the charge and the moment of
/// each cluster.
auto defects(Points const& points, BoxValues const& box, std::uint64_t threads) {
  Defects found;
  std::vector<std::uint32_t> sides;
  {
    nb::gil_scoped_release const released;
    NeighbourLists const neighbours = find_voronoi_cells(box_of(box), view_of(points), threads).neighbours;
    found = find_defects(box_of(box), view_of(points), neighbours);
    for (std::size_t i = 0; i < points.shape(0); ++i)
      sides.push_back(static_cast<std::uint32_t>(neighbours.begin[i + 1] - neighbours.begin[i]));
  }
  std::vector<std::uint32_t> kinds, sizes;
  std::vector<std::int32_t> charges;
  std::vector<Vector> moments;
  for (DefectCluster const& cluster : found.clusters) {
    kinds.push_back(static_cast<std::uint32_t>(cluster.kind));
    sizes.push_back(cluster.points);
    charges.push_back(cluster.charge);
    moments.push_back(cluster.moment);
  }
  return std::tuple(owned_array(std::move(sides)), owned_array(std::move(found.cluster)), owned_array(std::move(kinds)),
                    owned_array(std::move(sizes)), owned_array(std::move(charges)), array_of_vectors(moments));
}

/// Returns the index of each point's first neighbour in the list of neighbours, that list, the areas of the cells, and
/// the lengths of the edges with the neighbours.
auto voronoi(Points const& points, BoxValues const& box, std::uint64_t threads) {
  VoronoiCells found;
  {
    nb::gil_scoped_release const released;
    found = find_voronoi_cells(box_of(box), view_of(points), threads);
  }
  return std::tuple(owned_array(std::move(found.neighbours.begin)), owned_array(std::move(found.neighbours.neighbours)),
                    owned_array(std::move(found.areas)), owned_array(std::move(found.edge_lengths)));
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
             nb::arg("wave_number"), nb::arg("overlap_length"), nb::arg("max_lags"), nb::arg("keeps_drift"),
             nb::arg("threads"), nb::arg("neighbourhood").none());
  module.def("collective_scattering", &collective_scattering, nb::arg("positions"), nb::arg("times"),
             nb::arg("kinds").none(), nb::arg("box"), nb::arg("wave_number"), nb::arg("width"), nb::arg("max_lags"),
             nb::arg("threads"));
  module.def("van_hove", &van_hove, nb::arg("positions"), nb::arg("times"), nb::arg("kinds").none(),
             nb::arg("box").none(), nb::arg("lags"), nb::arg("range"), nb::arg("bins"), nb::arg("max_origins"),
             nb::arg("threads"));
  module.def("string_lengths", &string_lengths, nb::arg("positions"), nb::arg("times"), nb::arg("box").none(),
             nb::arg("lags"), nb::arg("distance"), nb::arg("mobile_share"), nb::arg("max_origins"));
  module.def("pair_correlation", &pair_correlation, nb::arg("points"), nb::arg("box"), nb::arg("range"),
             nb::arg("bins"), nb::arg("kinds").none(), nb::arg("threads"));
  module.def("order_correlation", &order_correlation, nb::arg("points"), nb::arg("orders"), nb::arg("box"),
             nb::arg("range"), nb::arg("bins"), nb::arg("threads"));
  module.def("pair_correlation_map", &pair_correlation_map, nb::arg("points"), nb::arg("box"), nb::arg("half"),
             nb::arg("bins"), nb::arg("along"), nb::arg("orders").none(), nb::arg("threads"));
  module.def("structure_peak", &structure_peak, nb::arg("points"), nb::arg("box"), nb::arg("centre"),
             nb::arg("half_width"), nb::arg("threads"));
  module.def("defects", &defects, nb::arg("points"), nb::arg("box"), nb::arg("threads"));
  module.def("clusters", &clusters, nb::arg("count"), nb::arg("i"), nb::arg("j"));
  module.def("combine", &combine_runs, nb::arg("values"), nb::arg("errors"));
  module.def("voronoi", &voronoi, nb::arg("points"), nb::arg("box"), nb::arg("threads"));
}

}  // namespace gridlock::python
