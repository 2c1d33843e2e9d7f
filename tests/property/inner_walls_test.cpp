// Walls inside the box under the rule with a time step: what disks do at them, and what must not depend on how a run is
// computed.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/obstacles.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/grid/validate.hpp"
#include "gridlock/lattice/start.hpp"
#include "reference/shuffled_rows.hpp"
#include "state_on_ranks.hpp"

namespace gridlock {
namespace {

/// A room of a box, closed by the floor and three walls; a wall in its middle that touches nothing, and one across it.
std::vector<WallSettings> const walls{{.from = {0.2, 0.0}, .to = {0.2, 0.8}},
                                      {.from = {0.2, 0.8}, .to = {1.1, 0.7}},
                                      {.from = {1.1, 0.7}, .to = {1.1, 0.0}},
                                      {.from = {0.55, 0.3}, .to = {0.75, 0.5}}};

/// Disks that start left of the wall in the middle of the room.
State start_of(std::size_t count, Edge edge_x) {
  State state = make_start(Box(1.3, 1.0, edge_x, Edge::wall),
                           {.count = count,
                            .packing_fraction = 0.45,
                            .region = {0.2, 0.0, 0.54, 0.7},
                            .species = {{.fraction = 0.5}, {.fraction = 0.5, .size_ratio = 1.4, .mass = 2.0}}},
                           5);
  draw_velocities(state, {});
  return state;
}

EngineSettings settings_of(std::string const& kind, bool are_active = false) {
  EngineSettings settings{.kind = kind, .threads = 1, .walls = walls};
  if (are_active) settings.propulsion = {.speed = 1.0, .rotational_diffusion = 3.0};
  return settings;
}

/// The largest overlap of a disk and a wall, in radii.
double largest_overlap_with_walls(State const& state) {
  double largest = 0.0;
  for (Obstacle const& wall : obstacles_of(walls)) {
    for (std::size_t i = 0; i < state.agents.size(); ++i) {
      Vector const p = position(state.agents, i);
      double const radius = state.agents.column<Radius>()[i];
      largest = std::max(largest, 1.0 - std::sqrt(squared_length(wall.nearest_to(p) - p)) / radius);
    }
  }
  return largest;
}

bool are_all_in_the_room(State const& state) {
  for (std::size_t i = 0; i < state.agents.size(); ++i) {
    Vector const p = position(state.agents, i);
    if (p.x < 0.2 || p.x > 1.1 || p.y > 0.8 - (p.x - 0.2) / 9.0) return false;
  }
  return true;
}

class RuleAtInnerWalls : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(All, RuleAtInnerWalls, testing::Values("stepped", "tiled"));

TEST_P(RuleAtInnerWalls, KeepsDisksInTheirRoomWithTheirEnergy) {
  for (bool const are_active : {false, true}) {
    State state = start_of(120, Edge::periodic);
    auto const engine = make_engine(settings_of(GetParam(), are_active), state);
    double const energy = kinetic_energy(state.agents);
    Counters counters;
    for (std::uint64_t step = 1; step <= 400; ++step) {
      engine->advance(state, counters, {.step = step});
      ASSERT_LE(largest_overlap_with_walls(state), rounding_at_walls) << "step " << step;
      ASSERT_TRUE(are_all_in_the_room(state)) << "step " << step;
    }
    EXPECT_NO_THROW(validate(state));
    EXPECT_GT(counters.inner_wall_hits, 100U);
    EXPECT_GT(counters.pair_collisions, 400U);
    if (are_active) continue;
    EXPECT_NEAR(kinetic_energy(state.agents), energy, 1e-12 * energy);
    EXPECT_GT(counters.inner_wall_impulse, 0.0);
  }
}

TEST_P(RuleAtInnerWalls, ReflectsADiskFromAWallAndFromItsEnd) {
  State state{.box = Box(4.0, 4.0, Edge::wall)};
  state.agents.add(0.6, 2.3, 1.0, 0.0, 0.5, 1.0, 0, 0);
  EngineSettings const settings{
      .kind = GetParam(), .time_step = 0.01, .walls = {{.from = {2.0, 0.5}, .to = {2.0, 2.0}}}};
  State at_end = state;
  Counters counters;
  auto const engine = make_engine(settings, at_end);
  while (counters.inner_wall_hits == 0) engine->advance(at_end, counters, {.step = at_end.clock.step + 1});
  // The normal is that from the end of the wall to the place where the disk halted, 0.4 and 0.3 away.
  Vector const p = position(at_end.agents, 0);
  EXPECT_NEAR(p.x, 1.6, 0.01 / 5.0 + 1e-12);
  Vector const n = (1.0 / std::sqrt(squared_length(p - Vector{2.0, 2.0}))) * (p - Vector{2.0, 2.0});
  EXPECT_NEAR(velocity(at_end.agents, 0).x, 1.0 - 2.0 * n.x * n.x, 1e-12);
  EXPECT_NEAR(velocity(at_end.agents, 0).y, -2.0 * n.x * n.y, 1e-12);
  EXPECT_NEAR(counters.inner_wall_impulse, 2.0 * std::abs(n.x), 1e-12);

  state.agents.column<Y>()[0] = 1.3;
  Counters at_wall;
  make_engine(settings, state)->advance(state, at_wall, {.step = 160});
  EXPECT_EQ(at_wall.inner_wall_hits, 1U);
  EXPECT_NEAR(velocity(state.agents, 0).x, -1.0, 1e-14);
  EXPECT_NEAR(velocity(state.agents, 0).y, 0.0, 1e-14);
  EXPECT_NEAR(at_wall.inner_wall_impulse, 2.0, 1e-14);
}

TEST_P(RuleAtInnerWalls, ReflectsADiskFromTheImageOfAWallBeyondAPeriodicEdge) {
  State state{.box = Box(4.0, 4.0, Edge::periodic)};
  state.agents.add(3.2, 1.0, 1.0, 0.0, 0.5, 1.0, 0, 0);
  EngineSettings const settings{.kind = GetParam(), .walls = {{.from = {0.2, 0.5}, .to = {0.2, 2.0}}}};
  Counters counters;
  make_engine(settings, state)->advance(state, counters, {.step = 10});
  EXPECT_EQ(counters.inner_wall_hits, 1U);
  EXPECT_NEAR(velocity(state.agents, 0).x, -1.0, 1e-14);
  EXPECT_EQ(state.agents.column<ImageX>()[0], 0);
}

TEST_P(RuleAtInnerWalls, GivesTheSameBitsHoweverTheRunIsCutAndTheRowsAreOrdered) {
  State const start = start_of(300, Edge::periodic);
  State whole = start;
  Counters counters;
  make_engine(settings_of(GetParam()), whole)->advance(whole, counters, {.step = 150});
  State cut = reference::with_rows_shuffled(start, 3);
  Counters counters_of_cut;
  for (std::uint64_t const step : {1U, 70U, 101U, 150U}) {
    make_engine(settings_of(GetParam()), cut)->advance(cut, counters_of_cut, {.step = step});
  }
  EXPECT_EQ(hash(cut), hash(whole));
  EXPECT_EQ(counters_of_cut.inner_wall_hits, counters.inner_wall_hits);
}

TEST(InnerWalls, GiveTheSameBitsOnBothGridsOfStepped) {
  for (bool const are_active : {false, true}) {
    for (Edge const edge : {Edge::periodic, Edge::wall}) {
      State packed = start_of(300, edge);
      State linked = packed;
      EngineSettings settings = settings_of("stepped", are_active);
      Counters counters;
      make_engine(settings, packed)->advance(packed, counters, {.step = 150});
      settings.grid = GridKind::linked;
      Counters of_linked;
      make_engine(settings, linked)->advance(linked, of_linked, {.step = 150});
      EXPECT_EQ(hash(linked), hash(packed));
      EXPECT_EQ(of_linked.inner_wall_hits, counters.inner_wall_hits);
      EXPECT_EQ(of_linked.inner_wall_impulse, counters.inner_wall_impulse);
    }
  }
}

TEST(InnerWalls, GiveTheSameBitsAndCountersOnThreadsAndProcesses) {
  for (bool const are_active : {false, true}) {
    State const start = start_of(4000, Edge::periodic);
    EngineSettings settings = settings_of("tiled", are_active);
    State one = start;
    Counters of_one;
    make_engine(settings, one)->advance(one, of_one, {.step = 130});
    EXPECT_GT(of_one.inner_wall_hits, 100U);
    for (std::uint64_t const threads : {2U, 3U, 8U}) {
      settings.threads = threads;
      State state = start;
      Counters counters;
      make_engine(settings, state)->advance(state, counters, {.step = 130});
      EXPECT_EQ(hash(state), hash(one)) << threads << " threads";
      EXPECT_EQ(counters.inner_wall_impulse, of_one.inner_wall_impulse);
    }
    settings.threads = 1;
    for (std::size_t const processes : {2U, 3U}) {
      State state = start;
      Counters counters;
      test::ThreadRanks ranks(processes);
      test::advance_on_ranks(settings, ranks, state, counters, {.step = 130});
      EXPECT_EQ(hash(state), hash(one)) << processes << " processes";
      EXPECT_EQ(counters.inner_wall_hits, of_one.inner_wall_hits);
      EXPECT_EQ(counters.inner_wall_impulse, of_one.inner_wall_impulse);
    }
  }
}

}  // namespace
}  // namespace gridlock
