// The exact engine against brute force, against its own past, and against the order and the width of its arithmetic.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <ostream>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/exact/dynamics.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/grid/validate.hpp"
#include "io/checkpoint.hpp"
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
      {"two_disks", {.width = 1.1, .height = 0.9, .count = 2, .packing_fraction = 0.3}, 4},
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
    ExactCase along_x = periodic;
    along_x.name = cases[k].name + "_periodic_in_x";
    along_x.scene.edge_y = Edge::wall;
    cases.push_back(along_x);
    ExactCase along_y = cases[k];
    along_y.name += "_periodic_in_y";
    along_y.scene.edge_y = Edge::periodic;
    cases.push_back(along_y);
  }
  ExactCase oblique = cases[5];
  oblique.name += "_oblique";
  oblique.scene.edge = Edge::periodic;
  oblique.scene.tilt = 0.7;
  cases.push_back(oblique);
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
  for (exact::Lists const lists : {exact::Lists::not_at_all, exact::Lists::always}) {
    State const state = start(2);
    exact::Dynamics dynamics(state, {.lists = lists});
    reference::compare_start(dynamics);
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
    auto const expected = end({.lists = exact::Lists::not_at_all});
    EXPECT_EQ(end({.lists = exact::Lists::always}), expected);
    for (double const size_of_cells : {1.3, 2.0, 100.0}) {
      EXPECT_EQ(end({.size_of_cells = size_of_cells, .lists = exact::Lists::not_at_all}), expected) << size_of_cells;
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

struct UnequalCase {
  std::string name;
  Edge edge;
  double ratio;
  std::uint64_t small;
  std::uint64_t large;
  double packing_fraction = 0.4;
  double tilt = 0.0;

  friend std::ostream& operator<<(std::ostream& out, UnequalCase const& c) { return out << c.name; }
};

/// Disks of two sizes, and some between them: a large one has many neighbours, and they are found in cells of several
/// sizes.
class ExactUnequal : public testing::TestWithParam<UnequalCase> {
 protected:
  /// Large disks first, each at a random place where it overlaps none before it; masses go with the areas.
  static State start() {
    UnequalCase const& c = GetParam();
    State state{.box = Box(1.3, 1.0, c.edge).tilted(c.tilt), .seed = 3};
    auto const count = static_cast<double>(c.small) + c.ratio * c.ratio * static_cast<double>(c.large);
    double const radius = std::sqrt(c.packing_fraction * state.box.area() / (std::numbers::pi * count));
    RandomStream random(3, 0, 0, Purpose::start_position);
    for (std::uint64_t n = 0; n < c.large + c.small; ++n) {
      double const size = n < c.large ? c.ratio : n % 5 == 0 ? 0.5 : 1.0;
      Vector const v = random.in_unit_disk();
      state.agents.add(0.0, 0.0, v.x, v.y, size * radius, size * size, 0, 0);
      Vector p{};
      do p = {1.3 * random.uniform(), random.uniform()};
      while (!is_free(state, p));
      state.agents.column<X>()[n] = p.x;
      state.agents.column<Y>()[n] = p.y;
    }
    return state;
  }

  static std::pair<std::uint64_t, double> end_of_run(State state, exact::DynamicsOptions const& options) {
    exact::Dynamics dynamics(state, options);
    Counters counters;
    dynamics.run(1e6, 6 * state.agents.size(), 1999, counters);
    dynamics.write_at_last_event(state);
    return {hash(state), counters.pair_virial};
  }
  static std::pair<std::uint64_t, double> end_of_growth(State state, exact::DynamicsOptions const& options) {
    exact::Dynamics dynamics(state, options);
    Counters counters;
    for (int times = 0; times < 5; ++times) {
      dynamics.grow({.scale = 1.3, .hits = dynamics.hits() + 4 * state.agents.size()}, 1999, counters);
      dynamics.renew();
    }
    dynamics.write_at_last_event(state);
    return {hash(state), counters.pair_virial};
  }

 private:
  static bool is_free(State const& state, Vector p) {
    std::size_t const last = state.agents.size() - 1;
    auto const r = state.agents.column<Radius>();
    bool const is_in_box = p.x >= r[last] && p.x <= 1.3 - r[last] && p.y >= r[last] && p.y <= 1.0 - r[last];
    if (!state.box.is_periodic() && !is_in_box) return false;
    for (std::size_t j = 0; j < last; ++j) {
      double const contact = r[last] + r[j];
      if (squared_length(state.box.displacement(p, position(state.agents, j))) < contact * contact) return false;
    }
    return true;
  }
};

INSTANTIATE_TEST_SUITE_P(Mixtures, ExactUnequal,
                         testing::Values(UnequalCase{"one_to_3", Edge::wall, 3.0, 300, 30},
                                         UnequalCase{"one_to_3_periodic", Edge::periodic, 3.0, 300, 30},
                                         UnequalCase{"one_to_10", Edge::wall, 10.0, 500, 12},
                                         UnequalCase{"one_to_10_periodic", Edge::periodic, 10.0, 500, 12},
                                         UnequalCase{"one_to_10_oblique", Edge::periodic, 10.0, 500, 12, 0.4, 0.45},
                                         UnequalCase{"one_to_10_half", Edge::periodic, 10.0, 60, 60},
                                         UnequalCase{"one_to_50", Edge::wall, 50.0, 900, 1},
                                         UnequalCase{"one_to_20_periodic", Edge::periodic, 20.0, 1700, 1, 0.2}),
                         [](auto const& mixture) { return mixture.param.name; });

TEST_P(ExactUnequal, HasTheSameBitsWithAnyCellsAndWithLists) {
  State const begin = start();
  auto const expected = end_of_run(begin, {.lists = exact::Lists::not_at_all});
  for (double const size_of_cells : {1.0, 1.7, 100.0}) {
    EXPECT_EQ(end_of_run(begin, {.size_of_cells = size_of_cells, .lists = exact::Lists::always}), expected);
    EXPECT_EQ(end_of_run(begin, {.size_of_cells = size_of_cells, .lists = exact::Lists::not_at_all}), expected);
  }
  EXPECT_EQ(end_of_run(begin, {}), expected);
}

TEST_P(ExactUnequal, GrowsToTheSameBitsWithCellsAndWithLists) {
  State const begin = start();
  auto const expected = end_of_growth(begin, {.rate = 0.05, .lists = exact::Lists::not_at_all});
  EXPECT_EQ(end_of_growth(begin, {.rate = 0.05, .lists = exact::Lists::always}), expected);
  EXPECT_EQ(end_of_growth(begin, {.rate = 0.05}), expected);
}

TEST_P(ExactUnequal, PredictsTheSameBitsWithEveryKernel) {
  State const state = start();
  for (exact::Lists const lists : {exact::Lists::not_at_all, exact::Lists::always}) {
    for (double const rate : {0.0, 0.02}) {
      exact::Dynamics dynamics(state, {.rate = rate, .lists = lists});
      Counters counters;
      for (std::uint64_t n = 1; n <= 3; ++n) {
        if (rate == 0.0) {
          dynamics.run(1e6, n * state.agents.size(), 0, counters);
        } else {
          dynamics.grow({.hits = n * state.agents.size()}, 0, counters);
        }
        reference::compare_kernels(dynamics);
      }
      exact::PredictionInput const& input = dynamics.prediction_input();
      EXPECT_EQ(input.neighbours != nullptr, lists == exact::Lists::always || state.box.is_oblique());
      if (input.neighbours == nullptr) continue;
      std::span const all(input.neighbours, dynamics.size());
      bool const has_long_lists = !std::ranges::all_of(all, &exact::Neighbours::has_all);
      EXPECT_TRUE(has_long_lists) << "the test does not see long lists";
    }
  }
}

TEST_P(ExactUnequal, PredictsFromEachPairAtTheStartWhatEveryDiskFindsByItself) {
  for (exact::Lists const lists : {exact::Lists::not_at_all, exact::Lists::always}) {
    exact::Dynamics dynamics(start(), {.lists = lists});
    reference::compare_start(dynamics);
  }
}

TEST_P(ExactUnequal, GoesOnFromACheckpointWithTheSameBitsAndEvents) {
  for (exact::Lists const lists : {exact::Lists::not_at_all, exact::Lists::always}) {
    State state = start();
    std::uint64_t const half = 3 * state.agents.size();
    exact::Dynamics dynamics(state, {.lists = lists});
    Counters counters;
    dynamics.run(1e6, half, 0, counters);
    dynamics.write_at_last_event(state);
    std::string const saved = to_checkpoint([&](Archive& archive) { dynamics.serialize(archive); });
    exact::Dynamics resumed(state, {.lists = lists});
    from_checkpoint(saved, "saved", [&](Archive& archive) { resumed.serialize(archive); });
    Counters resumed_counters = counters;
    dynamics.run(1e6, 2 * half, 0, counters);
    resumed.run(1e6, 2 * half, 997, resumed_counters);
    State resumed_state = state;
    dynamics.write_at_last_event(state);
    resumed.write_at_last_event(resumed_state);
    EXPECT_EQ(hash(state), hash(resumed_state));
    EXPECT_EQ(counters.moves, resumed_counters.moves);
  }
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
