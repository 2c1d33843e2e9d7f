// Disks with a thermostat against exact statements and against an independent program. Units: σ = m = kT = 1.
//
// Free disks: the formulas follow from independent Gaussian velocities. Interacting disks: the canonical ensemble holds for
// any interval and any rate, so that K is a sum of N exponential numbers of mean kT. Self-diffusion and pressure were
// computed once by a short program that shares no code with this one.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "gridlock/engine/engine.hpp"
#include "gridlock/lattice/start.hpp"
#include "reference/mean_and_error.hpp"
#include "reference/unwrapped.hpp"

namespace gridlock {
namespace {

using reference::Estimate;
using reference::mean_of;
using reference::mean_squared_displacement;
using reference::unwrapped;

/// 256 disks in a fluid, as after many collisions.
State fluid(double packing_fraction, std::uint64_t seed, std::size_t count = 256) {
  double const side = std::sqrt(static_cast<double>(count) * std::numbers::pi / 4.0 / packing_fraction);
  State state =
      make_start(Box(side, side, Edge::periodic), {.count = count, .packing_fraction = packing_fraction}, seed);
  draw_velocities(state, {.kind = VelocityKind::maxwell, .max = 2.0});
  Counters counters;
  make_engine({.kind = "exact", .threads = 1}, state)->advance(state, counters, {.pair_collisions = 40 * count});
  state.clock = {};
  return state;
}

/// Steps in diameters of the tiny disks below.
constexpr double long_steps = 1e6;

/// Disks so small that in these tests none of them meets another.
State free_disks(std::size_t count, double temperature) {
  State state = make_start(Box(120.0, 100.0, Edge::periodic), {.count = count, .radius = 1e-7}, 4);
  draw_velocities(state, {.kind = VelocityKind::maxwell, .max = 2.0 * std::sqrt(temperature)});
  return state;
}

TEST(FreeBrownianDisks, DiffuseAsARandomFlight) {
  constexpr std::size_t count = 10'000;
  double const interval = 0.2;
  State state = free_disks(count, 1.0);
  auto const engine =
      make_engine({.kind = "exact",
                   .time_step = long_steps,
                   .thermostat = {.kind = ThermostatKind::brownian, .temperature = 1.0, .interval = interval}},
                  state);
  std::vector<Vector> const start = unwrapped(state);
  Counters counters;
  double const diffusion = 0.5 * interval;
  for (double const kicks : {1.0, 2.0, 7.0, 30.0}) {
    engine->advance(state, counters, {.time = kicks * interval});
    double const expected = 4.0 * diffusion * kicks * interval;
    // The squared displacement of a disk is exponential, so its standard deviation is its mean.
    EXPECT_NEAR(mean_squared_displacement(start, unwrapped(state)), expected, 4.0 * expected / std::sqrt(count));
  }
  EXPECT_EQ(counters.pair_collisions, 0U);
}

TEST(FreeAndersenDisks, ForgetTheirVelocityAtTheRateOfTheKicks) {
  constexpr std::size_t count = 10'000;
  double const rate = 1.5;
  State state = free_disks(count, 1.0);
  auto const engine = make_engine({.kind = "exact",
                                   .time_step = long_steps,
                                   .thermostat = {.kind = ThermostatKind::andersen, .temperature = 1.0, .rate = rate}},
                                  state);
  std::vector<Vector> const start = unwrapped(state);
  std::vector<Vector> first;
  for (std::size_t i = 0; i < count; ++i) first.push_back(velocity(state.agents, i));
  Counters counters;
  for (double const time : {0.3, 1.0, 4.0}) {
    engine->advance(state, counters, {.time = time});
    double const kept = std::exp(-rate * time);
    double const expected = 4.0 / rate * (time - (1.0 - kept) / rate);
    EXPECT_NEAR(mean_squared_displacement(start, unwrapped(state)), expected, 4.0 * 1.5 * expected / std::sqrt(count));
    double correlation = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      Vector const v = velocity(state.agents, i);
      correlation += (v.x * first[i].x + v.y * first[i].y) / (2.0 * count);
    }
    EXPECT_NEAR(correlation, kept, 4.0 * std::sqrt(1.0 / count)) << "time " << time;
  }
}

TEST(AndersenDisks, TakeTheTemperatureOfTheBathExponentiallyAtAnyDensity) {
  double const rate = 0.8;
  double const bath = 3.0;
  std::vector<std::vector<double>> energies(3);
  std::vector<double> const times{0.4, 1.0, 2.5};
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    State state = fluid(0.5, seed);
    double const at_start = kinetic_energy(state.agents) / 256.0;
    state.seed = seed;
    auto const engine = make_engine(
        {.kind = "exact", .thermostat = {.kind = ThermostatKind::andersen, .temperature = bath, .rate = rate}}, state);
    Counters counters;
    for (std::size_t k = 0; k < times.size(); ++k) {
      engine->advance(state, counters, {.time = times[k]});
      double const expected = bath + (at_start - bath) * std::exp(-rate * times[k]);
      energies[k].push_back(kinetic_energy(state.agents) / 256.0 - expected);
    }
    EXPECT_GT(counters.pair_collisions, 256U);
  }
  for (std::size_t k = 0; k < times.size(); ++k) {
    Estimate const difference = mean_of(energies[k]);
    EXPECT_NEAR(difference.value, 0.0, 4.0 * difference.error) << "time " << times[k];
  }
}

