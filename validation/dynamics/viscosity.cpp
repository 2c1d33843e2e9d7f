// Shear and bulk viscosity of hard disks, from the growth of the integrated stress.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "dynamics/sections.hpp"
#include "gridlock/observe/observable.hpp"

namespace gridlock::validation {
namespace {

double contact_value(double filled) { return (1.0 - 7.0 * filled / 16.0) / ((1.0 - filled) * (1.0 - filled)); }

/// The mean free time of Enskog at kT = 1.
double free_time(double filled) { return std::sqrt(pi) / (8.0 * filled * contact_value(filled)); }

double bulk_of_enskog(double filled) { return 8.0 / pi * filled * filled * contact_value(filled) / std::sqrt(pi); }

/// Enskog's shear viscosity, by D. M. Gass (1971), doi:10.1063/1.1675116.
double shear_of_enskog(double filled) {
  double const g = contact_value(filled);
  return 0.511 / std::sqrt(pi) * std::pow(1.0 + filled * g, 2) / g + 0.5 * bulk_of_enskog(filled);
}

/// Returns shear and bulk viscosity from the slope between a third of `longest` mean free times and all of it.
Numbers viscosities(std::size_t count, double filled, double longest, double free_times, std::uint64_t seed) {
  constexpr std::uint64_t samples_in_lag = 24;
  State state = fluid(count, filled, seed);
  Counters counters;
  auto const engine = make_engine(exact(), state);
  std::unique_ptr<Observable> viscosity;
  for (auto& one : make_observables({.structure_every = 0, .viscosity_lag = samples_in_lag}, {state, counters})) {
    auto const columns = one->columns();
    bool const is_it = std::ranges::find(columns, "shear_viscosity", &ColumnInfo::name) != columns.end();
    if (is_it) viscosity = std::move(one);
  }
  engine->report_collisions([&](PairCollision const& collision) { viscosity->collided(collision); });
  double const interval = longest * free_time(filled) / static_cast<double>(samples_in_lag);
  std::vector<double> row(viscosity->columns().size());
  for (double k = 1.0; k * interval < free_times * free_time(filled); ++k) {
    engine->advance(state, counters, {.time = k * interval});
    viscosity->sample({state, counters}, row, true);
  }
  Numbers numbers;
  for (NamedEstimate const& named : viscosity->results()) {
    if (named.name.ends_with("viscosity")) numbers.push_back(named.estimate.value);
  }
  return numbers;
}

}  // namespace

void viscosity() {
  struct Fluid {
    double filled;
    Estimate of_200;  ///< of an independent program, from the slope between 8 and 16 mean free times
  };
  for (auto const& [filled, of_200] :
       {Fluid{0.1, {0.3102, 0.0059}}, Fluid{0.3, {0.490, 0.009}}, Fluid{0.5, {1.180, 0.020}}}) {
    for (std::size_t const count : {200U, 500U}) {
      auto const found = means(16, [&, filled = filled](std::uint64_t seed) {
        return viscosities(count, filled, 16.0, count == 200 ? 8000.0 : 3200.0, seed);
      });
      auto const named = [&, filled = filled](char const* name) {
        return fmt::format("{} of {} disks at phi {}", name, count, filled);
      };
      double const shear = shear_of_enskog(filled);
      double const bulk = bulk_of_enskog(filled);
      if (count == 200) within_errors(named("shear viscosity"), found[0], of_200);
      within(named("shear viscosity over that of Enskog"), {found[0].value / shear, found[0].error / shear}, 1.0, 0.08);
      within(named("bulk viscosity over that of Enskog"), {found[1].value / bulk, found[1].error / bulk}, 1.0, 0.2);
    }
  }
}

}  // namespace gridlock::validation
