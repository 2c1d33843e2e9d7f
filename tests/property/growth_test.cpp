// Growing disks in the exact engine: against brute force, against other cells, and cut into pieces.

#include "gridlock/engine/growth.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "core/temperature.hpp"
#include "engine/exact/dynamics.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/grid/validate.hpp"
#include "io/checkpoint.hpp"
#include "reference/all_pairs_events.hpp"
#include "reference/compare_kernels.hpp"
#include "reference/hard_engines.hpp"
#include "reference/random_scene.hpp"
#include "reference/shuffled_rows.hpp"

namespace gridlock {
namespace {

using reference::difference;
using reference::random_scene;
using reference::SceneSettings;
using reference::with_rows_shuffled;

struct GrowthCase {
  std::string name;
  SceneSettings scene;
  double rate;  ///< of the radii, in radii per time
  /// This many collisions a disk leave the digits that the tests compare, see exact_test.cpp.
  std::uint64_t collisions_per_disk = 6;

  friend std::ostream& operator<<(std::ostream& out, GrowthCase const& c) {
    return out << c.name << ": " << c.scene << ", rate " << c.rate;
  }
};

std::vector<GrowthCase> growth_cases() {
  std::vector<GrowthCase> cases{
      {"few", {.count = 9, .packing_fraction = 0.3}, 0.05, 4},
      {"dilute", {.count = 30, .packing_fraction = 0.02}, 0.5, 1},
      {"fluid", {.count = 40, .packing_fraction = 0.5}, 0.05},
      {"fast", {.count = 40, .packing_fraction = 0.2}, 2.0, 4},
      {"dense", {.count = 49, .packing_fraction = 0.7}, 0.01, 8},
      {"channel", {.width = 6.0, .height = 0.3, .count = 30, .packing_fraction = 0.4}, 0.05, 1},
      {"mixture",
       {.width = 1.6, .height = 0.9, .count = 40, .packing_fraction = 0.4, .smallest_ratio = 0.3, .heaviest_mass = 9.0},
       0.1,
       4},
      {"very_unequal", {.count = 60, .packing_fraction = 0.3, .smallest_ratio = 0.02, .heaviest_mass = 50.0}, 0.1, 2},
  };
  std::size_t const walled = cases.size();
  for (std::size_t k = 0; k < walled; ++k) {
    GrowthCase periodic = cases[k];
    periodic.name += "_periodic";
    periodic.scene.edge = Edge::periodic;
    cases.push_back(periodic);
    GrowthCase along_x = periodic;
    along_x.name = cases[k].name + "_periodic_in_x";
    along_x.scene.edge_y = Edge::wall;
    cases.push_back(along_x);
  }
  return cases;
}

constexpr std::uint64_t growth_seeds[]{1, 2, 3, 4};

class GrowthProperty : public testing::TestWithParam<GrowthCase> {
 protected:
  static State start(std::uint64_t seed) {
    SceneSettings scene = GetParam().scene;
    scene.seed = seed;
    return random_scene(scene);
  }
  static exact::DynamicsOptions growth(double size_of_cells = 1.0, exact::Lists lists = exact::Lists::where_they_pay) {
    return {.rate = GetParam().rate, .size_of_cells = size_of_cells, .lists = lists};
  }
  static std::uint64_t disks() { return GetParam().scene.count; }
};

INSTANTIATE_TEST_SUITE_P(Scenes, GrowthProperty, testing::ValuesIn(growth_cases()),
                         [](auto const& scene) { return scene.param.name; });

TEST_P(GrowthProperty, GoesThroughTheSameEventsAsBruteForce) {
  for (std::uint64_t const seed : growth_seeds) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    State state = start(seed);
    reference::AllPairsEvents brute(state, GetParam().rate);
    exact::Dynamics dynamics(state, growth());
    Counters counters;
    double virial = 0.0;
    for (std::uint64_t n = 1; n <= GetParam().collisions_per_disk * disks() / 2; ++n) {
      brute.collide_next();
      ASSERT_FALSE(dynamics.grow({.pair_collisions = n}, 3, counters));
      if (n % (2 * disks()) == 0) dynamics.renew();
      dynamics.write_at_last_event(state);
      ASSERT_EQ(counters.pair_collisions, n);
      ASSERT_EQ(counters.wall_hits, brute.wall_hits) << "collision " << n;
      ASSERT_NEAR(dynamics.last_event(), brute.time, 1e-7) << "collision " << n;
      ASSERT_LT(difference(state, brute.state), 1e-6) << "collision " << n;
      ASSERT_NEAR(counters.pair_virial, brute.pair_virial, 1e-6 * brute.pair_virial) << "collision " << n;
      for (std::size_t wall = 0; wall < 4; ++wall) {
        ASSERT_NEAR(counters.wall_impulse[wall], brute.wall_impulse[wall], 1e-6) << "collision " << n;
      }
      virial = dynamics.measurement().virial;
    }
    EXPECT_NEAR(virial, brute.pair_virial + brute.wall_virial, 1e-6 * virial);
    EXPECT_NEAR(dynamics.scale(), 1.0 + GetParam().rate * brute.time, 1e-7);
    for (std::size_t i = 0; i < state.agents.size(); ++i) {
      EXPECT_NEAR(state.agents.column<Radius>()[i], brute.radius(i), 1e-9);
      EXPECT_EQ(state.agents.column<ImageX>()[i], brute.state.agents.column<ImageX>()[i]);
      EXPECT_EQ(state.agents.column<ImageY>()[i], brute.state.agents.column<ImageY>()[i]);
    }
  }
}

/// By how much the disks of a scene can grow before they fill two thirds of the box, or of a periodic box so narrow
/// that they could touch two images of a partner.
double last_scale(State const& state) {
  double const now = covered_area(state.agents) / state.box.area();
  double const diameter = 2.0 * radius_range(state.agents).largest;
  double const room = 0.49 * std::min(state.box.width(), state.box.height()) / diameter;
  return std::min(std::sqrt(0.67 / now), room);
}

/// Renewed as Growth does it, up to `collisions` in all or, which is the answer, the last scale.
bool grow(exact::Dynamics& dynamics, double scale, std::uint64_t collisions, Counters& counters) {
  std::uint64_t const leg = 10 * dynamics.size();
  while (counters.pair_collisions < collisions) {
    std::uint64_t const leg_end = std::min(collisions, (counters.pair_collisions / leg + 1) * leg);
    if (dynamics.grow({.scale = scale, .pair_collisions = leg_end}, 101, counters)) return true;
    if (counters.pair_collisions % leg == 0) dynamics.renew(0.97);
  }
  return false;
}

/// The state after so many collisions or at the last scale.
void write(exact::Dynamics const& dynamics, bool is_at_scale, State& state) {
  if (is_at_scale) {
    dynamics.write_grown(last_scale(state), state);
  } else {
    dynamics.write_at_last_event(state);
  }
}

TEST_P(GrowthProperty, HasTheSameBitsWithAnyCellsAndWithLists) {
  for (std::uint64_t const seed : growth_seeds) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    State const begin = start(seed);
    State fine = begin;
    Counters fine_counters;
    exact::Dynamics fine_dynamics(begin, growth());
    write(fine_dynamics, grow(fine_dynamics, last_scale(begin), 100 * disks(), fine_counters), fine);
    for (double const size_of_cells : {1.0, 1.3, 2.0, 100.0}) {
      for (exact::Lists const lists : {exact::Lists::always, exact::Lists::not_at_all}) {
        State other = begin;
        Counters other_counters;
        exact::Dynamics other_dynamics(begin, growth(size_of_cells, lists));
        write(other_dynamics, grow(other_dynamics, last_scale(begin), 100 * disks(), other_counters), other);
        EXPECT_EQ(hash(fine), hash(other)) << size_of_cells;
        EXPECT_EQ(fine_counters.pair_virial, other_counters.pair_virial);
        EXPECT_EQ(fine_counters.wall_impulse, other_counters.wall_impulse);
        EXPECT_EQ(fine_dynamics.measurement().virial, other_dynamics.measurement().virial);
      }
    }
  }
}

