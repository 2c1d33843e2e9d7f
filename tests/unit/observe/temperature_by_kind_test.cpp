#include "observe/temperature_by_kind.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/temperature.hpp"
#include "unit/observe/hand_built.hpp"

namespace gridlock {
namespace {

using namespace hand_built;

/// The temperatures of one state, by the names of their columns.
struct Temperatures {
  explicit Temperatures(State const& state) {
    observable.begin({state, {}});
    row = sample(observable, state);
  }
  [[nodiscard]] double of(std::string const& name) const { return cell(observable, row, name); }
  [[nodiscard]] double operator()(char axis, int kind = 0) const {
    std::string const name = std::string("temperature_") + axis;
    return of(kind == 0 ? name : name + "_kind_" + std::to_string(kind));
  }
  TemperatureByKind observable;
  std::vector<double> row;
};

/// Three kinds, the first added last.
State three_kinds(Edge edge) {
  State state = empty_state(Box(3.0, 2.0, edge));
  add_disk(state, {0.5, 0.5}, {1.0, 2.0}, 0.2, 3.0);
  add_disk(state, {1.0, 0.5}, {-3.0, 0.0}, 0.1, 2.0);
  add_disk(state, {1.5, 0.5}, {0.0, -1.0}, 0.1, 2.0);
  add_disk(state, {2.0, 0.5}, {2.0, 1.0}, 0.1, 1.0);
  return state;
}

TEST(TemperatureByKind, BetweenWallsIsTheMeanOfMassTimesSquaredVelocityOfEachKind) {
  Temperatures const kt(three_kinds(Edge::wall));
  EXPECT_DOUBLE_EQ(kt('x'), (3.0 + 18.0 + 0.0 + 4.0) / 4.0);
  EXPECT_DOUBLE_EQ(kt('y'), (12.0 + 0.0 + 2.0 + 1.0) / 4.0);
  EXPECT_DOUBLE_EQ(kt('x', 1), 4.0) << "radius 0.1, mass 1";
  EXPECT_DOUBLE_EQ(kt('y', 1), 1.0);
  EXPECT_DOUBLE_EQ(kt('x', 2), 9.0) << "radius 0.1, mass 2";
  EXPECT_DOUBLE_EQ(kt('y', 2), 1.0);
  EXPECT_DOUBLE_EQ(kt('x', 3), 3.0) << "radius 0.2";
  EXPECT_DOUBLE_EQ(kt('y', 3), 12.0);
}

TEST(TemperatureByKind, InAChannelIsThatOfAPeriodicBoxAlongItAndThatOfWallsAcross) {
  State state = three_kinds(Edge::wall);
  Temperatures const walls(state);
  state.box = Box(3.0, 2.0, Edge::periodic);
  Temperatures const periodic(state);
  state.box = Box(3.0, 2.0, Edge::periodic, Edge::wall);
  Temperatures const channel(state);
  state.box = Box(3.0, 2.0, Edge::wall, Edge::periodic);
  Temperatures const upright(state);
  for (int const kind : {0, 1, 2, 3}) {
    EXPECT_EQ(channel('x', kind), periodic('x', kind));
    EXPECT_EQ(channel('y', kind), walls('y', kind));
    EXPECT_EQ(upright('x', kind), walls('x', kind));
    EXPECT_EQ(upright('y', kind), periodic('y', kind));
  }
}

TEST(TemperatureByKind, TheMeanOfBothDirectionsIsTheTemperature) {
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    State const state = three_kinds(edge);
    Temperatures const kt(state);
    EXPECT_NEAR(0.5 * (kt('x') + kt('y')), *temperature(state), 1e-13);
  }
}

TEST(TemperatureByKind, InAPeriodicBoxDoesNotChangeWithTheFrameOfReference) {
  State state = three_kinds(Edge::periodic);
  Temperatures const before(state);
  for (double& v : state.agents.column<VelocityX>()) v += 7.0;
  Temperatures const after(state);
  for (int const kind : {0, 1, 2, 3}) {
    EXPECT_NEAR(after('x', kind), before('x', kind), 1e-11);
    EXPECT_DOUBLE_EQ(after('y', kind), before('y', kind));
  }
}

TEST(TemperatureByKind, OfEveryKindIsThatOfTheVelocitiesOnAverageThoughTheCentreOfMassMoves) {
  // Few disks, so that a wrong number of degrees of freedom shows: 8 of mass 1 and 3 of mass 5.
  State state = empty_state(Box(3.0, 2.0, Edge::periodic));
  for (int k = 0; k < 8; ++k) add_disk(state, {0.3 * k, 0.5}, {}, 0.1, 1.0);
  for (int k = 0; k < 3; ++k) add_disk(state, {0.3 * k, 1.5}, {}, 0.1, 5.0);
  constexpr int replicas = 4000;
  double light = 0.0, heavy = 0.0, all = 0.0;
  for (std::uint64_t seed = 1; seed <= replicas; ++seed) {
    draw_maxwell(state, 2.0, seed);
    Temperatures const kt(state);
    light += kt('x', 1) / replicas;
    heavy += kt('y', 2) / replicas;
    all += kt('x') / replicas;
  }
  // kT times a χ² number over its degrees of freedom: 8 − 8/23, 3 − 15/23, 10.
  EXPECT_NEAR(light, 2.0, 4.0 * 2.0 * std::sqrt(2.0 / 7.65 / replicas));
  EXPECT_NEAR(heavy, 2.0, 4.0 * 2.0 * std::sqrt(2.0 / 2.35 / replicas));
  EXPECT_NEAR(all, 2.0, 4.0 * 2.0 * std::sqrt(2.0 / 10.0 / replicas));
}

TEST(TemperatureByKind, HasColumnsOfKindsForTwoToEightOfThem) {
  for (std::size_t const kinds : {1U, 2U, 8U, 9U}) {
    State state = empty_state(Box(3.0, 2.0, Edge::wall));
    for (std::size_t k = 0; k < kinds; ++k) {
      for (int twice = 0; twice < 2; ++twice)
        add_disk(state, {1.0, 1.0}, {1.0, 1.0}, 0.01 * static_cast<double>(k + 1));
    }
    std::size_t const told = kinds >= 2 && kinds <= 8 ? kinds : 0;
    EXPECT_EQ(Temperatures(state).row.size(), 2 + 2 * told);
  }
}

TEST(TemperatureByKind, LeavesFixedDisksOutAndMakesThemNoKind) {
  State state = three_kinds(Edge::wall);
  Temperatures const before(state);
  add_disk(state, {2.5, 1.5}, {}, 0.3, std::numeric_limits<double>::infinity());
  Temperatures const after(state);
  EXPECT_EQ(after.row, before.row);
}

TEST(TemperatureByKind, CountsEveryMobileDiskWhereFixedOnesTakeMomentum) {
  State state = three_kinds(Edge::periodic);
  add_disk(state, {2.5, 1.5}, {}, 0.3, std::numeric_limits<double>::infinity());
  Temperatures const kt(state);
  EXPECT_DOUBLE_EQ(kt('x'), 25.0 / 4.0);
  EXPECT_DOUBLE_EQ(0.5 * (kt('x') + kt('y')), *temperature(state));
}

TEST(TemperatureByKind, IsUndefinedWithoutADegreeOfFreedom) {
  State state = empty_state(Box(3.0, 2.0, Edge::periodic));
  add_disk(state, {1.0, 1.0}, {1.0, 1.0});
  EXPECT_TRUE(std::isnan(Temperatures(state)('x')));
  EXPECT_TRUE(std::isnan(Temperatures(empty_state(Box(3.0, 2.0, Edge::wall)))('y')));
}

}  // namespace
}  // namespace gridlock
