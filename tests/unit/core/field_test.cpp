#include "gridlock/core/field.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/core/spread.hpp"
#include "gridlock/core/world.hpp"

namespace gridlock {
namespace {

Field with_random_values(std::size_t columns, std::size_t rows) {
  Field field("heat", columns, rows);
  RandomStream random(5, 0, 0, Purpose::model_step);
  for (double& value : field.values()) value = random.uniform();
  return field;
}

double sum_of(Field const& field) { return std::accumulate(field.values().begin(), field.values().end(), 0.0); }

Field spread_once(Field field, Box const& box, Spreading const& amounts, std::uint64_t threads = 1,
                  Target instructions = target()) {
  ThreadPool pool(threads);
  spread(field, box, amounts, pool, instructions);
  return field;
}

std::vector<double> values_of(Field const& field) { return {field.values().begin(), field.values().end()}; }

TEST(Field, TellsTheCellAroundAPoint) {
  Box const box(2.0, 1.0, Edge::wall);
  Field const field("grass", 4, 2);
  EXPECT_EQ(field.cell_of(box, {0.0, 0.0}), 0);
  EXPECT_EQ(field.cell_of(box, {0.5, 0.0}), 1);
  EXPECT_EQ(field.cell_of(box, {1.99, 0.49}), 3);
  EXPECT_EQ(field.cell_of(box, {2.0, 1.0}), 7) << "the walls belong to the box";
}

TEST(Field, RefusesAGridWithoutCellsOrBeyondMemory) {
  EXPECT_THROW(Field("grass", 0, 3), Error);
  EXPECT_THROW(Field("grass", 3, 0), Error);
  EXPECT_THROW(Field("grass", std::size_t{1} << 40, std::size_t{1} << 40), Error);
}

TEST(Field, ChangesTheHashOfItsWorldWithEachValue) {
  Field field("grass", 3, 2, 1.0);
  std::uint64_t const full = hash_with_fields(7, {&field, 1});
  field.values()[4] = 0.5;
  EXPECT_NE(hash_with_fields(7, {&field, 1}), full);
  EXPECT_EQ(hash_with_fields(7, {}), 7);
}

TEST(Spread, MultipliesWavesByTheExactFactorsBetweenWallsAndInAPeriodicBox) {
  constexpr std::size_t columns = 24;
  constexpr std::size_t rows = 17;
  constexpr double decay_rate = 0.3;
  for (double const lambda : {1e-6, 0.2, 3.0, 60.0, 400.0}) {
    // Cells of width 1 along x and of height 0.5 along y.
    Box const box(columns, 0.5 * rows, Edge::periodic, Edge::wall);
    Field wave("wave", columns, rows);
    double const along = 2.0 * std::numbers::pi * 2.0 / columns;
    double const upwards = std::numbers::pi * 3.0 / rows;
    for (std::size_t r = 0; r < rows; ++r) {
      for (std::size_t c = 0; c < columns; ++c) {
        wave.values()[r * columns + c] =
            std::cos(along * static_cast<double>(c)) * std::cos(upwards * (static_cast<double>(r) + 0.5));
      }
    }
    double const factor =
        std::exp(-2.0 * lambda * (1.0 - std::cos(along)) - 2.0 * 4.0 * lambda * (1.0 - std::cos(upwards)) - decay_rate);
    Field const later = spread_once(wave, box, {.diffusion = lambda, .decay = decay_rate});
    for (std::size_t k = 0; k < wave.size(); ++k) {
      EXPECT_NEAR(later.values()[k], factor * wave.values()[k], 2e-15) << "λ = " << lambda << ", cell " << k;
    }
  }
}

TEST(Spread, WidensAPeakAsAGaussianWhoseVarianceGrowsBy2Dt) {
  constexpr std::size_t side = 201;
  Box const box(side, side, Edge::wall);
  Field peak("peak", side, side);
  peak.values()[100 * side + 100] = 1.0;
  constexpr double time = 8.0;
  Field const later = spread_once(peak, box, {.diffusion = time});
  double variance = 0.0;
  for (std::size_t k = 0; k < later.size(); ++k) {
    double const x = static_cast<double>(k % side) - 100.0;
    variance += later.values()[k] * x * x;
  }
  EXPECT_NEAR(variance, 2.0 * time, 1e-12);
  double const density = 1.0 / (4.0 * std::numbers::pi * time);
  EXPECT_NEAR(later.values()[100 * side + 100], density, 0.02 * density) << "a grid is no continuum";
}

TEST(Spread, KeepsTheSumAndTheBounds) {
  Field const field = with_random_values(37, 23);
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    for (double const diffusion : {1e-9, 1e-3, 1.0, 1e6, 1e300}) {
      Field const later = spread_once(field, Box(1.0, 1.0, edge), {.diffusion = diffusion});
      EXPECT_NEAR(sum_of(later), sum_of(field), 1e-12 * sum_of(field)) << "D t = " << diffusion;
      for (double const value : later.values()) {
        EXPECT_GE(value, 0.0);
        EXPECT_LE(value, 1.0);
      }
    }
  }
}

TEST(Spread, MakesAFieldUniformInTheEnd) {
  Field const field = with_random_values(9, 14);
  Field const later = spread_once(field, Box(1.0, 1.0, Edge::wall), {.diffusion = 1e9, .decay = 1.0});
  double const mean = sum_of(field) / static_cast<double>(field.size());
  for (double const value : later.values()) EXPECT_NEAR(value, mean * std::exp(-1.0), 1e-14);
}

TEST(Spread, InTwoStepsIsThatInOne) {
  Field const field = with_random_values(31, 30);
  Box const box(2.0, 2.0, Edge::periodic);
  Field const half = spread_once(field, box, {.diffusion = 0.01, .decay = 0.25});
  std::vector<double> const twice = values_of(spread_once(half, box, {.diffusion = 0.01, .decay = 0.25}));
  std::vector<double> const once = values_of(spread_once(field, box, {.diffusion = 0.02, .decay = 0.5}));
  for (std::size_t k = 0; k < once.size(); ++k) EXPECT_NEAR(twice[k], once[k], 1e-15);
}

TEST(Spread, GivesTheSameBitsOnAnyThreadsAndInstructions) {
  Field const field = with_random_values(71, 67);
  Box const box(1.0, 1.5, Edge::wall, Edge::periodic);
  Spreading const amounts{.diffusion = 3e-4, .decay = 0.1};
  std::vector<double> const expected = values_of(spread_once(field, box, amounts, 1, Target::scalar));
  for (Target const instructions : available_targets()) {
    for (std::uint64_t const threads : {1, 2, 3, 8}) {
      EXPECT_EQ(values_of(spread_once(field, box, amounts, threads, instructions)), expected)
          << to_text(instructions) << ", " << threads << " threads";
    }
  }
}

TEST(Spread, RefusesAmountsBelow0AndNoNumbers) {
  Field const field("heat", 3, 3);
  Box const box(1.0, 1.0, Edge::wall);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (double const amount : {-1e-9, infinity, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(spread_once(field, box, {.diffusion = amount}), Error);
    EXPECT_THROW(spread_once(field, box, {.decay = amount}), Error);
  }
}

}  // namespace
}  // namespace gridlock
