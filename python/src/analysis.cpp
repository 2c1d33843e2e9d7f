#include <nanobind/stl/optional.h>

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "gridlock/analysis/dynamics.hpp"
#include "gridlock/observe/observable.hpp"

namespace gridlock::python {

namespace {

using Frames = nb::ndarray<double const, nb::shape<-1, -1, 2>, nb::c_contig, nb::device::cpu>;
using Numbers = nb::ndarray<double const, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Kinds = nb::ndarray<std::uint32_t const, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

std::span<std::uint32_t const> view_of(std::optional<Kinds> const& kinds) {
  return kinds ? std::span(kinds->data(), kinds->shape(0)) : std::span<std::uint32_t const>{};
}

/// One curve of every kind as two arrays of shape (kinds, lags): values, and errors or no number.
nb::object arrays_of(Dynamics const& dynamics, std::vector<Estimate> DynamicsOfKind::*curve) {
  std::size_t const kinds = dynamics.kinds.size();
  std::size_t const lags = (dynamics.kinds.front().*curve).size();
  if (lags == 0) return nb::none();
  std::vector<double> values;
  std::vector<double> errors;
  for (DynamicsOfKind const& kind : dynamics.kinds) {
    for (Estimate const& estimate : kind.*curve) {
      values.push_back(estimate.value);
      errors.push_back(estimate.error.value_or(no_value));
    }
  }
  return nb::make_tuple(owned_array(std::move(values), {kinds, lags}), owned_array(std::move(errors), {kinds, lags}));
}

NamedValues dynamics(Frames const& positions, Numbers const& times, std::optional<Kinds> const& kinds, double wave_number,
                  double overlap_length, std::size_t most_lags, bool keeps_drift, std::uint64_t threads) {
  Dynamics found;
  {
    nb::gil_scoped_release const released;
    found = find_dynamics({.positions = positions.data(),
                           .frames = positions.shape(0),
                           .agents = positions.shape(1),
                           .times = std::span(times.data(), times.shape(0)),
                           .kinds = view_of(kinds)},
                          {.wave_number = wave_number,
                           .overlap_length = overlap_length,
                           .most_lags = most_lags,
                           .keeps_drift = keeps_drift,
                           .threads = threads});
  }
  NamedValues result;
  result["msd"] = arrays_of(found, &DynamicsOfKind::squared_displacement);
  result["non_gaussian"] = arrays_of(found, &DynamicsOfKind::non_gaussian);
  result["scattering"] = arrays_of(found, &DynamicsOfKind::scattering);
  result["overlap"] = arrays_of(found, &DynamicsOfKind::overlap);
  result["lag"] = owned_array(std::move(found.lag));
  result["origins"] = owned_array(std::move(found.origins));
  result["independent_origins"] = owned_array(std::move(found.independent_origins));
  return result;
}

}  // namespace

void bind_analysis(nb::module_& module) {
  module.def("dynamics", &dynamics, nb::arg("positions"), nb::arg("times"), nb::arg("kinds").none(),
             nb::arg("wave_number"), nb::arg("overlap_length"), nb::arg("most_lags"), nb::arg("keeps_drift"),
             nb::arg("threads"));
}

}  // namespace gridlock::python
