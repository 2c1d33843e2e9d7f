// The exact engine against brute force, against its own past, and against the order and the width of its arithmetic.

#include <gtest/gtest.h>

#include <cmath>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "engine/exact/dynamics.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/grid/validate.hpp"
#include "reference/all_pairs_events.hpp"
#include "reference/compare_kernels.hpp"
#include "reference/random_scene.hpp"
#include "reference/shuffled_rows.hpp"

namespace gridlock {
namespace {

using reference::difference;
using reference::random_scene;
using reference::SceneSettings;
using reference::with_rows_shuffled;

struct ExactCase {
  std::string name;
  SceneSettings scene;
  /// Rounding grows with each collision by about twice the mean free path in radii: a few tenfold in a fluid, a
  /// hundredfold in a dilute gas. This many collisions a disk leave the digits that the tests compare.
  std::uint64_t collisions_per_disk = 10;

  friend std::ostream& operator<<(std::ostream& out, ExactCase const& c) { return out << c.name << ": " << c.scene; }
};

std::vector<ExactCase> exact_cases() {
  std::vector<ExactCase> cases{
      {"two_disks", {.count = 2, .packing_fraction = 0.3}, 4},
      {"dilute", {.count = 30, .packing_fraction = 0.02}, 1},
      {"fluid", {.count = 40, .packing_fraction = 0.5}, 6},
      {"dense", {.count = 49, .packing_fraction = 0.75}},
      {"channel", {.width = 6.0, .height = 0.3, .count = 30, .packing_fraction = 0.4}, 1},
      {"mixture",
       {.width = 1.6, .height = 0.9, .count = 40, .packing_fraction = 0.5, .smallest_ratio = 0.3, .heaviest_mass = 9.0},
       5},
      {"very_unequal", {.count = 60, .packing_fraction = 0.3, .smallest_ratio = 0.02, .heaviest_mass = 50.0}, 2},
  };
  std::size_t const walled = cases.size();
  for (std::size_t k = 0; k < walled; ++k) {
    ExactCase periodic = cases[k];
    periodic.name += "_periodic";
    periodic.scene.edge = Edge::periodic;
    cases.push_back(periodic);
  }
  return cases;
}

constexpr std::uint64_t seeds[]{1, 2, 3, 4};

EngineSettings exact_settings() { return {.kind = "exact", .audit_every = 7}; }

class ExactProperty : public testing::TestWithParam<ExactCase> {
 protected:
  static State start(std::uint64_t seed) {
    SceneSettings scene = GetParam().scene;
    scene.seed = seed;
    return random_scene(scene);
  }
  static std::uint64_t disks() { return GetParam().scene.count; }
  static std::uint64_t comparable_collisions() { return GetParam().collisions_per_disk * disks() / 2; }
};

INSTANTIATE_TEST_SUITE_P(Scenes, ExactProperty, testing::ValuesIn(exact_cases()),
                         [](auto const& scene) { return scene.param.name; });

TEST_P(ExactProperty, GoesThroughTheSameEventsAsBruteForce) {
  for (std::uint64_t const seed : seeds) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    State state = start(seed);
    reference::AllPairsEvents brute(state);
    auto const engine = make_engine(exact_settings(), state);
    Counters counters;
    for (std::uint64_t n = 1; n <= comparable_collisions(); ++n) {
      brute.collide_next();
      engine->advance(state, counters, {.pair_collisions = n});
      ASSERT_EQ(counters.pair_collisions, n);
      ASSERT_EQ(counters.wall_hits, brute.wall_hits) << "collision " << n;
      ASSERT_NEAR(state.clock.time, brute.state.clock.time, 1e-7) << "collision " << n;
      ASSERT_LT(difference(state, brute.state), 1e-6) << "collision " << n;
    }
    for (std::size_t i = 0; i < state.agents.size(); ++i) {
      EXPECT_EQ(state.agents.column<ImageX>()[i], brute.state.agents.column<ImageX>()[i]);
      EXPECT_EQ(state.agents.column<ImageY>()[i], brute.state.agents.column<ImageY>()[i]);
    }
  }
}

TEST_P(ExactProperty, RunsBackToItsStartWhenTheVelocitiesAreTurned) {
  for (std::uint64_t const seed : seeds) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    State const begin = start(seed);
    State state = begin;
    Counters counters;
    auto const engine = make_engine(exact_settings(), state);
    engine->advance(state, counters, {.time = 1e6, .pair_collisions = comparable_collisions()});
    // A little further, so that the way back does not begin in contact.
    double const end = state.clock.time * 1.001;
    engine->advance(state, counters, {.time = end});
    auto const turn_back = [&] {
      for (double& v : state.agents.column<VelocityX>()) v = -v;
      for (double& v : state.agents.column<VelocityY>()) v = -v;
    };
    turn_back();
    Counters back;
    engine->advance(state, back, {.time = 2.0 * end});
    turn_back();
    EXPECT_EQ(back.pair_collisions, counters.pair_collisions);
    EXPECT_LT(difference(state, begin), 1e-9);
  }
}

