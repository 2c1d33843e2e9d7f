// The stage `event_chain` is the engine of this name before a run, with the clock at rest.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>

#include "gridlock/core/error.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/engine/swap_monte_carlo.hpp"
#include "gridlock/grid/validate.hpp"
#include "gridlock/lattice/start.hpp"
#include "gridlock/protocol/protocol.hpp"
#include "io/checkpoint.hpp"

namespace gridlock {
namespace {

State moving_disks(std::uint64_t count, double packing_fraction, Box const& box = Box(1.0, 1.0, Edge::periodic)) {
  State state = make_start(box, {.count = count, .packing_fraction = packing_fraction}, 4);
  draw_velocities(state, {.kind = VelocityKind::maxwell});
  return state;
}

class ChainsOf : public testing::TestWithParam<ChainKind> {};
INSTANTIATE_TEST_SUITE_P(Chains, ChainsOf, testing::Values(ChainKind::straight, ChainKind::newtonian),
                         [](auto const& kind) { return kind.param == ChainKind::straight ? "Straight" : "Newtonian"; });

TEST_P(ChainsOf, AreThoseOfTheEngineWithNumbersOfTheirStage) {
  State state = moving_disks(100, 0.5);
  state.clock = {.step = 7, .time = 5.0};
  State expected = state;
  StageSettings const stage{.kind = "event_chain", .sweeps = 20, .chains = GetParam(), .chain_length = 7};
  Protocol protocol({.stages = {stage, stage}}, state);
  ASSERT_TRUE(protocol.advance(state));
  EXPECT_EQ(state.clock, (Clock{.step = 7, .time = 5.0})) << "Monte Carlo has no time";
  for (std::uint64_t const number : {1U, 2U}) {
    expected.clock.step = number * (max_sweeps + 1);
    Counters counters;
    make_engine({.kind = "event_chain", .chains = GetParam(), .chain_length = 7}, expected)
        ->advance(expected, counters, {.step = expected.clock.step + 20});
    EXPECT_EQ(protocol.results()[number - 1].pair_collisions, counters.pair_collisions);
    EXPECT_EQ(protocol.results()[number - 1].work, counters.moves);
  }
  expected.clock = state.clock;
  EXPECT_EQ(hash(state), hash(expected));
}

TEST_P(ChainsOf, HaveTheSameBitsWhenAStageIsKilledAfterAnySweepAndRestored) {
  ProtocolSettings const settings{.stages = {{.kind = "event_chain", .sweeps = 40, .chains = GetParam()}}};
  State const start = moving_disks(64, 0.5);
  State whole = start;
  Protocol expected(settings, whole);
  ASSERT_TRUE(expected.advance(whole));
  State state = start;
  std::string saved;
  for (int sweep = 1;; ++sweep) {
    // Each piece is one sweep of a protocol that is restored from what the piece before has saved.
    Protocol protocol(settings, start);
    if (sweep > 1) {
      from_checkpoint(saved, "saved", [&](Archive& archive) {
        serialize(archive, state);
        protocol.serialize(archive, state);
      });
    }
    bool const is_done = protocol.advance(state, [] { return false; });
    ASSERT_EQ(is_done, sweep == 40);
    if (is_done) {
      EXPECT_EQ(protocol.results()[0].pressure, expected.results()[0].pressure);
      EXPECT_EQ(protocol.results()[0].swap->self_overlap, expected.results()[0].swap->self_overlap);
      break;
    }
    saved = to_checkpoint([&](Archive& archive) {
      serialize(archive, state);
      protocol.serialize(archive, state);
    });
  }
  EXPECT_EQ(hash(state), hash(whole));
}

// Z of 256 disks at .5 is 4.0998, docs/notebook/dynamics.md; the error of 4,000 sweeps is below .01.
TEST_P(ChainsOf, MeasureThePressureOfAFluidAndTheTimesInWhichItRelaxes) {
  State state = moving_disks(256, 0.5);
  Protocol protocol({.stages = {{.kind = "event_chain", .sweeps = 200, .chains = GetParam()},
                                {.kind = "event_chain", .sweeps = 4000, .chains = GetParam()}}},
                    state);
  ASSERT_TRUE(protocol.advance(state));
  StageResult const& result = protocol.results()[1];
  EXPECT_NEAR(result.pressure.value(), 4.0998, 0.03);
  EXPECT_TRUE(result.swap->is_equilibrated);
  EXPECT_EQ(*result.swap->relaxation_times,
            4000.0 / std::max(*result.swap->overlap_relaxation_time, *result.swap->bond_relaxation_time));
  EXPECT_FALSE(result.swap->displacement_acceptance.has_value()) << "chains are never refused";
  EXPECT_NO_THROW(validate(state));
}

/// Returns the first problem of a protocol with this stage: "protocol[0].stage: …".
std::string refusal(StageSettings const& stage, State const& state) {
  try {
    Protocol const protocol({.stages = {stage}}, state);
  } catch (Error const& error) {
    return error.problems().front().key + ": " + error.problems().front().what;
  }
  return "";
}

TEST(ChainsOfAStage, AreRefusedWithItsNameAndItsSettings) {
  StageSettings const straight{.kind = "event_chain", .sweeps = 2};
  StageSettings newtonian = straight;
  newtonian.chains = ChainKind::newtonian;
  EXPECT_EQ(refusal(newtonian, moving_disks(64, 0.5)), "");
  EXPECT_EQ(refusal({.kind = "event_chain"}, moving_disks(64, 0.5)),
            "protocol[0]: a stage \"event_chain\" does not say when it ends");
  EXPECT_EQ(refusal(straight, moving_disks(64, 0.5, Box(1.0, 1.0, Edge::wall))),
            "box.edge: a stage \"event_chain\" in a box that is walled");
  EXPECT_EQ(refusal(straight, moving_disks(4, 0.5)),
            "protocol[0].stage: stage 1 of the protocol, \"event_chain\", cannot begin: the box of 1 × 1 is too small "
            "for event chains: these disks need sides of at least 1.59577");
  State resting = make_start(Box(1.0, 1.0, Edge::periodic), {.count = 64, .packing_fraction = 0.5}, 4);
  EXPECT_EQ(refusal(straight, resting), "") << "straight chains need no velocities";
  EXPECT_EQ(refusal(newtonian, resting),
            "protocol[0].chains: stage 1 of the protocol, \"event_chain\", cannot begin: Newtonian chains need "
            "velocities, and all disks are at rest");
  Protocol protocol({.stages = {straight}}, resting);
  ASSERT_TRUE(protocol.advance(resting));
  EXPECT_EQ(protocol.results()[0].pressure, std::nullopt) << "disks at rest have none";
}

}  // namespace
}  // namespace gridlock
