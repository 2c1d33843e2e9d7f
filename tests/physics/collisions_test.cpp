// Viscosities, free paths and free times of the engine "exact" against kinetic theory. Units: σ = m = 1.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/temperature.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/lattice/start.hpp"
#include "gridlock/observe/observable.hpp"
#include "unit/observe/hand_built.hpp"

namespace gridlock {
namespace {

constexpr double pi = std::numbers::pi;

/// The contact value of Henderson (1975, doi:10.1080/00268977500102511).
double contact_value(double filled) { return (1.0 - 7.0 * filled / 16.0) / ((1.0 - filled) * (1.0 - filled)); }

/// A fluid in equilibrium whose collisions one observable of `settings`, with the column `name`, sees.
class ReportedFluid {
 public:
  ReportedFluid(std::size_t count, double filled, ObserveSettings const& settings, std::string const& name)
      : state_(make_start(box_for(count, filled), {.count = count, .radius = 0.5}, 7)) {
    draw_velocities(state_, {.kind = VelocityKind::maxwell, .max = 2.0});
    engine_ = make_engine({.kind = "exact", .time_step = 1e9, .threads = 1}, state_);
    engine_->advance(state_, counters_, {.pair_collisions = 20 * count});
    for (auto& observable : make_observables(settings, {state_, counters_})) {
      auto const columns = observable->columns();
      if (std::ranges::find(columns, name, &ColumnInfo::name) != columns.end()) observable_ = std::move(observable);
    }
    engine_->report_collisions([this](PairCollision const& collision) { observable_->collided(collision); });
  }
  void measure(std::size_t samples, double interval) {
    double const start = state_.clock.time;
    for (std::size_t k = 1; k <= samples; ++k) {
      engine_->advance(state_, counters_, {.time = start + interval * static_cast<double>(k)});
      hand_built::sample(*observable_, state_, counters_);
    }
  }
  [[nodiscard]] Estimate result(std::string const& name) const { return *hand_built::result(*observable_, name); }
  [[nodiscard]] Observable const& observable() const { return *observable_; }
  [[nodiscard]] double temperature() const { return *gridlock::temperature(state_); }

 private:
  static Box box_for(std::size_t count, double filled) {
    double const side = std::sqrt(static_cast<double>(count) * pi / 4.0 / filled);
    return {side, side, Edge::periodic};
  }
  State state_;
  Counters counters_;
  std::unique_ptr<Engine> engine_;
  std::unique_ptr<Observable> observable_;
};

TEST(ViscositiesOfAFluid, AreThoseOfEnskog) {
  // D. M. Gass (1971), doi:10.1063/1.1675116. The fluid is so small and the run so short that the errors are 6 %.
  constexpr double filled = 0.1;
  ReportedFluid fluid(200, filled, {.structure_every = 0, .viscosity_lag = 24}, "shear_viscosity");
  fluid.measure(8000, 1.0);
  double const unit = std::sqrt(fluid.temperature() / pi);
  double const g = contact_value(filled);
  double const bulk = 8.0 / pi * filled * filled * g * unit;
  double const shear = 0.511 * unit * std::pow(1.0 + filled * g, 2) / g + 0.5 * bulk;
  Estimate const found = fluid.result("shear_viscosity");
  EXPECT_LT(*found.error, 0.1 * shear);
  EXPECT_NEAR(found.value, shear, 3.0 * *found.error);
  Estimate const found_bulk = fluid.result("bulk_viscosity");
  EXPECT_LT(*found_bulk.error, 0.15 * bulk);
  EXPECT_NEAR(found_bulk.value, bulk, 3.0 * *found_bulk.error);
}

/// Averages over the speeds of a gas in units of √(kT/m), with the collision rate r(v) in units of 2 σ ρ g √(kT/m):
/// r is the mean speed relative to the others, √(π/2) L_½(−v²/2).
template <class ValueOf>
double mean_over_speeds(ValueOf value_of) {
  double sum = 0.0;
  constexpr double step = 5e-3;
  for (double v = 0.5 * step; v < 9.0; v += step) {
    double const x = 0.25 * v * v;
    double const bessel = (1.0 + 2.0 * x) * std::cyl_bessel_i(0.0, x) + 2.0 * x * std::cyl_bessel_i(1.0, x);
    sum += step * v * std::exp(-0.5 * v * v) * value_of(v, std::sqrt(0.5 * pi) * std::exp(-x) * bessel);
  }
  return sum;
}

/// The root mean square of the differences between densities of a table and share_of(lower, upper)/width, in errors, in
/// bins of at least 200 flights.
template <class ShareOf>
double root_of_chi_squared(Distribution const& table, ShareOf share_of) {
  double squares = 0.0;
  int bins = 0;
  for (std::size_t k = 0; k < table.columns_of_values[0].size(); ++k) {
    double const middle = table.columns_of_values[0][k];
    if (table.columns_of_values[3][k] < 200.0) continue;
    double const width = std::exp2(std::floor(std::log2(middle))) / 8.0;
    double const expected = share_of(middle - 0.5 * width, middle + 0.5 * width) / width;
    squares += std::pow((table.columns_of_values[1][k] - expected) / table.columns_of_values[2][k], 2);
    ++bins;
  }
  EXPECT_GT(bins, 40);
  return std::sqrt(squares / bins);
}

TEST(FreeFlightsOfAGas, HaveThePathsAndTimesOfUncorrelatedCollisions) {
  constexpr double filled = 0.01;
  ReportedFluid gas(1000, filled, {.structure_every = 0, .free_flights = true}, "mean_free_path");
  gas.measure(250, 30.0);
  double const density = 4.0 * filled / pi;
  Estimate const path = gas.result("mean_free_path");
  double const expected = 1.0 / (2.0 * std::numbers::sqrt2 * density * contact_value(filled));
  EXPECT_LT(*path.error, 0.004 * expected);
  EXPECT_NEAR(path.value, expected, 3.0 * *path.error);
  // p(τ) = ⟨r² exp(−rτ)⟩/⟨r⟩, and the same for paths vτ.
  double const thermal = std::sqrt(gas.temperature());
  double const unit = 2.0 * density * contact_value(filled) * thermal;
  double const rate = mean_over_speeds([](double /*v*/, double r) { return r; });
  EXPECT_NEAR(rate, std::sqrt(pi), 1e-5);
  auto const tables = gas.observable().distributions();
  EXPECT_LT(root_of_chi_squared(tables.at(0),
                                [&](double from, double to) {
                                  return mean_over_speeds([&](double /*v*/, double r) {
                                    return r / rate * (std::exp(-r * unit * from) - std::exp(-r * unit * to));
                                  });
                                }),
            1.4);
  // Equal rates of all disks would give an exponential, which is far off.
  EXPECT_GT(root_of_chi_squared(
                tables.at(0),
                [&](double from, double to) { return std::exp(-rate * unit * from) - std::exp(-rate * unit * to); }),
            2.0);
  EXPECT_LT(root_of_chi_squared(tables.at(1),
                                [&](double from, double to) {
                                  return mean_over_speeds([&](double v, double r) {
                                    double const per_length = r * unit / (v * thermal);
                                    return r / rate * (std::exp(-per_length * from) - std::exp(-per_length * to));
                                  });
                                }),
            1.4);
}

}  // namespace
}  // namespace gridlock
