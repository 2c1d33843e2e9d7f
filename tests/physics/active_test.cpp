// Self-propelled disks against exact statements and against an independent program. Units of model B: σ = m = kT = 1.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "gridlock/engine/engine.hpp"
#include "gridlock/lattice/start.hpp"

namespace gridlock {
namespace {

struct FreeWay {
  double mean;
  double error;
};

/// The mean squared displacement of 10⁴ free disks over `time`, each alone in its world.
FreeWay free_way(EngineSettings const& settings, double time, std::uint64_t seed) {
  // Disks of one world would meet; far apart in a huge box, they do not.
  constexpr std::size_t count = 10'000;
  double const side = 1e6;
  State state{.box = Box(side, side, Edge::periodic), .seed = seed};
  for (std::size_t k = 0; k < count; ++k) {
    state.agents.add((0.5 + static_cast<double>(k % 100)) * 1e4, (0.5 + static_cast<double>(k / 100)) * 1e4, 0.0, 0.0,
                     0.5, 1.0, 0, 0);
  }
  State const start = state;
  Counters counters;
  make_engine(settings, state)->advance(state, counters, {.time = time});
  EXPECT_EQ(counters.pair_collisions, 0U);
  double sum = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    double const square = squared_length(position(state.agents, i) - position(start.agents, i));
    sum += square;
    squares += square * square;
  }
  double const mean = sum / count;
  return {mean, std::sqrt(std::max(0.0, squares / count - mean * mean) / count)};
}

/// v₀² Δt² [k (1 + q)/(1 − q) − 2q (1 − q^k)/(1 − q)²]: k ways of length v₀ Δt, each turned from the one before by a normal
/// angle of variance 2 D_R Δt, so that q = ⟨cos⟩ = e^(−D_R Δt).
double persistent_walk(double way, double turns, double k) {
  double const q = std::exp(-turns);
  return way * way * (k * (1.0 + q) / (1.0 - q) - 2.0 * q * (1.0 - std::pow(q, k)) / ((1.0 - q) * (1.0 - q)));
}

TEST(ActivePhysics, FreeDisksOfExactMakeAPersistentWalkAndDiffuse) {
  // Pe = v₀σ/D₀ = 40, D₀ = kT Δt/(2m), D_R = 3 D₀/σ².
  constexpr double interval = 0.1;
  constexpr double diffusion = interval / 2.0;
  EngineSettings const settings{
      .kind = "exact",
      .threads = 1,
      .thermostat = {.kind = ThermostatKind::brownian, .temperature = 1.0, .interval = interval},
      .propulsion = {.speed = 40.0 * diffusion, .rotational_diffusion = 3.0 * diffusion}};
  for (auto const& [kicks, expected] : {std::pair{10.0, 4.00921}, std::pair{40.0, 53.7178}}) {
    double const formula = 4.0 * diffusion * kicks * interval +
                           persistent_walk(40.0 * diffusion * interval, 3.0 * diffusion * interval, kicks);
    EXPECT_NEAR(formula, expected, 5e-6 * expected);
    FreeWay const way = free_way(settings, kicks * interval, 7);
    EXPECT_NEAR(way.mean, formula, 4.0 * way.error) << kicks;
  }
}

class FreeRule : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(All, FreeRule, testing::Values("stepped", "tiled"));

TEST_P(FreeRule, MakesAPersistentWalk) {
  for (double const turns : {0.02, 0.5, 3.0}) {
    EngineSettings settings{.kind = GetParam(), .time_step = 0.1, .speed = 2.0, .threads = 1};
    double const duration = 0.1 * 1.0 / 2.0;
    settings.propulsion = {.speed = 2.0, .rotational_diffusion = turns / duration};
    for (double const k : {1.0, 10.0, 100.0}) {
      FreeWay const way = free_way(settings, (k - 0.5) * duration, 11);
      double const formula = persistent_walk(0.1, turns, k);
      EXPECT_NEAR(way.mean, formula, 4.0 * way.error + 1e-9) << turns << ' ' << k;
    }
  }
}

/// v(φ)/v₀ of 200 disks, averaged over five times as long as a disk needs to go as far as 40 diameters.
double effective_speed(double packing_fraction, double peclet) {
  constexpr double interval = 0.1;
  constexpr double diffusion = interval / 2.0;
  constexpr std::size_t count = 200;
  double const side = std::sqrt(count * std::numbers::pi / 4.0 / packing_fraction);
  State state = make_start(Box(side, side, Edge::periodic), {.count = count, .packing_fraction = packing_fraction}, 3);
  EngineSettings const settings{
      .kind = "exact",
      .threads = 1,
      .thermostat = {.kind = ThermostatKind::brownian, .temperature = 1.0, .interval = interval},
      .propulsion = {.speed = peclet * diffusion, .rotational_diffusion = 3.0 * diffusion}};
  auto const engine = make_engine(settings, state);
  Counters counters;
  engine->advance(state, counters, {.time = 100.0});
  double const swum = counters.swum;
  double const if_free = counters.swum_if_free;
  engine->advance(state, counters, {.time = 500.0});
  EXPECT_EQ(counters.swum_if_free - if_free, 200.0 * 4000.0);
  return (counters.swum - swum) / (counters.swum_if_free - if_free);
}

TEST(ActivePhysics, EffectiveSpeedsAreThoseOfAnIndependentProgram) {
  // Model B of Ni, Cohen Stuart, Dijkstra (2013) in two dimensions, computed once by a program that shares no code.
  EXPECT_NEAR(effective_speed(0.2, 10.0), 0.756, 0.015);
  EXPECT_NEAR(effective_speed(0.2, 40.0), 0.723, 0.015);
  EXPECT_NEAR(effective_speed(0.4, 10.0), 0.517, 0.015);
  EXPECT_NEAR(effective_speed(0.4, 40.0), 0.468, 0.015);
}

}  // namespace
}  // namespace gridlock
