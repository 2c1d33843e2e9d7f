// Grains in the exact engine: collisions that lose energy, gravity, fixed disks and walls inside the box.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "engine/exact/dynamics.hpp"
#include "engine/exact/touch.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/engine/engine.hpp"
#include "reference/random_scene.hpp"
#include "reference/same_bits.hpp"

namespace gridlock {
namespace {

using reference::expect_same_bits_from_a_checkpoint;
using reference::expect_same_bits_however_cut;
using reference::expect_same_bits_of_shuffled_rows;
using reference::random_scene;
using reference::SceneSettings;

constexpr double fixed_mass = std::numeric_limits<double>::infinity();

struct GrainsCase {
  std::string name;
  Edge edge = Edge::wall;
  double restitution = 1.0;
  double contact_time = 0.0;
  Vector gravity = {};
  std::uint64_t fixed = 0;  ///< every so many disks one is fixed
  bool has_walls = false;
  double interval = 0.0;  ///< of a Brownian thermostat
  double smallest_ratio = 1.0;
  std::vector<double> by_kind = {};  ///< restitution of kinds: two that move and one that is fixed

  friend std::ostream& operator<<(std::ostream& out, GrainsCase const& c) { return out << c.name; }
};

std::vector<GrainsCase> grains_cases() {
  return {{.name = "inelastic", .edge = Edge::periodic, .restitution = 0.8},
          {.name = "inelastic_walls_mixture", .restitution = 0.7, .smallest_ratio = 0.3},
          {.name = "contact_time", .restitution = 0.5, .contact_time = 1e-3},
          {.name = "falling", .gravity = {0.3, -1.0}},
          {.name = "falling_mixture", .gravity = {0.0, 2.0}, .smallest_ratio = 0.3},
          {.name = "fixed", .edge = Edge::periodic, .fixed = 5},
          {.name = "fixed_between_walls", .fixed = 3, .smallest_ratio = 0.4},
          {.name = "walls", .has_walls = true},
          {.name = "walls_in_periodic_box", .edge = Edge::periodic, .has_walls = true, .smallest_ratio = 0.5},
          {.name = "falling_on_fixed", .gravity = {0.1, -2.0}, .fixed = 4},
          {.name = "falling_on_walls", .gravity = {0.0, -2.0}, .has_walls = true, .smallest_ratio = 0.5},
          {.name = "by_kind", .edge = Edge::periodic, .fixed = 5, .by_kind = {0.9, 0.8, 0.5, 0.7, 1.0, 1.0}},
          {.name = "everything",
           .restitution = 0.8,
           .contact_time = 1e-3,
           .gravity = {0.0, -3.0},
           .fixed = 5,
           .has_walls = true,
           .interval = 0.4,
           .smallest_ratio = 0.5}};
}

class Grains : public testing::TestWithParam<GrainsCase> {
 protected:
  static std::vector<WallSettings> walls() {
    if (!GetParam().has_walls) return {};
    return {{.from = {0.1, 0.3}, .to = {0.5, 0.5}}, {.from = {0.9, 0.0}, .to = {0.9, 0.55}}};
  }
  static EngineSettings settings() {
    GrainsCase const& c = GetParam();
    EngineSettings settings{
        .kind = "exact",
        .audit_every = 7,
        .collisions = {.restitution = c.restitution, .contact_time = c.contact_time, .restitution_by_kind = c.by_kind},
        .gravity = {.x = c.gravity.x, .y = c.gravity.y},
        .walls = walls()};
    if (c.interval > 0.0) {
      settings.thermostat = {.kind = ThermostatKind::brownian, .temperature = 0.3, .interval = c.interval};
    }
    return settings;
  }
  /// Disks of a random scene without those that overlap a wall.
  static State start(std::uint64_t seed) {
    GrainsCase const& c = GetParam();
    State state = random_scene({.edge = c.edge,
                                .count = 40,
                                .packing_fraction = 0.3,
                                .smallest_ratio = c.smallest_ratio,
                                .heaviest_mass = c.smallest_ratio < 1.0 ? 4.0 : 1.0,
                                .seed = seed});
    Disks& disks = state.agents;
    for (std::size_t i = 0; i < disks.size() && !c.by_kind.empty(); ++i) {
      disks.column<Mass>()[i] = disks.ids()[i] % 2 == 0 ? 1.0 : 2.0;
    }
    std::vector<Id> const ids(disks.ids().begin(), disks.ids().end());
    for (Id const id : ids) {
      std::size_t const i = disks.index_of(id);
      bool const overlaps = std::ranges::any_of(obstacles_of(walls()), [&](Obstacle const& wall) {
        Vector const p = position(disks, i);
        return squared_length(p - wall.nearest_to(p)) <= disks.column<Radius>()[i] * disks.column<Radius>()[i];
      });
      if (overlaps) {
        disks.remove(id);
      } else if (c.fixed > 0 && id % c.fixed == 0) {
        disks.column<Mass>()[i] = fixed_mass;
        disks.column<VelocityX>()[i] = 0.0;
        disks.column<VelocityY>()[i] = 0.0;
      }
    }
    return state;
  }
};

INSTANTIATE_TEST_SUITE_P(Cases, Grains, testing::ValuesIn(grains_cases()), [](auto const& c) { return c.param.name; });

TEST_P(Grains, HaveTheSameBitsHoweverTheRunIsCut) {
  for (std::uint64_t const seed : {1U, 2U}) {
    State state = start(seed);
    Counters const counters = expect_same_bits_however_cut(state, settings(), 90);
    EXPECT_GT(counters.pair_collisions, 20U);
    EXPECT_EQ(counters.inner_wall_hits > 0, GetParam().has_walls);
  }
}

TEST_P(Grains, GoOnFromACheckpointWithTheSameBits) { expect_same_bits_from_a_checkpoint(start(5), settings(), 21, 70); }

TEST_P(Grains, DependOnIdsAndNotOnRows) { expect_same_bits_of_shuffled_rows(start(6), settings(), 60); }

TEST_P(Grains, HaveTheSameBitsWithAnyCellsAndWithLists) {
  GrainsCase const& c = GetParam();
  State const begin = start(7);
  std::vector<Obstacle> const obstacles = obstacles_of(walls());
  constexpr std::uint64_t never_that_many = 1'000'000;
  auto const end = [&](exact::Lists lists, double size_of_cells) {
    exact::Dynamics dynamics(begin, {.size_of_cells = size_of_cells,
                                     .lists = lists,
                                     .gravity = c.gravity,
                                     .losses = exact::losses_for(settings().collisions, begin.agents),
                                     .walls = obstacles});
    Counters counters;
    dynamics.run(4.0, never_that_many, 50, counters);
    State state = begin;
    dynamics.write(4.0, state);
    EXPECT_GT(counters.pair_collisions, 100U);
    return std::pair(hash(state), counters.pair_virial);
  };
  auto const expected = end(exact::Lists::not_at_all, 1.0);
  EXPECT_EQ(end(exact::Lists::always, 1.0), expected);
  for (double const size_of_cells : {1.3, 2.0, 100.0}) {
    EXPECT_EQ(end(exact::Lists::not_at_all, size_of_cells), expected) << size_of_cells;
    EXPECT_EQ(end(exact::Lists::always, size_of_cells), expected) << size_of_cells;
  }
}

/// ½ Σ m v² − Σ m g·r of the disks that move.
double energy(State const& state, Vector gravity) {
  double sum = kinetic_energy(state.agents);
  for (std::size_t i = 0; i < state.agents.size(); ++i) {
    if (!is_fixed(state.agents, i)) sum -= state.agents.column<Mass>()[i] * dot(gravity, position(state.agents, i));
  }
  return sum;
}

TEST_P(Grains, KeepTheirEnergyUnlessCollisionsLoseIt) {
  State state = start(8);
  Vector const g = GetParam().gravity;
  double const before = energy(state, g);
  Counters counters;
  EngineSettings without_bath = settings();
  without_bath.thermostat = {};
  make_engine(without_bath, state)->advance(state, counters, {.time = 6.0});
  double const change = energy(state, g) / before - 1.0;
  if (GetParam().restitution == 1.0 && GetParam().by_kind.empty()) {
    EXPECT_NEAR(change, 0.0, 1e-11);
  } else {
    EXPECT_LT(change, -0.1);
  }
}

TEST_P(Grains, FlyBackWhereTheyCameFromIfTheyLoseNoEnergy) {
  if (settings().collisions.lose_energy() || GetParam().interval > 0.0) return;
  State state = start(9);
  State const begin = state;
  Counters counters;
  make_engine(settings(), state)->advance(state, counters, {.time = 0.4});
  EXPECT_GT(counters.pair_collisions, 10U);
  double const middle = state.clock.time;
  for (std::size_t i = 0; i < state.agents.size(); ++i) {
    state.agents.column<VelocityX>()[i] *= -1.0;
    state.agents.column<VelocityY>()[i] *= -1.0;
  }
  make_engine(settings(), state)->advance(state, counters, {.time = 2.0 * middle});
  for (std::size_t i = 0; i < state.agents.size(); ++i) {
    Vector const d = state.box.displacement(position(state.agents, i), position(begin.agents, i));
    EXPECT_NEAR(d.x, 0.0, 1e-8) << i;
    EXPECT_NEAR(d.y, 0.0, 1e-8) << i;
  }
}

TEST(GrainsOfKinds, LoseByTheKindsThatCollide) {
  // Disks 0 and 1 are of kind A, disk 2 is heavier and of kind B: e is 0.5 of AA, 0.8 of AB, and 0.25 of B and walls.
  State state{.box = Box(20.0, 3.0, Edge::wall)};
  state.agents.add(2.0, 1.5, 1.0, 0.0, 0.5, 1.0, 0, 0);
  state.agents.add(4.0, 1.5, -1.0, 0.0, 0.5, 1.0, 0, 0);
  state.agents.add(18.0, 1.5, 2.0, 0.0, 0.5, 3.0, 0, 0);
  EngineSettings const settings{
      .kind = "exact", .collisions = {.restitution_by_kind = {0.5, 0.8, 1.0}, .wall_restitution_by_kind = {1.0, 0.25}}};
  Counters counters;
  make_engine(settings, state)->advance(state, counters, {.time = 2.0});
  EXPECT_NEAR(state.agents.column<VelocityX>()[0], -0.5, 1e-14);
  EXPECT_NEAR(state.agents.column<VelocityX>()[1], 0.5, 1e-14);
  EXPECT_NEAR(state.agents.column<VelocityX>()[2], -0.5, 1e-14);
  make_engine(settings, state)->advance(state, counters, {.pair_collisions = counters.pair_collisions + 1});
  // Masses 1 and 3, relative velocity 1 before and −0.8 after, momentum 0.5 − 1.5.
  EXPECT_NEAR(state.agents.column<VelocityX>()[1], -0.25 - 0.8 * 0.75, 1e-14);
  EXPECT_NEAR(state.agents.column<VelocityX>()[2], -0.25 + 0.8 * 0.25, 1e-14);
}

TEST(GrainsOfMany, HaveTheBitsOfOneThreadOnAnyNumber) {
  State const begin = random_scene({.edge = Edge::periodic, .count = 6000, .packing_fraction = 0.5, .seed = 4});
  for (bool const has_obstacles : {false, true}) {
    std::vector<std::uint64_t> hashes;
    for (std::uint64_t const threads : {1U, 2U, 3U}) {
      State state = begin;
      EngineSettings settings{.kind = "exact", .threads = threads, .collisions = {.restitution = 0.95}};
      for (std::size_t i = 0; has_obstacles && i < state.agents.size(); i += 10) {
        state.agents.column<Mass>()[i] = fixed_mass;
        state.agents.column<VelocityX>()[i] = 0.0;
        state.agents.column<VelocityY>()[i] = 0.0;
      }
      Counters counters;
      make_engine(settings, state)->advance(state, counters, {.pair_collisions = 60000});
      hashes.push_back(hash(state));
    }
    EXPECT_EQ(hashes[1], hashes[0]) << has_obstacles;
    EXPECT_EQ(hashes[2], hashes[0]) << has_obstacles;
  }
}

/// The first of many points of a path from which on the disk overlaps the obstacle; infinity where there is none.
double first_overlap(Obstacle const& obstacle, double radius, exact::Path const& path, double end) {
  constexpr int points = 20000;
  for (int k = 1; k <= points; ++k) {
    double const time = end * k / points;
    Vector const p = path.at(time);
    if (std::sqrt(squared_length(p - obstacle.nearest_to(p))) < radius + obstacle.radius) return time;
  }
  return std::numeric_limits<double>::infinity();
}

TEST(TimeToTouch, IsTheFirstOverlapOfAPathTakenInSmallSteps) {
  std::uint64_t touched = 0;
  for (std::uint64_t seed = 0; seed < 4000; ++seed) {
    RandomStream random(seed, 0, 0, Purpose::model_start);
    auto const number = [&] { return 2.0 * random.uniform() - 1.0; };
    Obstacle obstacle{{number(), number()}, {}, 0.0};
    obstacle.to = seed % 2 == 0 ? obstacle.from : Vector{number(), number()};
    if (seed % 2 == 0) obstacle.radius = 0.05 + 0.4 * random.uniform();
    double const radius = 0.01 + 0.3 * random.uniform();
    Vector const gravity = seed % 3 == 0 ? Vector{} : Vector{3.0 * number(), 3.0 * number()};
    exact::Path const path{{2.0 * number(), 2.0 * number()}, {2.0 * number(), 2.0 * number()}, gravity};
    double const gap =
        std::sqrt(squared_length(path.position - obstacle.nearest_to(path.position))) - radius - obstacle.radius;
    if (gap < 1e-3) continue;
    constexpr double end = 4.0;
    double const predicted = exact::time_to_touch(obstacle, radius, path);
    double const seen = first_overlap(obstacle, radius, path, end);
    if (seen <= end) {
      ++touched;
      EXPECT_LE(predicted, seen) << "seed " << seed;
      Vector const p = path.at(predicted);
      double const gap_then = std::sqrt(squared_length(p - obstacle.nearest_to(p))) - radius - obstacle.radius;
      EXPECT_NEAR(gap_then, 0.0, 1e-9) << "seed " << seed;
    }
    if (predicted < end && seen > predicted + 2.0 * end / 20000) {
      // Between two of the points the disk may have grazed the obstacle.
      double deepest = 1.0;
      for (int k = -1000; k <= 1000; ++k) {
        Vector const p = path.at(std::max(0.0, predicted + k * 1e-6));
        deepest = std::min(deepest, std::sqrt(squared_length(p - obstacle.nearest_to(p))) - radius - obstacle.radius);
      }
      EXPECT_LT(deepest, 1e-9) << "seed " << seed << ": it was never there";
    }
  }
  EXPECT_GT(touched, 400U);
}

}  // namespace
}  // namespace gridlock
