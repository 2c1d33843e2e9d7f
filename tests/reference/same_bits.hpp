#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "gridlock/engine/engine.hpp"
#include "io/checkpoint.hpp"
#include "reference/shuffled_rows.hpp"

namespace gridlock::reference {

inline void expect_same(Counters const& a, Counters const& b) {
  EXPECT_EQ(a.pair_collisions, b.pair_collisions);
  EXPECT_EQ(a.inner_wall_hits, b.inner_wall_hits);
  EXPECT_EQ(a.pair_virial, b.pair_virial);
  EXPECT_EQ(a.inner_wall_impulse, b.inner_wall_impulse);
  EXPECT_EQ(a.swum, b.swum);
}

/// Runs `state` for so many steps, and again in pieces that end at steps, between steps and at collisions.
inline Counters expect_same_bits_however_cut(State& state, EngineSettings const& settings, std::uint64_t steps) {
  State cut = state;
  double const step = make_engine(settings, state)->time_step();
  Counters counters;
  make_engine(settings, state)->advance(state, counters, {.step = steps});

  Counters counters_of_cut;
  auto const engine = make_engine(settings, cut);
  for (std::uint64_t n = 1; 3 * n < steps - 6; ++n) {
    engine->advance(cut, counters_of_cut, {.step = 3 * n});
    engine->advance(cut, counters_of_cut, {.step = steps, .time = cut.clock.time + 0.3 * step});
    if (counters.pair_collisions == 0) continue;
    engine->advance(cut, counters_of_cut, {.step = steps, .pair_collisions = counters_of_cut.pair_collisions + 1});
  }
  engine->advance(cut, counters_of_cut, {.step = steps});
  EXPECT_EQ(hash(state), hash(cut));
  expect_same(counters, counters_of_cut);
  return counters;
}

/// Runs `state`, and again from a checkpoint that an engine wrote at a step and another one read.
inline void expect_same_bits_from_a_checkpoint(State state, EngineSettings const& settings, std::uint64_t at_step,
                                               std::uint64_t steps) {
  auto const engine = make_engine(settings, state);
  Counters counters;
  engine->advance(state, counters, {.step = at_step});
  std::string const saved = to_checkpoint([&](Archive& archive) { engine->serialize(archive, state); });
  State resumed = state;
  auto const other = make_engine(settings, resumed);
  from_checkpoint(saved, "saved", [&](Archive& archive) { other->serialize(archive, resumed); });
  Counters resumed_counters = counters;
  engine->advance(state, counters, {.step = steps});
  other->advance(resumed, resumed_counters, {.step = steps});
  EXPECT_EQ(hash(state), hash(resumed));
  expect_same(counters, resumed_counters);
  auto const numbers = [](std::vector<Count> const& counts) {
    std::vector<std::uint64_t> values;
    for (Count const& count : counts) values.push_back(count.value);
    return values;
  };
  EXPECT_EQ(numbers(engine->counts(state, counters)), numbers(other->counts(resumed, resumed_counters)));
}

/// Runs `state`, and again with its rows in another order.
inline void expect_same_bits_of_shuffled_rows(State state, EngineSettings const& settings, std::uint64_t steps) {
  State shuffled = with_rows_shuffled(state, 4);
  Counters counters;
  make_engine(settings, state)->advance(state, counters, {.step = steps});
  make_engine(settings, shuffled)->advance(shuffled, counters, {.step = steps});
  EXPECT_EQ(hash(state), hash(shuffled));
}

}  // namespace gridlock::reference
