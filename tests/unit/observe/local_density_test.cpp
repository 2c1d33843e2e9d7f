#include "observe/local_density.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include "gridlock/core/error.hpp"
#include "unit/observe/hand_built.hpp"

namespace gridlock {
namespace {

using namespace hand_built;

/// The local density of one state: its row and its table.
struct Counted {
  std::vector<double> row;
  std::vector<std::vector<double>> table;
};

Counted counted(State const& state, double side) {
  LocalDensity density(1, side);
  density.begin({state, {}});
  std::vector<double> row = sample(density, state);
  return {std::move(row), density.distributions().at(0).columns_of_values};
}

TEST(LocalDensity, CountsTheAgentsOfEachCellOfAGridThatFitsAnOblongBox) {
  // Six cells of 2 × 2.5 in a box of 6 × 5; the side of 2.2 does not fit.
  State state = empty_state(Box(6.0, 5.0, Edge::wall));
  for (Vector const p : {Vector{0.3, 0.3}, Vector{1.9, 2.4}, Vector{1.0, 1.0}, Vector{2.1, 0.3}, Vector{5.7, 4.7}}) {
    add_disk(state, p, {}, 0.25);
  }
  Counted const found = counted(state, 2.2 / 0.5);
  double const mean = 5.0 / 6.0;
  EXPECT_DOUBLE_EQ(found.row[0], mean);
  EXPECT_DOUBLE_EQ(found.row[1], ((9.0 + 1.0 + 1.0) / 6.0 - mean * mean) / mean);
  EXPECT_EQ(found.table[0], (std::vector<double>{0, 1, 2, 3}));
  std::vector<double> const shares{3.0 / 6.0, 2.0 / 6.0, 0.0, 1.0 / 6.0};
  for (std::size_t n = 0; n < shares.size(); ++n) {
    EXPECT_DOUBLE_EQ(found.table[1][n], shares[n]);
    EXPECT_NEAR(found.table[3][n], static_cast<double>(n) * std::numbers::pi * 0.0625 / 5.0, 1e-15);
  }
}

TEST(LocalDensity, OfAnIdealGasHasTheVarianceOfABinomialNumber) {
  double sum = 0.0;
  double squares = 0.0;
  constexpr int replicas = 200;
  for (std::uint64_t replica = 1; replica <= replicas; ++replica) {
    double const ratio = counted(ideal_gas(Box(8.0, 4.0, Edge::periodic), 400, 0.1, replica), 5.0).row[1];
    sum += ratio / replicas;
    squares += ratio * ratio / replicas;
  }
  double const error = std::sqrt((squares - sum * sum) / replicas);
  EXPECT_NEAR(sum, 1.0 - 1.0 / 32.0, 4.0 * error);
  EXPECT_LT(error, 0.03);
}

TEST(LocalDensity, TellsASeparatedSystemFromAUniformOne) {
  State uniform = empty_state(Box(16.0, 8.0, Edge::periodic));
  State separated = uniform;
  for (int row = 0; row < 16; ++row) {
    for (int column = 0; column < 32; ++column) {
      add_disk(uniform, {0.25 + 0.5 * column, 0.25 + 0.5 * row}, {}, 0.1);
      add_disk(separated, {0.125 + 0.25 * column, 0.25 + 0.5 * row}, {}, 0.1);
    }
  }
  EXPECT_DOUBLE_EQ(counted(uniform, 10.0).row[1], 0.0);
  Counted const two = counted(separated, 10.0);
  EXPECT_GT(two.row[1], 2.5);
  EXPECT_DOUBLE_EQ(two.table[1].front(), 0.5);
  EXPECT_DOUBLE_EQ(two.table[1].back(), 0.5);
}

TEST(LocalDensity, SharesOfCellsAddUpToOneOverManySamples) {
  LocalDensity density(1, 4.0);
  State const first = ideal_gas(Box(5.0, 3.0, Edge::wall), 50, 0.1, 1);
  density.begin({first, {}});
  for (std::uint64_t seed = 1; seed <= 30; ++seed) sample(density, ideal_gas(first.box, 50, 0.1, seed));
  auto const table = density.distributions()[0].columns_of_values;
  EXPECT_NEAR(std::accumulate(table[1].begin(), table[1].end(), 0.0), 1.0, 1e-13);
}

TEST(LocalDensity, RefusesAGridOfTooManyCells) {
  State const state = ideal_gas(Box(5.0, 3.0, Edge::wall), 50, 0.1, 1);
  try {
    LocalDensity(1, 1e-3).begin({state, {}});
    FAIL();
  } catch (Error const& error) {
    EXPECT_NE(std::string(error.what()).find("a grid of 25000 × 15000 cells"), std::string::npos) << error.what();
  }
}

TEST(LocalDensity, LeavesFixedDisksOut) {
  State state = empty_state(Box(4.0, 2.0, Edge::wall));
  add_disk(state, {1.0, 1.0}, {}, 0.1);
  add_disk(state, {3.0, 1.0}, {}, 0.7, std::numeric_limits<double>::infinity());
  EXPECT_DOUBLE_EQ(counted(state, 10.0).row[0], 0.5);
}

}  // namespace
}  // namespace gridlock
