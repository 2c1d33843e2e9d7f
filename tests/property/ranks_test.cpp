// The engine `tiled` on several ranks, here threads: the bits, sums and messages of one process, however the box is
// cut.

#include <gtest/gtest.h>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/engine/engine.hpp"
#include "reference/tiled_system.hpp"
#include "state_on_ranks.hpp"

namespace gridlock {
namespace {

using reference::any_tiled_system;
using reference::Ended;
using reference::expect_same;
using reference::TiledSystem;
using test::ThreadRanks;

Ended advance_on_ranks(EngineSettings settings, std::size_t ranks, std::uint64_t threads, State& state,
                       std::uint64_t step) {
  settings.threads = threads;
  Ended ended;
  ThreadRanks all(ranks);
  try {
    test::advance_on_ranks(settings, all, state, ended.counters, {.step = step});
  } catch (std::exception const& error) {
    ended.failure = error.what();
  }
  ended.hash = hash(state);
  return ended;
}

TEST(TiledOnRanks, HasTheBitsOfOneProcess) {
  reference::expect_same_of_any_system({2, 3, 4, 9}, "ranks",
                                       [](TiledSystem const& s, std::size_t ranks, State& state, std::uint64_t step) {
                                         return advance_on_ranks(s.engine, ranks, 1 + s.scene.seed % 2, state, step);
                                       });
}

TEST(TiledOnRanks, HasTheBitsOfOneProcessInRunsOfManySteps) {
  // The disks are put into the order of their turns anew meanwhile, and move from rank to rank.
  for (std::uint64_t const seed : {1U, 4U, 9U, 12U}) {
    TiledSystem const s = any_tiled_system(seed);
    State one_state = s.start();
    State state = one_state;
    Ended const one = reference::advance(s.engine, 1, one_state, 350);
    ASSERT_NO_FATAL_FAILURE(
        expect_same(one, advance_on_ranks(s.engine, 3, 1, state, 350), "seed " + std::to_string(seed)));
  }
}

TEST(TiledOnRanks, HasTheBitsOfOneProcessOnMoreRanksThanTiles) {
  for (std::uint64_t seed = 100; seed < 108; ++seed) {
    TiledSystem s = any_tiled_system(seed);
    s.scene.count = 1 + seed % 20;
    State one_state = s.start();
    State state = one_state;
    Ended const one = reference::advance(s.engine, 1, one_state, 60);
    ASSERT_NO_FATAL_FAILURE(
        expect_same(one, advance_on_ranks(s.engine, 16, 1, state, 60), "seed " + std::to_string(seed)));
  }
}

/// Advances an engine to each step in turn, in a new call on as many ranks.
Ended advance_in_parts(EngineSettings settings, std::vector<std::size_t> const& ranks_of_parts, State& state,
                       std::uint64_t step) {
  Ended ended;
  for (std::size_t part = 0; part < ranks_of_parts.size(); ++part) {
    ThreadRanks ranks(ranks_of_parts[part]);
    settings.threads = 1;
    test::advance_on_ranks(settings, ranks, state, ended.counters, {.step = step * (part + 1) / ranks_of_parts.size()});
  }
  ended.hash = hash(state);
  return ended;
}

TEST(TiledOnRanks, ContinuesOnAnotherNumberOfRanks) {
  for (std::uint64_t const seed : {2U, 3U, 5U}) {
    TiledSystem s = any_tiled_system(seed);
    s.fastest = 1.0;
    s.engine.time_step = 0.05;
    State one_state = s.start();
    State state = one_state;
    Ended const one = reference::advance(s.engine, 1, one_state, 50);
    ASSERT_EQ(one.failure, "");
    Ended const many = advance_in_parts(s.engine, {3, 1, 5, 2}, state, 50);
    ASSERT_EQ(one.hash, many.hash);
    ASSERT_EQ(one.counters.pair_collisions, many.counters.pair_collisions);
  }
}

TEST(TiledOnRanks, StopsAtTheStepThatHasEnoughCollisions) {
  TiledSystem s = any_tiled_system(6);
  s.scene.count = 800;
  s.scene.packing_fraction = 0.5;
  s.fastest = 1.0;
  s.engine.time_step = 0.1;
  State one_state = s.start();
  State state = one_state;
  s.engine.threads = 1;
  StopCondition const enough{.pair_collisions = 500};
  Counters one;
  make_engine(s.engine, one_state)->advance(one_state, one, enough);
  Counters many;
  ThreadRanks ranks(3);
  test::advance_on_ranks(s.engine, ranks, state, many, enough);
  EXPECT_GE(one.pair_collisions, 500U);
  EXPECT_EQ(one_state.clock, state.clock);
  EXPECT_EQ(hash(one_state), hash(state));
  EXPECT_EQ(one.pair_collisions, many.pair_collisions);
}

TEST(TiledOnRanks, EndsWhereItIsAskedToOrTheQuestionFails) {
  TiledSystem s = any_tiled_system(7);
  s.engine.threads = 1;
  State const start = s.start();
  for (bool const throws : {false, true}) {
    State state = start;
    Counters counters;
    int asked = 0;
    auto const should_continue = [&] {
      if (++asked == 3 && throws) throw std::runtime_error("no more paper");
      return asked < 3;
    };
    ThreadRanks ranks(3);
    auto const advance = [&] {
      test::advance_on_ranks(s.engine, ranks, state, counters, {.step = 1'000'000, .should_continue = should_continue});
    };
    if (throws) {
      EXPECT_THROW(advance(), std::runtime_error);
    } else {
      advance();
    }
    // What was done until then is whole.
    State one_state = start;
    EXPECT_EQ(reference::advance({.kind = "tiled",
                                  .time_step = s.engine.time_step,
                                  .substeps = s.engine.substeps,
                                  .contact = s.engine.contact},
                                 1, one_state, state.clock.step)
                  .hash,
              hash(state));
  }
}

TEST(TiledOnRanks, SendsNoMessageThatGrowsWithTheBoxBehindItsRim) {
  // Messages of a step: to each neighbour four, and one gathering; whatever the number of disks.
  auto const messages_of = [](std::size_t disks, std::uint64_t steps) {
    TiledSystem s = any_tiled_system(0);
    s.scene = {.edge = Edge::wall, .width = 2.0, .height = 2.0, .count = disks, .packing_fraction = 0.4, .seed = 3};
    s.fastest = 1.0;
    s.engine = {.kind = "tiled", .time_step = 0.05, .threads = 1};
    State state = s.start();
    ThreadRanks ranks(2);
    Counters counters;
    test::advance_on_ranks(s.engine, ranks, state, counters, {.step = steps});
    return ranks.messages();
  };
  for (std::size_t const disks : {2000U, 8000U}) {
    double const of_step = static_cast<double>(messages_of(disks, 60) - messages_of(disks, 20)) / 40.0;
    EXPECT_GE(of_step, 8.0) << "four rounds of two ranks";
    EXPECT_LE(of_step, 8.0 + 2.0 + 2.0) << "and one gathering, and now and then the sums";
  }
}

}  // namespace
}  // namespace gridlock
