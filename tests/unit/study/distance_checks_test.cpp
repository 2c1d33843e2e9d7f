#include "study/distance_checks.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "gridlock/core/random.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/grid/cell_layout.hpp"
#include "gridlock/lattice/start.hpp"

namespace gridlock {
namespace {

State points_at_random(std::uint64_t count, std::uint64_t seed) {
  State state;
  RandomStream random(seed, 0, 0, Purpose::start_position);
  for (std::uint64_t i = 0; i < count; ++i) {
    double const x = random.uniform();
    double const y = random.uniform();
    state.agents.add(x, y, 0.0, 0.0, 1e-6, 1.0, 0, 0);
  }
  return state;
}

TEST(MeanBlockSize, IsTheNumberOfCellsTheWallsLeaveOfThe3x3Blocks) {
  for (std::uint64_t k = 1; k <= 25; ++k) {
    CellLayout const layout(Box(), k, k);
    std::uint64_t cells = 0;
    for (int cell = 0; cell < layout.count(); ++cell) {
      layout.for_each_cell_in_block(cell, 1, 1, [&](int) { ++cells; });
    }
    EXPECT_DOUBLE_EQ(mean_block_size(k), static_cast<double>(cells) / static_cast<double>(k * k)) << k;
  }
}

TEST(PaperChecks, AreTheSameFor1000DisksOn10x10And2000On20x20) {
  EXPECT_EQ(paper_checks(1000, 10), 90'000.0);
  EXPECT_EQ(paper_checks(2000, 20), paper_checks(1000, 10));
}

TEST(UniformChecks, AreTheMeanOverRandomPoints) {
  for (std::uint64_t const k : {1, 3, 10}) {
    constexpr int samples = 400;
    constexpr std::uint64_t disks = 50;
    double sum = 0.0;
    double squares = 0.0;
    for (int sample = 0; sample < samples; ++sample) {
      auto const checks =
          static_cast<double>(checks_of_one_look(points_at_random(disks, static_cast<std::uint64_t>(sample)), k));
      sum += checks;
      squares += checks * checks;
    }
    double const mean = sum / samples;
    double const error = std::sqrt(std::max(0.0, squares / samples - mean * mean) / samples);
    EXPECT_NEAR(uniform_checks(disks, k), mean, 4.0 * error + 1e-9) << k;
  }
}

TEST(ChecksOfOneLook, AreWhatTheSteppedEngineCountsForDisksAtRest) {
  State state = make_start(Box(), {.count = 300, .packing_fraction = 0.4, .start = StartKind::random}, 5);
  for (std::uint64_t const k : {1, 2, 7, 12}) {
    State copy = state;
    Counters counters;
    make_engine({.substeps = 5, .cells = k, .grid = GridKind::linked}, copy)->advance(copy, counters, {.step = 3});
    EXPECT_EQ(counters.distance_checks, 3 * 5 * checks_of_one_look(state, k)) << k;
  }
}

}  // namespace
}  // namespace gridlock
