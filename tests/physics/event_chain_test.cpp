// The pressure of event chains against that of other programs and methods.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "core/temperature.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/lattice/start.hpp"
#include "reference/mean_and_error.hpp"

namespace gridlock {
namespace {

using reference::Estimate;
using reference::mean_of;

/// Z of blocks of steps, as the observable of the pressure computes it.
Estimate pressure_of(EngineSettings const& settings, State state, std::uint64_t blocks, std::uint64_t steps) {
  auto const engine = make_engine(settings, state);
  Counters counters;
  std::uint64_t const equilibration = 20 * steps;
  engine->advance(state, counters, {.step = equilibration});
  std::vector<double> values;
  for (std::uint64_t k = 1; k <= blocks; ++k) {
    double const virial = counters.pair_virial;
    double const time = state.clock.time;
    engine->advance(state, counters, {.step = equilibration + k * steps});
    double const thermal = static_cast<double>(state.agents.size()) * temperature(state).value();
    values.push_back(1.0 + (counters.pair_virial - virial) / (2.0 * thermal * (state.clock.time - time)));
  }
  return mean_of(values);
}

State fluid(double packing_fraction, std::vector<SpeciesSettings> const& species = {}) {
  State state = make_start(Box(1.0, 1.0, Edge::periodic),
                           {.count = 256,
                            .packing_fraction = packing_fraction,
                            .start = species.empty() ? StartKind::square : StartKind::random,
                            .species = species},
                           5);
  draw_velocities(state, {.kind = VelocityKind::maxwell});
  return state;
}

class ChainPressure : public testing::TestWithParam<ChainKind> {};

// Z of 256 disks from the equation of state of an infinite system and the correction for a canonical one of this size,
// docs/notebook/dynamics.md; an independent program of straight chains finds 2.0595(4) and 4.0967(21).
TEST_P(ChainPressure, IsThatOfAsManyDisksInOtherPrograms) {
  EngineSettings const settings{.kind = "event_chain", .chains = GetParam()};
  for (auto const& [packing_fraction, expected] : {std::pair(0.3, 2.06024), std::pair(0.5, 4.09981)}) {
    Estimate const z = pressure_of(settings, fluid(packing_fraction), 60, 40);
    EXPECT_NEAR(z.value, expected, 3.5 * z.error) << packing_fraction;
    EXPECT_LT(z.error, 0.003 * expected);
  }
}

TEST_P(ChainPressure, OfAMixtureIsThatOfExact) {
  State const start = fluid(0.45, {{.fraction = 0.5}, {.fraction = 0.5, .size_ratio = 2.0, .mass = 1.0}});
  Estimate const chains = pressure_of({.kind = "event_chain", .chains = GetParam()}, start, 50, 30);
  double const mean_free_time = 0.05;
  Estimate const exact =
      pressure_of({.kind = "exact", .time_step = 10.0 * mean_free_time, .threads = 1}, start, 50, 20);
  EXPECT_NEAR(chains.value, exact.value, 3.5 * std::hypot(chains.error, exact.error));
  EXPECT_LT(chains.error + exact.error, 0.02 * exact.value);
}

INSTANTIATE_TEST_SUITE_P(Chains, ChainPressure, testing::Values(ChainKind::straight, ChainKind::newtonian),
                         [](auto const& kind) { return kind.param == ChainKind::straight ? "Straight" : "Newtonian"; });

}  // namespace
}  // namespace gridlock