/// With momentum given and taken all N disks count, not N − 1.
TEST(BrownianDisks, HaveTheKineticEnergyOfTheCanonicalEnsemble) {
  constexpr std::size_t count = 16;
  State state = fluid(0.4, 3, count);
  double const interval = 0.3;
  auto const engine = make_engine(
      {.kind = "exact", .thermostat = {.kind = ThermostatKind::brownian, .temperature = 1.0, .interval = interval}},
      state);
  Counters counters;
  std::vector<double> energies;
  for (std::uint64_t kick = 1; kick <= 20'000; ++kick) {
    // Between two kicks, after some collisions.
    engine->advance(state, counters, {.time = (static_cast<double>(kick) + 0.9) * interval});
    energies.push_back(kinetic_energy(state.agents));
  }
  Estimate const mean = mean_of(energies);
  EXPECT_NEAR(mean.value, count, 4.0 * mean.error);
  std::vector<double> squares;
  for (double const energy : energies) squares.push_back((energy - count) * (energy - count));
  Estimate const variance = mean_of(squares);
  EXPECT_NEAR(variance.value, count, 4.0 * variance.error);
  // K has a Gamma distribution of shape N: as many in each of ten classes of equal probability, whose ends come from
  // SciPy's gamma.ppf(k/10, 16).
  std::vector<double> const ends{11.135297, 12.573893, 13.686387, 14.688144, 15.667930,
                                 16.690432, 17.832460, 19.233156, 21.292373};
  std::vector<double> in_class(ends.size() + 1, 0.0);
  for (double const energy : energies) {
    in_class[static_cast<std::size_t>(std::ranges::upper_bound(ends, energy) - ends.begin())] += 1.0;
  }
  double const expected = static_cast<double>(energies.size()) / static_cast<double>(in_class.size());
  double chi_squared = 0.0;
  for (double const found : in_class) chi_squared += (found - expected) * (found - expected) / expected;
  EXPECT_LT(chi_squared, 27.9) << "nine degrees of freedom are above this once in a thousand";
}

struct Fluid {
  double packing_fraction;
  double diffusion;  ///< D(2 … 6)/D₀ at an interval of 0.1
  double error;
};

class BrownianFluid : public testing::TestWithParam<Fluid> {};

/// The slope of the mean squared displacement over lags from 2 to 6 σ²/D₀ that begin at a kick.
TEST_P(BrownianFluid, DiffusesAsAnIndependentProgramFinds) {
  Fluid const expected = GetParam();
  double const interval = 0.1;
  double const diffusion = 0.5 * interval;
  constexpr std::size_t origins = 24;
  std::vector<double> slopes;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    State state = fluid(expected.packing_fraction, seed);
    auto const engine =
        make_engine({.kind = "exact",
                     .threads = 1,
                     .thermostat = {.kind = ThermostatKind::brownian, .temperature = 1.0, .interval = interval}},
                    state);
    Counters counters;
    double const unit = 1.0 / diffusion;  // σ²/D₀
    std::vector<std::vector<Vector>> places;
    for (std::size_t k = 0; k < origins + 6; ++k) {
      engine->advance(state, counters, {.time = static_cast<double>(k) * unit});
      places.push_back(unwrapped(state));
    }
    double sum = 0.0;
    for (std::size_t origin = 0; origin < origins; ++origin) {
      sum += mean_squared_displacement(places[origin], places[origin + 6]) -
             mean_squared_displacement(places[origin], places[origin + 2]);
    }
    slopes.push_back(sum / static_cast<double>(origins) / (4.0 * diffusion * 4.0 * unit));
  }
  Estimate const found = mean_of(slopes);
  EXPECT_LT(found.error, 0.02);
  EXPECT_NEAR(found.value, expected.diffusion, 4.0 * std::hypot(found.error, expected.error));
}

INSTANTIATE_TEST_SUITE_P(PackingFractions, BrownianFluid,
                         testing::Values(Fluid{0.1, 0.8136, 0.0042}, Fluid{0.3, 0.5474, 0.0027},
                                         Fluid{0.5, 0.3294, 0.0023}),
                         [](auto const& fluid) {
                           return "phi" + std::to_string(std::lround(100.0 * fluid.param.packing_fraction));
                         });

/// Kicks do not change averages over configurations.
TEST(BrownianDisks, HaveThePressureOfTheFluid) {
  struct Pressure {
    double packing_fraction, compressibility, error;
  };
  for (Pressure const& expected :
       {Pressure{0.1, 1.234, 0.002}, Pressure{0.2, 1.570, 0.002}, Pressure{0.4, 2.824, 0.002}}) {
    std::vector<double> found;
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
      State state = fluid(expected.packing_fraction, seed);
      ThermostatSettings const thermostat{.kind = ThermostatKind::brownian, .temperature = 1.0, .interval = 0.05};
      Counters counters;
      make_engine({.kind = "exact", .threads = 1, .thermostat = thermostat}, state)
          ->advance(state, counters, {.time = 50.0});
      found.push_back(1.0 + counters.pair_virial / (2.0 * 256.0 * 50.0));
    }
    Estimate const compressibility = mean_of(found);
    EXPECT_LT(compressibility.error, 0.01);
    EXPECT_NEAR(compressibility.value, expected.compressibility,
                4.0 * std::hypot(compressibility.error, expected.error));
  }
}

}  // namespace
}  // namespace gridlock