TEST_P(ExactProperty, HasTheSameBitsHoweverTheRunIsCut) {
  for (std::uint64_t const seed : seeds) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    State const begin = start(seed);
    double const step = make_engine(exact_settings(), begin)->time_step();
    State whole = begin;
    Counters whole_counters;
    make_engine(exact_settings(), whole)->advance(whole, whole_counters, {.step = 400});

    State cut = begin;
    Counters cut_counters;
    auto const engine = make_engine(exact_settings(), cut);
    for (std::uint64_t n = 1; n < 50; ++n) {
      engine->advance(cut, cut_counters, {.step = 3 * n});
      engine->advance(cut, cut_counters, {.step = 400, .time = cut.clock.time + 0.3 * step});
      engine->advance(cut, cut_counters, {.step = 400, .pair_collisions = cut_counters.pair_collisions + 1});
    }
    engine->advance(cut, cut_counters, {.step = 400});
    EXPECT_EQ(hash(whole), hash(cut));
    EXPECT_EQ(whole_counters.pair_collisions, cut_counters.pair_collisions);
    EXPECT_EQ(whole_counters.moves, cut_counters.moves);
    EXPECT_EQ(whole_counters.pair_virial, cut_counters.pair_virial);
    EXPECT_EQ(whole_counters.wall_impulse, cut_counters.wall_impulse);
  }
}

TEST_P(ExactProperty, KeepsEnergyAndNeverOverlaps) {
  State state = start(11);
  double const energy = kinetic_energy(state.agents);
  Counters counters;
  auto const engine = make_engine(exact_settings(), state);
  for (std::uint64_t n = 1; n <= 20; ++n) {
    engine->advance(state, counters, {.time = 1e6, .pair_collisions = 5 * n * disks()});
    EXPECT_LT(largest_overlap(state), 1e-12 * 2.0 * radius_range(state.agents).largest);
  }
  EXPECT_NEAR(kinetic_energy(state.agents), energy, 1e-11 * energy);
}

TEST_P(ExactProperty, PredictsTheSameBitsWithEveryKernelFromCellsAndFromLists) {
  for (exact::Lists const lists : {exact::Lists::never, exact::Lists::always}) {
    State const state = start(2);
    exact::Dynamics dynamics(state, {.lists = lists});
    Counters counters;
    for (std::uint64_t n = 1; n <= 20; ++n) {
      dynamics.run(1e6, n * disks() / 4, 0, counters);
      if (!reference::compare_kernels(dynamics)) GTEST_SKIP() << "not in so small a box";
    }
  }
}

TEST_P(ExactProperty, HasTheSameBitsWithAnyCellsAndWithLists) {
  for (std::uint64_t const seed : seeds) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    State const begin = start(seed);
    auto const end = [&](exact::DynamicsOptions const& options) {
      exact::Dynamics dynamics(begin, options);
      Counters counters;
      dynamics.run(1e6, 100 * disks(), 50, counters);
      State state = begin;
      dynamics.write_at_last_event(state);
      EXPECT_EQ(counters.pair_collisions, 100 * disks());
      return std::pair(hash(state), counters.pair_virial);
    };
    auto const expected = end({.lists = exact::Lists::never});
    EXPECT_EQ(end({.lists = exact::Lists::always}), expected);
    for (double const size_of_cells : {1.3, 2.0, 100.0}) {
      EXPECT_EQ(end({.size_of_cells = size_of_cells, .lists = exact::Lists::never}), expected) << size_of_cells;
      EXPECT_EQ(end({.size_of_cells = size_of_cells, .lists = exact::Lists::always}), expected) << size_of_cells;
    }
  }
}

TEST_P(ExactProperty, DependsOnlyOnIdsNotOnRows) {
  State const ordered = start(5);
  State a = ordered;
  State b = with_rows_shuffled(ordered, 1);
  Counters counters_a;
  Counters counters_b;
  make_engine(exact_settings(), a)->advance(a, counters_a, {.step = 200});
  make_engine(exact_settings(), b)->advance(b, counters_b, {.step = 200});
  EXPECT_EQ(hash(a), hash(b));
}

// Enough disks that memory is sorted, fetched ahead and laid out in huge pages.
TEST(ExactManyDisks, KeepTheirDistanceAndTheirBitsHoweverTheRunIsCut) {
  State state{.box = Box(180.0, 160.0, Edge::periodic), .seed = 1};
  for (std::uint64_t i = 0; i < 150 * 140; ++i) {
    RandomStream random(1, 0, i, Purpose::start_velocity);
    Vector const v = random.in_unit_disk();
    state.agents.add((static_cast<double>(i % 150) + 0.5) * 1.2, (static_cast<double>(i / 150) + 0.5) * 160.0 / 140.0,
                     v.x, v.y, 0.5, 1.0, 0, 0);
  }
  State cut = state;
  Counters counters;
  make_engine({.kind = "exact", .audit_every = 20011}, state)->advance(state, counters, {.time = 20.0});
  EXPECT_GT(counters.pair_collisions, 10 * state.agents.size());
  auto const engine = make_engine({.kind = "exact"}, cut);
  Counters cut_counters;
  for (double const time : {0.1, 3.0, 11.7, 20.0}) engine->advance(cut, cut_counters, {.time = time});
  EXPECT_EQ(hash(state), hash(cut));
  EXPECT_EQ(counters.pair_virial, cut_counters.pair_virial);
}

}  // namespace
}  // namespace gridlock
