// The engine `stepped` on the packed grid takes the same turns as on the paper's lists, to the last bit.

#include "engine/packed_turns.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>

#include "gridlock/core/error.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/lattice/start.hpp"
#include "reference/random_scene.hpp"

namespace gridlock {
namespace {

using reference::random_scene;
using reference::SceneSettings;

struct System {
  SceneSettings scene;
  EngineSettings engine;
  /// Some disks much faster than the rest, so that cells are not made for them.
  double fastest = 1.0;
};

System any_system(std::uint64_t seed) {
  RandomStream random(seed, 0, 0, Purpose::start_position);
  System s;
  s.scene = {.edge = random.below(2) == 0 ? Edge::wall : Edge::periodic,
             .width = 0.3 + 3.0 * random.uniform(),
             .height = 0.3 + 3.0 * random.uniform(),
             .count = 1 + random.below(150),
             .packing_fraction = random.below(3) == 0 ? 0.02 : 0.1 + 0.65 * random.uniform(),
             .smallest_ratio = random.below(2) == 0 ? 1.0 : 0.1 + 0.9 * random.uniform(),
             .heaviest_mass = random.below(2) == 0 ? 1.0 : 20.0,
             .seed = seed};
  s.engine = {.time_step = 0.02 + 0.4 * random.uniform(),
              .substeps = 1 + random.below(8),
              .contact = random.below(2) == 0 ? Contact::always : Contact::approaching};
  s.engine.cells = 1 + random.below(20);
  s.fastest = random.below(3) == 0 ? 8.0 : 1.0;
  return s;
}

TEST(PackedTurns, GiveTheBitsOfTheListsForFiveHundredRandomSystems) {
  int with_collisions = 0;
  int failed = 0;
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    System const s = any_system(seed);
    State linked = random_scene(s.scene);
    for (std::size_t i = 0; i < linked.disks.size(); i += 7) linked.disks.column<VelocityX>()[i] *= s.fastest;
    State packed = linked;
    EngineSettings settings = s.engine;
    std::string failure;
    Tally linked_tally;
    Tally packed_tally;
    try {
      settings.grid = GridKind::linked;
      make_engine(settings, linked)->advance(linked, linked_tally, {.step = 120});
    } catch (std::exception const& error) {
      failure = error.what();
      ++failed;
    }
    try {
      settings.grid = GridKind::packed;
      make_engine(settings, packed)->advance(packed, packed_tally, {.step = 120});
      ASSERT_EQ(failure, "") << "seed " << seed << ": " << s.scene;
    } catch (std::exception const& error) {
      ASSERT_EQ(failure, error.what()) << "seed " << seed << ": " << s.scene;
    }
    ASSERT_EQ(hash(linked), hash(packed)) << "seed " << seed << ": " << s.scene;
    ASSERT_EQ(linked_tally.turns, packed_tally.turns);
    ASSERT_EQ(linked_tally.blocked_turns, packed_tally.blocked_turns);
    ASSERT_EQ(linked_tally.pair_collisions, packed_tally.pair_collisions);
    ASSERT_EQ(linked_tally.wall_hits, packed_tally.wall_hits);
    ASSERT_EQ(linked_tally.wall_impulse, packed_tally.wall_impulse);
    ASSERT_EQ(linked_tally.pair_virial, packed_tally.pair_virial);
    if (linked_tally.pair_collisions > 50) ++with_collisions;
  }
  EXPECT_GT(with_collisions, 250) << "most systems must do something";
  EXPECT_LT(failed, 100);
}

TEST(PackedTurns, GiveTheBitsOfTheListsAtThePapersSize) {
  for (double const packing_fraction : {0.1, 0.4, 0.7, 0.785, 0.84}) {
    State linked = make_start(Box(1.0, 1.0, Edge::wall),
                              {.count = 841, .packing_fraction = packing_fraction, .start = StartKind::triangular}, 3);
    draw_velocities(linked, {});
    State packed = linked;
    Tally tally;
    Tally packed_tally;
    make_engine({.grid = GridKind::linked}, linked)->advance(linked, tally, {.step = 300});
    make_engine({.grid = GridKind::packed}, packed)->advance(packed, packed_tally, {.step = 300});
    EXPECT_EQ(hash(linked), hash(packed)) << packing_fraction;
    EXPECT_EQ(tally.pair_virial, packed_tally.pair_virial);
    EXPECT_LT(packed_tally.distance_checks, tally.distance_checks / 5) << "the filter does not filter";
  }
}

TEST(PackedLayout, HoldsAtMostFourEqualDisksInACellAndTheWholeReachInABlock) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    RandomStream random(seed, 0, 0, Purpose::start_position);
    State const state = random_scene({.edge = seed % 2 == 0 ? Edge::wall : Edge::periodic,
                                      .width = 0.5 + random.uniform(),
                                      .height = 0.5 + random.uniform(),
                                      .count = 20 + random.below(100),
                                      .packing_fraction = 0.3 + 0.4 * random.uniform(),
                                      .seed = seed});
    double const sigma = 2.0 * radius_range(state.disks).largest;
    CellLayout const layout = packed_layout(state.box, state.disks, 0.2 * sigma);
    double const reach = 1.2 * sigma;
    bool const is_small = layout.columns() <= 3 || layout.rows() <= 3;
    if (!is_small) {
      EXPECT_GE(std::min(layout.cell_width(), layout.cell_height()), reach) << "seed " << seed;
    }
    PackedGrid const grid(layout, state.disks.column<X>(), state.disks.column<Y>());
    if (std::max(layout.cell_width(), layout.cell_height()) > widest_for_four(0.5 * sigma)) continue;
    for (std::size_t i = 0; i < state.disks.size(); ++i) {
      EXPECT_EQ(grid.block_of(i).next, PackedGrid::none) << "seed " << seed;
    }
  }
}

}  // namespace
}  // namespace gridlock
