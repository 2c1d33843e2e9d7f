// The engine `tiled`: the same bits for any number of threads, an order of turns that is a function of the state alone,
// and every promise of the paper's rule.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/grid/validate.hpp"
#include "gridlock/lattice/start.hpp"
#include "reference/shuffled_rows.hpp"
#include "reference/tiled_system.hpp"

namespace gridlock {
namespace {

using reference::advance;
using reference::any_tiled_system;
using reference::Ended;
using reference::TiledSystem;
using reference::with_rows_shuffled;

TEST(Tiled, GivesTheSameBitsForOneTwoThreeAndEightThreads) {
  reference::expect_same_of_any_system({2, 3, 8}, "threads",
                                       [](TiledSystem const& s, std::size_t threads, State& state, std::uint64_t step) {
                                         return advance(s.engine, threads, state, step);
                                       });
}

TEST(Tiled, VisitsInAnOrderThatIsAFunctionOfTheStateAlone) {
  for (std::uint64_t seed = 100; seed < 140; ++seed) {
    TiledSystem const s = any_tiled_system(seed);
    State whole = s.start();
    State cut = whole;
    State shuffled = with_rows_shuffled(whole, seed);
    Ended const ended = advance(s.engine, 1, whole, 150);
    if (!ended.failure.empty()) continue;
    EXPECT_EQ(ended.hash, advance(s.engine, 2, shuffled, 150).hash) << "seed " << seed << ": " << s.scene;
    // Cut into pieces, each with an engine of its own, as a run that continues from a file has it.
    for (std::uint64_t const step : {1U, 2U, 37U, 99U, 101U, 150U}) advance(s.engine, 1, cut, step);
    EXPECT_EQ(ended.hash, hash(cut)) << "seed " << seed << ": " << s.scene;
  }
}

TEST(Tiled, KeepsTheOrderOfIdsInACellOnlyWhileItIsRight) {
  for (std::uint64_t seed = 300; seed < 340; ++seed) {
    TiledSystem s = any_tiled_system(seed);
    // A few disks change cells in a step, so that most cells have an order that was noted steps before.
    s.engine.time_step *= seed % 2 == 0 ? 0.01 : 0.1;
    State whole = s.start();
    State cut = whole;
    advance(s.engine, 1 + seed % 3, whole, 90);
    // An engine keeps nothing from one call to the next.
    for (std::uint64_t step = 1; step <= 90; ++step) advance(s.engine, 1, cut, step);
    EXPECT_EQ(hash(whole), hash(cut)) << "seed " << seed << ": " << s.scene;
  }
}

TEST(Tiled, KeepsEveryPromiseOfTheRule) {
  for (std::uint64_t seed = 200; seed < 260; ++seed) {
    TiledSystem const s = any_tiled_system(seed);
    State state = s.start();
    double const energy = kinetic_energy(state.agents);
    Ended const ended = advance(s.engine, 2, state, 80);
    EXPECT_EQ(largest_overlap(state), 0.0) << "seed " << seed << ": " << s.scene;
    EXPECT_NO_THROW(validate(state)) << "seed " << seed;
    EXPECT_NEAR(kinetic_energy(state.agents), energy, 1e-11 * energy) << "seed " << seed;
    if (!ended.failure.empty()) continue;
    EXPECT_EQ(ended.counters.moves, 80 * state.agents.size()) << "seed " << seed << ": " << s.scene;
  }
}

TEST(Tiled, TakesTheTurnsOfSteppedWhereNoneMeetsAnother) {
  // Without collisions the order does not matter: the same positions as disk after disk.
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    State tiled = make_start(Box(1.25, 0.8, edge), {.count = 400, .packing_fraction = 0.02}, 5);
    draw_velocities(tiled, {});
    State stepped = tiled;
    Counters counters;
    Counters reference;
    make_engine({.kind = "tiled"}, tiled)->advance(tiled, counters, {.step = 6});
    make_engine({.kind = "stepped"}, stepped)->advance(stepped, reference, {.step = 6});
    ASSERT_EQ(reference.pair_collisions, 0U);
    EXPECT_EQ(hash(tiled), hash(stepped));
  }
}

}  // namespace
}  // namespace gridlock
