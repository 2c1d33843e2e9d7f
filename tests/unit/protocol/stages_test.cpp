#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "gridlock/engine/growth.hpp"
#include "gridlock/engine/swap_monte_carlo.hpp"
#include "gridlock/packing/contact_network.hpp"
#include "gridlock/protocol/protocol.hpp"
#include "io/checkpoint.hpp"
#include "protocol/stage.hpp"
#include "unit/packing/same_levels.hpp"
#include "unit/protocol/fluid.hpp"

namespace gridlock {
namespace {

void expect_same(SwapResult const& a, SwapResult const& b) {
  EXPECT_EQ(a.displacement_acceptance, b.displacement_acceptance);
  EXPECT_EQ(a.swap_acceptance, b.swap_acceptance);
  EXPECT_EQ(a.area_acceptance, b.area_acceptance);
  EXPECT_EQ(a.density_sweeps, b.density_sweeps);
  EXPECT_EQ(a.packing_fractions, b.packing_fractions);
  EXPECT_EQ(a.adjusting_stretches, b.adjusting_stretches);
  EXPECT_EQ(a.overlap_relaxation_time, b.overlap_relaxation_time);
  EXPECT_EQ(a.bond_relaxation_time, b.bond_relaxation_time);
  EXPECT_EQ(a.relaxation_times, b.relaxation_times);
  EXPECT_EQ(a.density_drift, b.density_drift);
  EXPECT_EQ(a.is_equilibrated, b.is_equilibrated);
  EXPECT_EQ(a.lags, b.lags);
  EXPECT_EQ(a.self_overlap, b.self_overlap);
  EXPECT_EQ(a.bond_orientation, b.bond_orientation);
}

void expect_same(StageResult const& a, StageResult const& b) {
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_EQ(a.packing_fraction, b.packing_fraction);
  EXPECT_EQ(a.pressure, b.pressure);
  EXPECT_EQ(a.is_converged, b.is_converged);
  EXPECT_EQ(a.packing_fraction_without_minimum, b.packing_fraction_without_minimum);
  EXPECT_EQ(a.mean_overlap, b.mean_overlap);
  EXPECT_EQ(a.is_jammed, b.is_jammed);
  EXPECT_EQ(a.disks, b.disks);
  EXPECT_EQ(a.work, b.work);
  EXPECT_EQ(a.pair_collisions, b.pair_collisions);
  EXPECT_EQ(a.softest_mode, b.softest_mode);
  EXPECT_EQ(a.jamming_packing_fraction, b.jamming_packing_fraction);
  EXPECT_EQ(a.error_of_jamming_packing_fraction, b.error_of_jamming_packing_fraction);
  ASSERT_EQ(a.swap.has_value(), b.swap.has_value());
  if (a.swap) expect_same(*a.swap, *b.swap);
  expect_same(a.levels, b.levels);
}

/// The results of a protocol that is restored in each of its stages are those of the whole; these stages are
/// interrupted in their middle.
void expect_results_kept(ProtocolSettings const& settings, std::vector<StageResult> const& expected,
                         std::vector<std::size_t> const& interrupted) {
  State state = fluid();
  Protocol protocol(settings, state);
  std::vector<int> pieces(settings.stages.size() + 1, 0);
  for (bool is_done = false; !is_done;) {
    is_done = protocol.advance(state, [] { return false; });
    if (++pieces[protocol.stage()] != 2) continue;
    State other = state;
    Protocol resumed(settings, fluid());
    from_checkpoint(to_checkpoint([&](Archive& archive) { protocol.serialize(archive, state); }), "saved",
                    [&](Archive& archive) { resumed.serialize(archive, other); });
    ASSERT_TRUE(resumed.advance(other));
    ASSERT_EQ(resumed.results().size(), expected.size());
    for (std::size_t k = 0; k < expected.size(); ++k) {
      SCOPED_TRACE(testing::Message() << "stage " << k << ", restored in " << protocol.stage());
      expect_same(resumed.results()[k], expected[k]);
    }
  }
  for (std::size_t const stage : interrupted) EXPECT_GE(pieces[stage], 2) << "stage " << stage;
}

TEST(Stages, KeepTheirResultsWhereverTheProtocolIsRestored) {
  ProtocolSettings const settings{.stages = {{.kind = "swap", .sweeps = 600},
                                             {.kind = "event_chain", .sweeps = 600, .chains = ChainKind::newtonian},
                                             {.kind = "monte_carlo", .sweeps = 50, .pressure = 4.0},
                                             {.kind = "run", .collisions_per_disk = 300.0},
                                             {.kind = "quench", .packing_fraction = 0.9},
                                             {.kind = "decompress", .until_pressure = 1e-4},
                                             {.kind = "separate"},
                                             {.kind = "run", .collisions_per_disk = 300.0}},
                                  .time_step = 1e-4};
  State state = fluid();
  Protocol whole(settings, state);
  ASSERT_TRUE(whole.advance(state));
  std::vector<StageResult> const& expected = whole.results();
  ASSERT_TRUE(expected[0].swap->bond_relaxation_time && expected[0].swap->overlap_relaxation_time);
  ASSERT_TRUE(expected[1].pressure && expected[1].swap->bond_relaxation_time);
  ASSERT_TRUE(expected[2].pressure && expected[2].swap->area_acceptance);
  ASSERT_GT(expected[3].pair_collisions, 0U);
  ASSERT_TRUE(expected[5].error_of_jamming_packing_fraction.has_value());
  expect_results_kept(settings, expected, {0, 1, 2, 3, 4, 5, 7});
}

TEST(Stages, KeepTheResultsOfSlowGrowthWhereverItIsRestored) {
  ProtocolSettings const settings{.stages = {{.kind = "grow", .rate = 2e-4, .until_packing_fraction = 0.5},
                                             {.kind = "run", .collisions_per_disk = 10.0}}};
  State state = fluid();
  Protocol whole(settings, state);
  ASSERT_TRUE(whole.advance(state));
  ASSERT_TRUE(whole.results()[0].pressure.has_value());
  expect_results_kept(settings, whole.results(), {0});
}

TEST(Stages, TakesOverWhereDisksJamOnlyWhereTheyStayAsTheyAre) {
  State state = fluid();
  Protocol protocol({.stages = {{.kind = "quench", .packing_fraction = 0.9},
                                {.kind = "decompress", .until_pressure = 1e-3},
                                {.kind = "quench"},
                                {.kind = "quench", .packing_fraction = 0.95}}},
                    state);
  ASSERT_TRUE(protocol.advance(state));
  ASSERT_TRUE(protocol.results()[1].jamming_packing_fraction.has_value());
  EXPECT_EQ(protocol.results()[2].jamming_packing_fraction, protocol.results()[1].jamming_packing_fraction);
  ASSERT_TRUE(protocol.results()[1].error_of_jamming_packing_fraction.has_value());
  EXPECT_EQ(protocol.results()[2].error_of_jamming_packing_fraction,
            protocol.results()[1].error_of_jamming_packing_fraction);
  EXPECT_EQ(protocol.results()[3].jamming_packing_fraction, std::nullopt);
}

TEST(Stages, AreConvergedWhereNothingPressesAndNotWhereAPressureIsOutOfReach) {
  State state = fluid();
  Protocol protocol(
      {.stages = {{.kind = "quench", .packing_fraction = 0.5}, {.kind = "decompress", .until_pressure = 1e-4}}}, state);
  ASSERT_TRUE(protocol.advance(state));
  EXPECT_EQ(protocol.results()[0].is_converged, true);
  EXPECT_EQ(protocol.results()[0].pressure, 0.0);
  EXPECT_EQ(protocol.results()[0].packing_fraction_without_minimum, std::nullopt);
  EXPECT_EQ(protocol.results()[1].is_converged, false);
}

TEST(Stages, CountWhatTheEnginesCount) {
  State state = fluid();
  State grown = state;
  Protocol protocol({.stages = {{.kind = "grow", .rate = 0.05, .until_packing_fraction = 0.5}}}, state);
  ASSERT_TRUE(protocol.advance(state));
  GrowthSettings settings{.packing_fraction = 0.5};
  settings.rate = 0.05;
  Growth growth(settings, grown);
  Counters counters;
  ASSERT_TRUE(growth.advance(grown, counters));
  EXPECT_EQ(hash(state), hash(grown));
  EXPECT_EQ(protocol.results()[0].pair_collisions, counters.pair_collisions);
  EXPECT_EQ(protocol.results()[0].work, counters.moves);
  EXPECT_EQ(protocol.results()[0].pressure, growth.reduced_pressure());
}

TEST(Stages, RunForTheirTimeOneAfterTheOther) {
  State state = fluid();
  state.clock.time = 5.0;
  Protocol protocol(
      {.stages = {{.kind = "run", .until_time = 0.03}, {.kind = "run", .until_time = 0.02}}, .time_step = 1e-3}, state);
  ASSERT_TRUE(protocol.advance(state));
  EXPECT_NEAR(state.clock.time, 5.05, 1e-12);
}

TEST(Stages, SeparateDisksByTheLastBit) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    State state = fluid(seed % 2 == 0 ? Edge::wall : Edge::periodic);
    for (double& radius : state.agents.column<Radius>()) radius *= 1.0 + 0.01 * static_cast<double>(seed);
    Protocol protocol({.stages = {{.kind = "separate"}}}, state);
    ASSERT_TRUE(protocol.advance(state));
    EXPECT_TRUE(find_contacts(packing_of(state)).empty()) << seed;
  }
}

