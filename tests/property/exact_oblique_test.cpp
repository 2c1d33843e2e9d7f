// Hard disks from event to event in oblique boxes: against the rectangle that holds two of them, and with obstacles,
// baths and threads, and against brute force. tests/property/exact_test.cpp has an oblique box too.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/exact/dynamics.hpp"
#include "engine/obstacles.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/engine/growth.hpp"
#include "gridlock/grid/validate.hpp"
#include "gridlock/lattice/start.hpp"
#include "io/checkpoint.hpp"
#include "reference/all_pairs_events.hpp"
#include "reference/compare_kernels.hpp"
#include "reference/random_scene.hpp"

namespace gridlock {
namespace {

/// Two copies of an oblique box, one above the other. With a shift of half the width the boxes above them lie where
/// those of a rectangle do.
State two_in_a_rectangle(State const& oblique) {
  Box const& box = oblique.box;
  State state{.box = Box(box.width(), 2.0 * box.height(), Edge::periodic), .seed = oblique.seed};
  for (int copy = 0; copy < 2; ++copy) {
    for (std::size_t i = 0; i < oblique.agents.size(); ++i) {
      auto const crossed_x = static_cast<double>(oblique.agents.column<ImageX>()[i]);
      auto const crossed_y = static_cast<double>(oblique.agents.column<ImageY>()[i]);
      // Counting from where the disk began, in this copy of the box, and not from where it came in again.
      Vector const unwrapped = position(oblique.agents, i) + box.offset_of_image(crossed_x, crossed_y + copy);
      Vector const p = state.box.inside(unwrapped);
      Vector const v = velocity(oblique.agents, i);
      state.agents.add(p.x, p.y, v.x, v.y, oblique.agents.column<Radius>()[i], oblique.agents.column<Mass>()[i], 0, 0);
    }
  }
  return state;
}

TEST(ExactOblique, HasTheCollisionsOfTheRectangleThatHoldsTwoOfTheBoxes) {
  for (double const packing_fraction : {0.05, 0.3, 0.6, 0.72}) {
    SCOPED_TRACE(packing_fraction);
    State state = reference::random_scene({.edge = Edge::periodic,
                                           .width = 1.0,
                                           .height = 1.0,
                                           .count = 60,
                                           .packing_fraction = packing_fraction,
                                           .smallest_ratio = 0.6,
                                           .seed = 4,
                                           .tilt = 0.5});
    ASSERT_EQ(std::abs(state.box.shift()), 0.5 * state.box.width());
    State both = two_in_a_rectangle(state);
    auto const engine = make_engine({.kind = "exact", .audit_every = 5}, state);
    auto const engine_of_both = make_engine({.kind = "exact"}, both);
    Counters counters;
    Counters counters_of_both;
    // Rounding grows with each collision, in a gas more than in a fluid; then the two ways part.
    std::uint64_t const collisions = packing_fraction < 0.1 ? 60 : 180;
    for (std::uint64_t n = 30; n <= collisions; n += 30) {
      engine->advance(state, counters, {.time = 1e6, .pair_collisions = n});
      double const time = state.clock.time * (1.0 + 1e-7);
      engine->advance(state, counters, {.time = time});
      engine_of_both->advance(both, counters_of_both, {.time = time});
      ASSERT_EQ(counters_of_both.pair_collisions, 2 * counters.pair_collisions);
      ASSERT_NEAR(counters_of_both.pair_virial, 2.0 * counters.pair_virial, 1e-6 * counters.pair_virial);
      ASSERT_LT(reference::difference(two_in_a_rectangle(state), both), 1e-6) << n << " collisions";
    }
  }
}

TEST(ExactOblique, GoesThroughTheEventsOfBruteForceAndPredictsThemWithEveryKernel) {
  // Rounding grows with each collision, so each scene has a number of collisions after which digits are left.
  std::pair<reference::SceneSettings, std::uint64_t> const scenes[]{
      {{.width = 1.1, .height = 0.9, .count = 2, .packing_fraction = 0.3, .tilt = 0.6}, 4},
      {{.count = 30, .packing_fraction = 0.02, .tilt = -0.35}, 15},
      {{.count = 49, .packing_fraction = 0.75, .tilt = 0.2}, 150},
      {{.width = 6.0, .height = 0.3, .count = 30, .packing_fraction = 0.4, .tilt = 9.0}, 15},
      {{.width = 0.3, .height = 6.0, .count = 30, .packing_fraction = 0.4, .tilt = -0.017}, 15},
      {{.count = 60, .packing_fraction = 0.3, .smallest_ratio = 0.02, .heaviest_mass = 50.0, .tilt = -0.78}, 60},
  };
  for (auto const& [scene, collisions] : scenes) {
    for (std::uint64_t const seed : {1, 2}) {
      reference::SceneSettings settings = scene;
      settings.edge = Edge::periodic;
      settings.seed = seed;
      SCOPED_TRACE(testing::Message() << settings);
      State state = reference::random_scene(settings);
      reference::AllPairsEvents brute(state);
      exact::Dynamics dynamics(state);
      Counters counters;
      for (std::uint64_t n = 1; n <= collisions; ++n) {
        brute.collide_next();
        dynamics.run(1e6, n, 7, counters);
        dynamics.write_at_last_event(state);
        ASSERT_NEAR(dynamics.last_event(), brute.time, 1e-7) << "collision " << n;
        ASSERT_LT(reference::difference(state, brute.state), 1e-6) << "collision " << n;
        if (n % 10 == 0) EXPECT_TRUE(reference::compare_kernels(dynamics));
      }
      for (std::size_t i = 0; i < state.agents.size(); ++i) {
        EXPECT_EQ(state.agents.column<ImageX>()[i], brute.state.agents.column<ImageX>()[i]);
        EXPECT_EQ(state.agents.column<ImageY>()[i], brute.state.agents.column<ImageY>()[i]);
      }
    }
  }
}

TEST(ExactOblique, KeepsEnergyAndMomentumAndCountsTheEdgesThatDisksCross) {
  State state = reference::random_scene(
      {.edge = Edge::periodic, .count = 80, .packing_fraction = 0.02, .heaviest_mass = 5.0, .seed = 2, .tilt = -0.4});
  auto const momentum = [&] {
    Vector sum;
    for (std::size_t i = 0; i < state.agents.size(); ++i)
      sum = sum + state.agents.column<Mass>()[i] * velocity(state.agents, i);
    return sum;
  };
  auto const centre_of_mass = [&] {
    Vector sum;
    for (std::size_t i = 0; i < state.agents.size(); ++i) {
      auto const crossed_x = static_cast<double>(state.agents.column<ImageX>()[i]);
      auto const crossed_y = static_cast<double>(state.agents.column<ImageY>()[i]);
      Vector const unwrapped = position(state.agents, i) + state.box.offset_of_image(crossed_x, crossed_y);
      sum = sum + state.agents.column<Mass>()[i] * unwrapped;
    }
    return sum;
  };
  double const energy = kinetic_energy(state.agents);
  Vector const at_start = momentum();
  Vector const first = centre_of_mass();
  Counters counters;
  make_engine({.kind = "exact", .audit_every = 100}, state)->advance(state, counters, {.time = 50.0});
  EXPECT_GT(counters.pair_collisions, 10 * state.agents.size());
  EXPECT_NEAR(kinetic_energy(state.agents), energy, 1e-11 * energy);
  EXPECT_LT(squared_length(momentum() - at_start), 1e-22);
  // Only with every edge counted does the centre of mass of all disks move evenly.
  EXPECT_LT(squared_length(centre_of_mass() - first - 50.0 * at_start), 1e-16);
}

TEST(ExactOblique, GrowsThroughTheEventsOfBruteForce) {
  for (double const tilt : {0.3, -0.7}) {
    reference::SceneSettings const scene{
        .edge = Edge::periodic, .count = 30, .packing_fraction = 0.35, .smallest_ratio = 0.5, .seed = 3, .tilt = tilt};
    State state = reference::random_scene(scene);
    reference::AllPairsEvents brute(state, 0.1);
    exact::Dynamics dynamics(state, {.rate = 0.1});
    Counters counters;
    for (std::uint64_t n = 1; n <= 90; ++n) {
      brute.collide_next();
      ASSERT_FALSE(dynamics.grow({.pair_collisions = n}, 3, counters));
      if (n % 40 == 0) dynamics.renew();
      dynamics.write_at_last_event(state);
      ASSERT_NEAR(dynamics.last_event(), brute.time, 1e-7) << "collision " << n;
      ASSERT_LT(reference::difference(state, brute.state), 1e-6) << "collision " << n;
    }
  }
}

TEST(ExactOblique, GrowsDisksToADensePackingWithoutOverlap) {
  Box const box = Box(1.0, 0.9, Edge::periodic).tilted(0.4);
  State state = make_start(box, {.count = 100, .packing_fraction = 0.4, .start = StartKind::random}, 2);
  draw_velocities(state, {});
  Growth growth({.rate = 0.01, .packing_fraction = 0.8, .audit_every = 500}, state);
  Counters counters;
  growth.advance(state, counters);
  EXPECT_NEAR(packing_fraction_of(state), 0.8, 1e-12);
  EXPECT_NO_THROW(validate(state, {.overlap = 1e-12}));
}

State crowd(std::uint64_t seed) {
  Box const box = Box(1.0, 1.3, Edge::periodic).tilted(0.31);
  State state = make_start(box, {.count = 6'000, .packing_fraction = 0.6, .start = StartKind::square}, seed);
  draw_velocities(state, {});
  return state;
}

TEST(ExactOblique, HasTheSameBitsOnAnyNumberOfThreadsInABathToo) {
  for (ThermostatKind const bath : {ThermostatKind::none, ThermostatKind::brownian}) {
    std::vector<std::uint64_t> hashes;
    for (std::uint64_t const threads : {1, 2, 3, 8}) {
      State state = crowd(1);
      EngineSettings settings{.kind = "exact", .speed = 1.0, .threads = threads};
      settings.thermostat = {.kind = bath};
      if (bath == ThermostatKind::brownian) {
        settings.thermostat = {.kind = bath, .temperature = 0.5, .interval = 0.02};
        settings.propulsion = {.speed = 1.0, .rotational_diffusion = 3.0};
      }
      Counters counters;
      make_engine(settings, state)->advance(state, counters, {.time = 0.06});
      EXPECT_GT(counters.pair_collisions, state.agents.size());
      hashes.push_back(hash(state));
    }
    EXPECT_EQ(hashes, std::vector(hashes.size(), hashes.front())) << static_cast<int>(bath);
  }
}

TEST(ExactOblique, GoesOnFromACheckpointWithTheSameBits) {
  State state = crowd(2);
  EngineSettings const settings{.kind = "exact", .threads = 2};
  auto const engine = make_engine(settings, state);
  Counters counters;
  engine->advance(state, counters, {.time = 0.03});
  std::string const saved = to_checkpoint([&](Archive& archive) { engine->serialize(archive, state); });
  State resumed = state;
  Counters counters_of_resumed = counters;
  auto const again = make_engine(settings, resumed);
  from_checkpoint(saved, "saved", [&](Archive& archive) { again->serialize(archive, resumed); });
  engine->advance(state, counters, {.time = 0.06});
  again->advance(resumed, counters_of_resumed, {.time = 0.06});
  EXPECT_EQ(hash(resumed), hash(state));
  EXPECT_EQ(counters_of_resumed.pair_virial, counters.pair_virial);
}

TEST(ExactOblique, KeepsDisksApartFromFixedOnesAcrossTheEdges) {
  Box const box = Box(1.25, 0.8, Edge::periodic).tilted(0.7);
  State state = make_start(box,
                           {.count = 150,
                            .packing_fraction = 0.4,
                            .start = StartKind::random,
                            .species = {{.fraction = 0.2, .fixed = true}, {.fraction = 0.8}}},
                           5);
  draw_velocities(state, {});
  double const energy = kinetic_energy(state.agents);
  auto const engine = make_engine({.kind = "exact", .audit_every = 50}, state);
  Counters counters;
  for (int n = 1; n <= 20; ++n) {
    engine->advance(state, counters, {.time = 0.1 * n});
    ASSERT_LT(largest_overlap(state), 1e-12) << "time " << state.clock.time;
  }
  EXPECT_NEAR(kinetic_energy(state.agents), energy, 1e-11 * energy);
  EXPECT_GT(counters.pair_collisions, 1000U);
  // The same with gravity and losses, which among fixed disks need no walls.
  EngineSettings const grains{.kind = "exact",
                              .audit_every = 50,
                              .collisions = {.restitution = 0.8, .contact_time = 1e-4},
                              .gravity = {.x = 0.5, .y = -1.0}};
  auto const engine_of_grains = make_engine(grains, state);
  for (int n = 1; n <= 10; ++n) {
    engine_of_grains->advance(state, counters, {.time = 2.0 + 0.1 * n});
    ASSERT_LT(largest_overlap(state), 1e-12) << "time " << state.clock.time;
  }
}

TEST(ExactOblique, KeepsDisksApartFromAWallOnTheEdgeAndFromItsImages) {
  Box const box = Box(1.25, 0.8, Edge::periodic).tilted(0.7);
  State state = make_start(box, {.count = 120, .packing_fraction = 0.3, .start = StartKind::square}, 6);
  draw_velocities(state, {});
  Obstacle const wall{.from = {0.2, 0.0}, .to = {0.9, 0.0}};
  EngineSettings const settings{.kind = "exact", .audit_every = 50, .walls = {{.from = {0.2, 0.0}, .to = {0.9, 0.0}}}};
  auto const engine = make_engine(settings, state);
  double const radius = state.agents.column<Radius>()[0];
  Counters counters;
  for (int n = 1; n <= 200; ++n) {
    engine->advance(state, counters, {.time = 0.01 * n});
    double nearest = 1.0;
    for (std::size_t i = 0; i < state.agents.size(); ++i) {
      for (int across = -2; across <= 2; ++across) {
        for (int up = -1; up <= 1; ++up) {
          Vector const p = position(state.agents, i) + box.offset_of_image(across, up);
          nearest = std::min(nearest, std::sqrt(squared_length(p - wall.nearest_to(p))));
        }
      }
    }
    ASSERT_GT(nearest, radius * (1.0 - 1e-10)) << "time " << state.clock.time;
  }
  EXPECT_GT(counters.inner_wall_hits, 100U);
}

TEST(ExactOblique, RefusesABoxInWhichDisksHaveNoRoomToMeetOneImageOnly) {
  auto const start = [](double height) {
    State state{.box = Box(1.0, height, Edge::periodic).tilted(0.2)};
    state.agents.add(0.2, 0.1, 0.3, 0.7, 0.1, 1.0, 0, 0);
    state.agents.add(0.7, 0.1, -0.2, 0.4, 0.1, 1.0, 0, 0);
    return state;
  };
  EXPECT_THROW(static_cast<void>(make_engine({.kind = "exact"}, start(0.419))), Error);
  State narrow = start(0.421);
  Counters counters;
  reference::AllPairsEvents brute(narrow);
  make_engine({.kind = "exact", .audit_every = 1}, narrow)->advance(narrow, counters, {.pair_collisions = 6});
  for (int n = 0; n < 6; ++n) brute.collide_next();
  EXPECT_LT(reference::difference(narrow, brute.state), 1e-7);
}

TEST(ExactOblique, RefusesAFlowWhichSoftDisksHave) {
  State const state = crowd(3);
  EXPECT_THROW(static_cast<void>(make_engine({.kind = "exact", .flow = {.shear_rate = 1.0}}, state)), Error);
}

}  // namespace
}  // namespace gridlock
