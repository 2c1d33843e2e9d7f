// Swap Monte Carlo: the same bits however it is cut, refusals, and what the report says.

#include "gridlock/engine/swap_monte_carlo.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/grid/validate.hpp"
#include "gridlock/lattice/start.hpp"
#include "io/checkpoint.hpp"

namespace gridlock {
namespace {

State fluid(std::uint64_t count, double packing_fraction, Edge edge = Edge::periodic) {
  DisksSettings const disks{.count = count,
                            .packing_fraction = packing_fraction,
                            .sizes = SizeDistribution::inverse_cube,
                            .start = StartKind::random};
  State state = make_start(Box(1.0, 0.8, edge), disks, 5);
  draw_velocities(state, {});
  return state;
}

std::vector<double> sorted_values(std::span<double const> values) {
  std::vector<double> copy(values.begin(), values.end());
  std::ranges::sort(copy);
  return copy;
}

TEST(SwapMonteCarlo, KeepsRadiiVelocitiesAndMassesAndNeverMakesAnOverlap) {
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    State const start = fluid(150, 0.5, edge);
    State state = start;
    SwapMonteCarlo swaps({.sweeps = 300}, state);
    EXPECT_TRUE(swaps.advance(state));
    EXPECT_NO_THROW(validate(state));
    EXPECT_EQ(sorted_values(state.agents.column<Radius>()), sorted_values(start.agents.column<Radius>()));
    EXPECT_TRUE(std::ranges::equal(state.agents.column<VelocityX>(), start.agents.column<VelocityX>()));
    EXPECT_TRUE(std::ranges::equal(state.agents.column<Mass>(), start.agents.column<Mass>()));
    EXPECT_EQ(state.clock, start.clock);
    EXPECT_FALSE(std::ranges::equal(state.agents.column<Radius>(), start.agents.column<Radius>()));
    EXPECT_GT(swaps.counts().accepted_swaps, 0U);
    EXPECT_GT(swaps.counts().accepted_displacements, 0U);
  }
}

TEST(SwapMonteCarlo, WithoutSwapsLeavesEveryRadiusWhereItIs) {
  State const start = fluid(100, 0.5);
  State state = start;
  SwapMonteCarlo swaps({.sweeps = 50, .swap_fraction = 0.0}, state);
  swaps.advance(state);
  EXPECT_TRUE(std::ranges::equal(state.agents.column<Radius>(), start.agents.column<Radius>()));
  EXPECT_NE(hash(state), hash(start));
  EXPECT_EQ(swaps.counts().swaps, 0U);
  EXPECT_FALSE(swaps.report().swap_acceptance.has_value());
}

std::string saved_swaps(SwapMonteCarlo& swaps, State& state) {
  return to_checkpoint([&](Archive& archive) {
    serialize_inside(archive, "state", [&] { serialize(archive, state); });
    serialize_inside(archive, "swaps", [&] { swaps.serialize(archive, state); });
  });
}

void restore_swaps(std::string const& bytes, SwapMonteCarlo& swaps, State& state) {
  from_checkpoint(bytes, "test", [&](Archive& archive) {
    serialize_inside(archive, "state", [&] { serialize(archive, state); });
    serialize_inside(archive, "swaps", [&] { swaps.serialize(archive, state); });
  });
}

TEST(SwapMonteCarlo, StoppedSavedAndRestoredAtAnySweepEndsWithTheSameBits) {
  SwapSettings const settings{.sweeps = 400, .pressure = 3.0};
  State const start = fluid(80, 0.5);
  State whole = start;
  SwapMonteCarlo in_one(settings, whole);
  in_one.advance(whole);
  std::string const expected = saved_swaps(in_one, whole);
  // In the adjusting, at its end, at an origin, in between, at the end.
  for (std::uint64_t const stop : {1U, 17U, 39U, 40U, 41U, 63U, 64U, 200U, 399U, 400U}) {
    State state = start;
    SwapMonteCarlo first(settings, state);
    EXPECT_EQ(first.advance(state, [&] { return first.sweeps_done() < stop; }), stop == 400);
    EXPECT_EQ(first.sweeps_done(), stop);
    std::string const bytes = saved_swaps(first, state);
    // The run goes on in another process, which makes everything from the start and then restores.
    State resumed = start;
    SwapMonteCarlo second(settings, resumed);
    restore_swaps(bytes, second, resumed);
    EXPECT_TRUE(second.advance(resumed));
    EXPECT_EQ(hash(resumed), hash(whole)) << stop;
    EXPECT_EQ(saved_swaps(second, resumed), expected) << stop;
  }
}

TEST(SwapMonteCarlo, DoesNotDependOnTheOrderOfTheRows) {
  State const start = fluid(80, 0.5);
  State reversed{.box = start.box, .clock = start.clock, .seed = start.seed};
  Disks const& from = start.agents;
  for (std::size_t i = from.size(); i-- > 0;) {
    ASSERT_TRUE(reversed.agents.add_as(from.ids()[i], from.column<X>()[i], from.column<Y>()[i],
                                       from.column<VelocityX>()[i], from.column<VelocityY>()[i],
                                       from.column<Radius>()[i], from.column<Mass>()[i], 0, 0));
  }
  State state = start;
  SwapSettings const settings{.sweeps = 100, .step = 0.2, .pressure = 3.0};
  SwapMonteCarlo swaps(settings, state);
  SwapMonteCarlo swaps_of_reversed(settings, reversed);
  swaps.advance(state);
  swaps_of_reversed.advance(reversed);
  EXPECT_EQ(hash(state), hash(reversed));
}

TEST(SwapMonteCarlo, DependsOnTheSeedAndTheStage) {
  auto const hash_after = [](std::uint64_t seed, std::uint64_t stage) {
    State state = fluid(80, 0.5);
    state.seed = seed;
    SwapMonteCarlo swaps({.sweeps = 10, .stage = stage}, state);
    swaps.advance(state);
    state.seed = 0;
    return hash(state);
  };
  EXPECT_EQ(hash_after(1, 0), hash_after(1, 0));
  EXPECT_NE(hash_after(1, 0), hash_after(2, 0));
  EXPECT_NE(hash_after(1, 0), hash_after(1, 1));
}

TEST(SwapMonteCarlo, AdjustsTheStepToAnAcceptanceOfFortyPerCent) {
  State state = fluid(500, 0.5);
  SwapMonteCarlo swaps({.sweeps = 1000}, state);
  swaps.advance(state);
  SwapReport const report = swaps.report();
  EXPECT_NEAR(report.displacement_acceptance.value(), 0.4, 0.03);
  EXPECT_GT(report.step, 0.05);
  EXPECT_GT(report.swap_acceptance.value(), 0.01);
  // The sweeps of the adjusting count for no rate.
  EXPECT_LE(swaps.counts().displacements, 900U * 500U);
  EXPECT_GT(swaps.counts().displacements, 700U * 500U);
}

TEST(SwapMonteCarlo, AdjustsTheChangesOfTheAreaAndKeepsTheMixture) {
  State const start = fluid(80, 0.5);
  State state = start;
  SwapMonteCarlo swaps({.sweeps = 10'000, .swap_fraction = 0.0, .pressure = 5.0}, state);
  swaps.advance(state);
  EXPECT_NEAR(swaps.report().area_acceptance.value_or(0.0), 0.4, 0.1);
  auto const radii = state.agents.column<Radius>();
  double const factor = radii[0] / start.agents.column<Radius>()[0];
  EXPECT_GT(factor, 1.02) << "the pressure of the start is 3.0";
  for (std::size_t i = 0; i < radii.size(); ++i)
    EXPECT_NEAR(radii[i], factor * start.agents.column<Radius>()[i], 1e-12 * radii[i]);
  EXPECT_NO_THROW(validate(state, {.overlap = rounding_of_contact(state), .beyond_walls = rounding_of_contact(state)}));
  std::vector<SwapDensity> const densities = swaps.densities();
  ASSERT_EQ(densities.size(), 1000U);
  EXPECT_EQ(densities.back().sweep, 10'000U);
  EXPECT_EQ(std::ranges::count_if(densities, &SwapDensity::is_adjusting), 100);
}

TEST(SwapMonteCarlo, SaysThatADensityThatDriftsIsNoEquilibrium) {
  auto const report = [](std::uint64_t sweeps) {
    State state = fluid(60, 0.3);
    SwapMonteCarlo swaps({.sweeps = sweeps, .swap_fraction = 0.0, .pressure = 5.0}, state);
    swaps.advance(state);
    return swaps.report();
  };
  SwapReport const drifts = report(1500);
  EXPECT_GE(drifts.relaxation_times.value_or(0.0), 10.0);
  EXPECT_GT(drifts.density_drift.value_or(0.0), 1.0);
  EXPECT_FALSE(drifts.is_equilibrated);
  EXPECT_NE(drifts.warning.find("packing fraction"), std::string::npos);
  SwapReport const rests = report(60'000);
  EXPECT_LT(std::abs(rests.density_drift.value_or(1.0)), 0.5);
  EXPECT_TRUE(rests.is_equilibrated);
}

TEST(SwapMonteCarlo, KeepsAStepThatIsGiven) {
  State state = fluid(100, 0.3);
  SwapMonteCarlo swaps({.sweeps = 100, .step = 0.05}, state);
  swaps.advance(state);
  EXPECT_NEAR(swaps.report().step, 0.05, 1e-15);
  EXPECT_EQ(swaps.correlations().back().lag, 98U) << "the last origin is at 14 times 7 sweeps";
}

TEST(SwapMonteCarlo, SaysThatAFluidIsInEquilibriumAndAShortRunIsNot) {
  State state = fluid(300, 0.4);
  SwapMonteCarlo swaps({.sweeps = 4000}, state);
  swaps.advance(state);
  SwapReport const report = swaps.report();
  EXPECT_TRUE(report.is_equilibrated) << report.warning;
  EXPECT_TRUE(report.warning.empty());
  EXPECT_GT(report.overlap_relaxation_time.value(), 1.0);
  EXPECT_NEAR(report.relaxation_times.value(),
              3600.0 / std::max(report.overlap_relaxation_time.value(), report.bond_relaxation_time.value()), 1e-9);

  State brief_state = fluid(300, 0.4);
  SwapMonteCarlo brief({.sweeps = 8}, brief_state);
  brief.advance(brief_state);
  EXPECT_FALSE(brief.report().is_equilibrated);
  EXPECT_FALSE(brief.report().warning.empty());
}

TEST(SwapMonteCarlo, SaysThatACrystalHasNotRelaxed) {
  DisksSettings const disks{.count = 120, .packing_fraction = 0.83, .start = StartKind::triangular};
  State state = make_start(Box(1.0, 0.8660254037844386, Edge::periodic), disks, 5);
  SwapMonteCarlo swaps({.sweeps = 1000}, state);
  swaps.advance(state);
  SwapReport const report = swaps.report();
  EXPECT_FALSE(report.is_equilibrated);
  EXPECT_FALSE(report.bond_relaxation_time.has_value());
  EXPECT_NE(report.warning.find("have not relaxed within 900 sweeps"), std::string::npos) << report.warning;
}

// A gas so thin that nothing is refused: after t sweeps each coordinate of a disk has the variance σ² = t step²/3,
// relative to the mean of n neighbours (1 + 1/n) σ², and the share within c is 1 − exp(−c²/(2 (1 + 1/n) σ²)); n has
// Poisson's distribution.
TEST(SwapMonteCarlo, MeasuresTheOverlapOfAThinGasAsItsWalkIs) {
  constexpr double step = 0.05;
  DisksSettings const disks{.count = 2000, .packing_fraction = 1e-6, .start = StartKind::random};
  State state = make_start(Box(1.0, 1.0, Edge::periodic), disks, 5);
  SwapMonteCarlo swaps({.sweeps = 3200, .swap_fraction = 0.0, .step = step}, state);
  swaps.advance(state);
  double const mean_neighbours = std::numbers::pi * 1.5 * 1.5 * 2.0 / std::numbers::sqrt3;
  for (SwapCorrelation const& correlation : swaps.correlations()) {
    double const variance = static_cast<double>(correlation.lag) * step * step / 3.0;
    double expected = 0.0;
    double poisson = std::exp(-mean_neighbours);
    for (int n = 0; n < 60; ++n) {
      double const of_neighbours = n == 0 ? 0.0 : 1.0 / n;
      expected += poisson * (1.0 - std::exp(-0.3 * 0.3 / (2.0 * variance * (1.0 + of_neighbours))));
      poisson *= mean_neighbours / (n + 1);
    }
    // Few steps are no Gaussian walk, and few origins scatter.
    if (correlation.lag < 24 || correlation.origins < 8) continue;
    EXPECT_NEAR(correlation.self_overlap, expected, 0.015) << correlation.lag;
    EXPECT_GT(correlation.bond_orientation, 0.97) << "a thousandth of a spacing changes no bonds";
  }
  EXPECT_NEAR(swaps.report().overlap_relaxation_time.value(), 105.0, 8.0) << "σ² (1 + 1/n) = 0.3²/(2 · 0.459)";
}

Problem refusal_of_swaps(SwapSettings const& settings, State const& state) {
  try {
    SwapMonteCarlo const swaps(settings, state);
  } catch (Error const& error) {
    return error.problems().front();
  }
  ADD_FAILURE() << "nothing was refused";
  return {};
}

TEST(SwapMonteCarlo, RefusesSettingsOutOfTheirBoundsWithAHint) {
  State const state = fluid(10, 0.2);
  for (auto const& [settings, key] : {std::pair(SwapSettings{.sweeps = 0}, "swap.sweeps"),
                                      {SwapSettings{.sweeps = 1ULL << 40}, "swap.sweeps"},
                                      {SwapSettings{.swap_fraction = 1.0}, "swap.swap_fraction"},
                                      {SwapSettings{.swap_fraction = -0.1}, "swap.swap_fraction"},
                                      {SwapSettings{.step = 0.0}, "swap.step"},
                                      {SwapSettings{.step = std::numeric_limits<double>::infinity()}, "swap.step"},
                                      {SwapSettings{.adjusting = 1.0}, "swap.adjusting"},
                                      {SwapSettings{.pressure = 0.0}, "swap.pressure"},
                                      {SwapSettings{.stage = 1ULL << 24}, "swap.stage"}}) {
    Problem const problem = refusal_of_swaps(settings, state);
    EXPECT_EQ(problem.key, key);
    EXPECT_FALSE(problem.hint.empty());
  }
}

TEST(SwapMonteCarlo, RefusesStatesThatAreNotOfHardDisks) {
  EXPECT_EQ(refusal_of_swaps({}, State{.box = Box(1.0, 1.0, Edge::wall)}).key, "disks.count");
  State overlapping = fluid(10, 0.2);
  overlapping.agents.column<X>()[1] = overlapping.agents.column<X>()[0];
  overlapping.agents.column<Y>()[1] = overlapping.agents.column<Y>()[0];
  EXPECT_NE(refusal_of_swaps({}, overlapping).what.find("overlap by"), std::string::npos);
}

TEST(SwapMonteCarlo, RefusesToRestoreWhatAnotherRunSaved) {
  State state = fluid(40, 0.3);
  SwapMonteCarlo swaps({.sweeps = 100}, state);
  swaps.advance(state);
  std::string const bytes = saved_swaps(swaps, state);
  State other = fluid(40, 0.3);
  SwapMonteCarlo shorter({.sweeps = 50}, other);
  EXPECT_THROW(restore_swaps(bytes, shorter, other), Error);
}

TEST(SwapMonteCarlo, OfOneDiskIsAWalk) {
  State state{.box = Box(1.0, 1.0, Edge::periodic), .seed = 3};
  state.agents.add(0.5, 0.5, 0.0, 0.0, 0.1, 1.0, 0, 0);
  SwapMonteCarlo swaps({.sweeps = 100, .step = 1.0}, state);
  EXPECT_TRUE(swaps.advance(state));
  EXPECT_EQ(swaps.counts().accepted_displacements, swaps.counts().displacements);
  EXPECT_TRUE(swaps.report().overlap_relaxation_time.has_value());
}

}  // namespace
}  // namespace gridlock