TEST(Stages, NameTheirSettingsInWhatTheyRefuse) {
  State const state = fluid();
  try {
    Protocol const protocol({.stages = {{.kind = "grow", .rate = 1e3, .until_packing_fraction = 0.6}}}, state);
    ADD_FAILURE() << "so fast no disk grows";
  } catch (Error const& error) {
    EXPECT_EQ(error.problems().front().key, "protocol[0].rate");
  }
}

TEST(Stages, ComesDownByLessThanATenthOfThePressure) {
  State state = fluid();
  Protocol first({.stages = {{.kind = "quench", .packing_fraction = 0.9}}}, state);
  ASSERT_TRUE(first.advance(state));
  double const pressure = *first.results()[0].pressure / 0.95;  // within the tenth that counts as the level
  Protocol second({.stages = {{.kind = "decompress", .until_pressure = pressure}}}, state);
  ASSERT_TRUE(second.advance(state));
  EXPECT_EQ(second.results()[0].is_converged, true);
  EXPECT_NEAR(*second.results()[0].pressure, pressure, 0.01 * pressure);
}

TEST(Stages, RunsUntilTheLastCollisionThatWasAskedFor) {
  State state = fluid();  // of 36 disks
  Protocol protocol({.stages = {{.kind = "run", .collisions_per_disk = 10.05}}}, state);
  ASSERT_TRUE(protocol.advance(state));
  EXPECT_EQ(protocol.results()[0].pair_collisions, 181U) << "10.05 · 36/2 = 180.9";
}

