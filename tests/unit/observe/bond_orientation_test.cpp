#include "observe/bond_orientation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "unit/observe/hand_built.hpp"

namespace gridlock {
namespace {

using namespace hand_built;

/// The definition itself: all pairs, and angles from the arc tangent.
BondOrientationOrder from_definition(State const& state) {
  std::size_t const n = state.agents.size();
  double const density = static_cast<double>(n) / state.box.area();
  double cutoff = 1.5 * std::sqrt(2.0 / (std::sqrt(3.0) * density));
  if (state.box.is_periodic()) cutoff = std::min(cutoff, 0.5 * std::min(state.box.width(), state.box.height()));
  std::complex<double> global;
  double local = 0.0;
  for (std::size_t j = 0; j < n; ++j) {
    std::complex<double> sum;
    int neighbours = 0;
    for (std::size_t k = 0; k < n; ++k) {
      Vector const r = state.box.displacement(position(state.agents, j), position(state.agents, k));
      if (k == j || std::hypot(r.x, r.y) >= cutoff) continue;
      sum += std::polar(1.0, 6.0 * std::atan2(r.y, r.x));
      ++neighbours;
    }
    if (neighbours == 0) continue;
    global += sum / static_cast<double>(neighbours);
    local += std::abs(sum) / neighbours;
  }
  return {std::abs(global) / static_cast<double>(n), local / static_cast<double>(n)};
}

TEST(BondOrientation, OfThePerfectTriangularLatticeIsOne) {
  for (auto const& [columns, rows] : {std::pair{4, 4}, {12, 14}, {31, 36}}) {
    auto const order = bond_orientation_order(triangular_lattice(columns, rows));
    EXPECT_NEAR(order->global_order, 1.0, 1e-12) << columns;
    EXPECT_NEAR(order->local_order, 1.0, 1e-12) << columns;
  }
}

TEST(BondOrientation, OfTheSquareLatticeIsZero) {
  for (int const side : {4, 5, 29}) {
    auto const order = bond_orientation_order(square_lattice(side));
    EXPECT_NEAR(order->global_order, 0.0, 1e-12) << side;
    EXPECT_NEAR(order->local_order, 0.0, 1e-12) << side;
  }
}

TEST(BondOrientation, AgreesWithTheDefinitionForRandomPointsInBoxesOfAnyShape) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    RandomStream random(seed, 0, 0, Purpose::paper_study);
    Edge const edge = seed % 2 == 0 ? Edge::wall : Edge::periodic;
    Box const box(0.5 + random.uniform(), 0.5 + random.uniform(), edge);
    std::size_t const count = 1 + random.below(seed < 30 ? 12 : 300);
    State const state = ideal_gas(box, count, 0.01, seed);
    auto const order = bond_orientation_order(state);
    auto const expected = from_definition(state);
    EXPECT_NEAR(order->global_order, expected.global_order, 1e-11) << "seed " << seed;
    EXPECT_NEAR(order->local_order, expected.local_order, 1e-11) << "seed " << seed;
  }
}

TEST(BondOrientation, TwoCrystalsTurnedByHalfTheSymmetryCancelGloballyButNotLocally) {
  // Turned by 30° the sixfold direction is the opposite: a hexagon around a disk, and the same turned, far apart. The
  // six corners see the centre and their two neighbours on the ring, all with the same direction modulo 60°. 14 disks
  // on 60 × 20: neighbours are nearer than 14.9, the ring is at 9.
  State state = empty_state(Box(60, 20, Edge::wall));
  for (double const turn : {0.0, std::numbers::pi / 6.0}) {
    Vector const centre{turn > 0.0 ? 50.0 : 10.0, 10.0};
    add_disk(state, centre);
    for (int corner = 0; corner < 6; ++corner) {
      double const angle = turn + corner * std::numbers::pi / 3.0;
      add_disk(state, centre + Vector{9.0 * std::cos(angle), 9.0 * std::sin(angle)});
    }
  }
  auto const order = bond_orientation_order(state);
  EXPECT_NEAR(order->global_order, 0.0, 1e-12);
  EXPECT_NEAR(order->local_order, 1.0, 1e-12);
}

TEST(BondOrientation, IsAbsentForNoDisksAndZeroForALonelyOne) {
  EXPECT_FALSE(bond_orientation_order(empty_state(Box(1, 1, Edge::periodic))));
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    State one = empty_state(Box(1, 1, edge));
    add_disk(one, {0.5, 0.5});
    EXPECT_EQ(bond_orientation_order(one)->global_order, 0.0);
    EXPECT_EQ(bond_orientation_order(one)->local_order, 0.0);
  }
}

TEST(BondOrientation, LeavesTheCellsOfSamplesItSkipsEmpty) {
  State const state = triangular_lattice(6, 6);
  BondOrientation observable(3);
  observable.begin({state, {}});
  std::string measured;
  for (int n = 0; n < 7; ++n) measured += std::isnan(sample(observable, state)[0]) ? '.' : 'X';
  EXPECT_EQ(measured, "X..X..X");
  EXPECT_NEAR(result(observable, "global_bond_orientation_order")->value, 1.0, 1e-12);
  EXPECT_NEAR(result(observable, "local_bond_orientation_order")->value, 1.0, 1e-12);
}

}  // namespace
}  // namespace gridlock