// From a fluid to gaps of a millionth, through cells that become larger and give way to lists of neighbours.
TEST(GrowthOfManyDisks, HasTheSameBitsForAnyCellsUpToJamming) {
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    State const begin =
        random_scene({.edge = edge, .count = 150, .packing_fraction = 0.4, .smallest_ratio = 0.6, .seed = 3});
    std::vector<std::uint64_t> hashes;
    std::vector<double> virials;
    for (double const size_of_cells : {1.0, 1.25}) {
      State state = begin;
      Counters counters;
      exact::Dynamics dynamics(begin, {.rate = 0.02, .size_of_cells = size_of_cells});
      for (std::uint64_t leg = 1; leg <= 150; ++leg) {
        dynamics.grow({.hits = leg * 40 * begin.agents.size()}, 0, counters);
        dynamics.renew(0.9);
        reference::compare_kernels(dynamics);
      }
      EXPECT_NE(dynamics.prediction_input().neighbours, nullptr);
      dynamics.audit();
      dynamics.write_at_last_event(state);
      EXPECT_GT(covered_area(state.agents), 0.8);
      hashes.push_back(hash(state));
      virials.push_back(counters.pair_virial);
    }
    EXPECT_EQ(hashes[0], hashes[1]);
    EXPECT_EQ(virials[0], virials[1]);
  }
}

