// Runs of the engine soft, however they are divided.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>

#include "engine/soft.hpp"
#include "gridlock/lattice/start.hpp"

namespace gridlock::test {

/// Disks in an oblong periodic box, by default half of them larger and heavier, with velocities.
inline State soft_disks(StartKind start, double packing_fraction, std::uint64_t count, std::uint64_t seed,
                        bool is_mixture = true) {
  DisksSettings disks{.count = count, .packing_fraction = packing_fraction, .start = start};
  if (is_mixture) disks.species = {{.fraction = 0.5}, {.fraction = 0.5, .size_ratio = 1.4, .mass = 1.96}};
  State state = make_start(Box(1.3, 0.9, Edge::periodic), disks, seed);
  draw_velocities(state, {.kind = VelocityKind::maxwell});
  return state;
}

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