TEST(Stages, QuenchesToTheResidualOfTheSettings) {
  for (double const residual : {0.1, 1e-4, 1e-9}) {
    State state = fluid();
    Protocol protocol({.stages = {{.kind = "quench", .packing_fraction = 0.95}}, .soft = {.residual = residual}},
                      state);
    ASSERT_TRUE(protocol.advance(state));
    double const found = protocol.results()[0].levels.back().residual;
    EXPECT_LE(found, residual);
    EXPECT_TRUE(found > 1e-4 || residual < 0.1) << "no further than asked for";
  }
}

TEST(Stages, SwapsByRandomNumbersOfEachStage) {
  State state = fluid();
  State expected = state;
  Protocol protocol({.stages = {{.kind = "swap", .sweeps = 50}, {.kind = "swap", .sweeps = 50}}}, state);
  ASSERT_TRUE(protocol.advance(state));
  for (std::uint64_t const stage : {0U, 1U}) SwapMonteCarlo({.sweeps = 50, .stage = stage}, expected).advance(expected);
  EXPECT_EQ(hash(state), hash(expected));
}

TEST(Stages, TakesTheMeanOverlapOverTheContactsOfRattlersToo) {
  // A triangular lattice, and in one of its holes a small disk that hardly touches.
  double const row = std::sqrt(3.0) / 2.0;
  State state{.box = Box(4.0, 6.0 * row, Edge::periodic), .seed = 1};
  for (int k = 0; k < 24; ++k)
    state.agents.add(k % 4 + 0.5 * (k / 4 % 2), (k / 4 + 0.5) * row, 0.0, 0.0, 0.505, 1.0, 0, 0);
  double const distance = 0.555 * (1.0 - 1e-12);
  state.agents.add(distance * row, 0.5 * row + 0.5 * distance, 0.0, 0.0, 0.05, 1.0, 0, 0);
  Protocol protocol({.stages = {{.kind = "quench"}}}, state);
  ASSERT_TRUE(protocol.advance(state));
  StageResult const& result = protocol.results()[0];
  ASSERT_EQ(result.levels.back().backbone_contacts, 72U);
  std::vector<Contact> const contacts = find_contacts(packing_of(state));
  ASSERT_EQ(contacts.size(), 73U);
  double sum = 0.0;
  for (Contact const& contact : contacts) sum += contact.overlap();
  EXPECT_NEAR(*result.mean_overlap, sum / 73.0, 1e-12);
  EXPECT_GT(result.softest_mode.value(), 0.0);
  EXPECT_EQ(result.is_jammed, true);
}

TEST(Stages, WritesDisksBackFromSeveralBoxesAway) {
  State state = fluid();
  State const before = state;
  Packing packing = packing_of(state);
  packing.x[3] += 2.0 * state.box.width();
  packing.y[4] -= 3.0 * state.box.height();
  packing.y[5] += 2.0 * state.box.height();
  write_packing(packing, state);
  for (std::size_t i = 0; i < state.agents.size(); ++i) {
    EXPECT_NEAR(state.agents.column<X>()[i], before.agents.column<X>()[i], 1e-12) << i;
    EXPECT_NEAR(state.agents.column<Y>()[i], before.agents.column<Y>()[i], 1e-12) << i;
    EXPECT_EQ(state.agents.column<ImageX>()[i], i == 3 ? 2 : 0) << i;
    EXPECT_EQ(state.agents.column<ImageY>()[i], i == 4 ? -3 : i == 5 ? 2 : 0) << i;
  }
}

}  // namespace
}  // namespace gridlock