TEST(GrowthOfManyDisks, HasTheSameBitsInterruptedSavedAndRestoredUpToJamming) {
  State const begin = random_scene(
      {.edge = Edge::periodic, .count = 120, .packing_fraction = 0.4, .smallest_ratio = 0.7, .heaviest_mass = 5.0});
  GrowthSettings const settings{.rate = 0.02, .pressure = 1e7, .audit_every = 9973};
  State whole = begin;
  Counters whole_counters;
  ASSERT_TRUE(Growth(settings, begin).advance(whole, whole_counters));
  State cut = begin;
  Counters cut_counters;
  auto growing = std::make_unique<Growth>(settings, begin);
  RandomStream random(1, 0, 0, Purpose::start_position);
  for (bool is_finished = false; !is_finished;) {
    std::uint64_t looks = random.below(4);
    is_finished = growing->advance(cut, cut_counters, [&] { return looks-- > 0; });
    std::string const saved = to_checkpoint([&](Archive& archive) { growing->serialize(archive, cut); });
    growing = std::make_unique<Growth>(settings, begin);
    from_checkpoint(saved, "saved", [&](Archive& archive) { growing->serialize(archive, cut); });
  }
  EXPECT_EQ(hash(whole), hash(cut));
  EXPECT_EQ(whole_counters.moves, cut_counters.moves);
  EXPECT_EQ(whole_counters.pair_virial, cut_counters.pair_virial);
}

TEST_P(GrowthProperty, PredictsTheSameBitsWithEveryKernel) {
  State const state = start(2);
  exact::Dynamics dynamics(state, growth());
  Counters counters;
  for (std::uint64_t n = 1; n <= 40; ++n) {
    // A cell may come to hold too many small disks.
    if (!reference::compare_kernels(dynamics)) GTEST_SKIP() << "not in so small a box";
    grow(dynamics, last_scale(state), n * disks(), counters);
  }
}

GrowthSettings settings_of(State const& state, double rate) {
  // What density is far depends on the scene: twice the one now, or two thirds of the way to one.
  double const now = covered_area(state.agents) / state.box.area();
  return {.rate = rate, .packing_fraction = std::min(2.0 * now, 0.72), .pressure = 300.0, .audit_every = 23};
}

