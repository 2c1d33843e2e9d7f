// Runs of the engine soft, however they are divided.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>

#include "engine/soft.hpp"

namespace gridlock::test {

inline std::uint64_t hash_after(EngineSettings const& settings, State state, std::uint64_t steps, std::uint64_t chunk,
                                double skin = 0.0) {
  SoftEngine engine(settings, state);
  engine.set_skin(skin);
  Counters counters;
  for (std::uint64_t step = chunk; step < steps + chunk; step += chunk) {
    engine.advance(state, counters, {.step = std::min(step, steps)});
  }
  EXPECT_EQ(counters.moves, steps * state.agents.size());
  return hash(state);
}

inline void expect_same_bits_for_any_threads_chunks_and_skin(EngineSettings settings, State const& start,
                                                             std::uint64_t steps) {
  std::uint64_t const expected = hash_after(settings, start, steps, steps);
  EXPECT_NE(expected, hash(start));
  EXPECT_EQ(hash_after(settings, start, steps, 1), expected);
  EXPECT_EQ(hash_after(settings, start, steps, 7, 0.05), expected);
  EXPECT_EQ(hash_after(settings, start, steps, 13, 0.5), expected);
  for (std::uint64_t const threads : {2, 3, 8}) {
    settings.threads = threads;
    EXPECT_EQ(hash_after(settings, start, steps, steps), expected) << threads;
  }
}

}  // namespace gridlock::test