TEST_P(GrowthProperty, DependsOnlyOnIdsNotOnRows) {
  State const ordered = start(5);
  State a = ordered;
  State b = with_rows_shuffled(ordered, 1);
  Counters counters_a;
  Counters counters_b;
  GrowthSettings const settings = settings_of(ordered, 0.01);
  EXPECT_TRUE(Growth(settings, a).advance(a, counters_a));
  EXPECT_TRUE(Growth(settings, b).advance(b, counters_b));
  EXPECT_EQ(counters_a.pair_collisions, counters_b.pair_collisions);
  EXPECT_EQ(a.clock.time, b.clock.time);
  for (std::size_t i = 0; i < a.agents.size(); ++i) {
    std::size_t const row = b.agents.index_of(a.agents.ids()[i]);
    EXPECT_EQ(position(a.agents, i), position(b.agents, row));
    EXPECT_EQ(a.agents.column<Radius>()[i], b.agents.column<Radius>()[row]);
  }
}

TEST_P(GrowthProperty, HasTheSameBitsInterruptedSavedAndRestoredAnywhere) {
  for (std::uint64_t const seed : growth_seeds) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    State const begin = start(seed);
    GrowthSettings const settings = settings_of(begin, 0.01);
    State whole = begin;
    Counters whole_counters;
    Growth growth_of_whole(settings, begin);
    ASSERT_TRUE(growth_of_whole.advance(whole, whole_counters));

    State cut = begin;
    Counters cut_counters;
    auto growing = std::make_unique<Growth>(settings, begin);
    RandomStream random(seed, 0, 0, Purpose::start_position);
    for (bool is_finished = false; !is_finished;) {
      // Asked after each audit: the moment is a collision at random.
      std::uint64_t looks = random.below(1 + disks() / 2);
      is_finished = growing->advance(cut, cut_counters, [&] { return looks-- > 0; });
      EXPECT_LE(largest_overlap(cut), rounding_of_contact(cut));
      std::string const saved = to_checkpoint([&](Archive& archive) { growing->serialize(archive, cut); });
      growing = std::make_unique<Growth>(settings, begin);
      from_checkpoint(saved, "saved", [&](Archive& archive) { growing->serialize(archive, cut); });
    }
    EXPECT_EQ(hash(whole), hash(cut));
    EXPECT_EQ(whole_counters.pair_collisions, cut_counters.pair_collisions);
    EXPECT_EQ(whole_counters.moves, cut_counters.moves);
    EXPECT_EQ(whole_counters.pair_virial, cut_counters.pair_virial);
    EXPECT_EQ(whole_counters.wall_impulse, cut_counters.wall_impulse);
    EXPECT_EQ(growth_of_whole.reduced_pressure(), growing->reduced_pressure());
    EXPECT_EQ(growth_of_whole.collisions(), growing->collisions());
  }
}

TEST_P(GrowthProperty, LeavesAStateThatEveryEngineStartsFrom) {
  State state = start(7);
  double const kt = *temperature(state);
  Counters counters;
  GrowthSettings const settings = settings_of(state, 0.01);
  Growth growth(settings, state);
  ASSERT_TRUE(growth.advance(state, counters));
  EXPECT_GT(counters.pair_collisions, 0U);
  EXPECT_LE(largest_overlap(state), rounding_of_contact(state));
  EXPECT_NEAR(*temperature(state), kt, 1e-12 * kt);
  if (covered_area(state.agents) / state.box.area() < *settings.packing_fraction * (1.0 - 1e-12)) {
    EXPECT_GE(*growth.reduced_pressure(), *settings.pressure);
  }
  for (std::string const& kind : reference::hard_engine_kinds())
    EXPECT_NO_THROW(make_engine({.kind = kind}, state)) << kind;
}

}  // namespace
}  // namespace gridlock
