// The engine `stepped` on the packed grid takes the same turns as on the paper's lists, to the last bit.

#include "engine/packed_turns.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "engine/hot_disks.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/grid/detail/packed_layout.hpp"
#include "gridlock/lattice/start.hpp"
#include "reference/random_scene.hpp"

namespace gridlock {
namespace {

using reference::random_scene;
using reference::SceneSettings;

struct PackedSystem {
  SceneSettings scene;
  EngineSettings engine;
  /// Some disks much faster than the rest, so that cells are not made for them.
  double fastest = 1.0;
};

PackedSystem any_packed_system(std::uint64_t seed) {
  RandomStream random(seed, 0, 0, Purpose::start_position);
  PackedSystem s;
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
              .contact = random.below(2) == 0 ? CollisionRule::always : CollisionRule::approaching};
  s.engine.cells = 1 + random.below(20);
  s.fastest = random.below(3) == 0 ? 8.0 : 1.0;
  if (random.below(2) == 0) s.scene.edge_y = random.below(2) == 0 ? Edge::wall : Edge::periodic;
  return s;
}

TEST(PackedTurns, GiveTheBitsOfTheListsForFiveHundredRandomSystems) {
  int with_collisions = 0;
  int failed = 0;
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    PackedSystem const s = any_packed_system(seed);
    State linked = random_scene(s.scene);
    for (std::size_t i = 0; i < linked.agents.size(); i += 7) linked.agents.column<VelocityX>()[i] *= s.fastest;
    State packed = linked;
    EngineSettings settings = s.engine;
    std::string failure;
    Counters linked_counters;
    Counters packed_counters;
    try {
      settings.grid = GridKind::linked;
      make_engine(settings, linked)->advance(linked, linked_counters, {.step = 120});
    } catch (std::exception const& error) {
      failure = error.what();
      ++failed;
    }
    try {
      settings.grid = GridKind::packed;
      make_engine(settings, packed)->advance(packed, packed_counters, {.step = 120});
      ASSERT_EQ(failure, "") << "seed " << seed << ": " << s.scene;
    } catch (std::exception const& error) {
      ASSERT_EQ(failure, error.what()) << "seed " << seed << ": " << s.scene;
    }
    ASSERT_EQ(hash(linked), hash(packed)) << "seed " << seed << ": " << s.scene;
    ASSERT_EQ(linked_counters.moves, packed_counters.moves);
    ASSERT_EQ(linked_counters.halted_moves, packed_counters.halted_moves);
    ASSERT_EQ(linked_counters.pair_collisions, packed_counters.pair_collisions);
    ASSERT_EQ(linked_counters.wall_hits, packed_counters.wall_hits);
    ASSERT_EQ(linked_counters.wall_impulse, packed_counters.wall_impulse);
    ASSERT_EQ(linked_counters.pair_virial, packed_counters.pair_virial);
    if (linked_counters.pair_collisions > 50) ++with_collisions;
  }
  EXPECT_GT(with_collisions, 250) << "most systems must do something";
  EXPECT_LT(failed, 100);
}

TEST(PackedTurns, GiveTheBitsOfTheListsAtThePapersSize) {
  for (double const packing_fraction : {0.1, 0.4, 0.7, 0.785, 0.84}) {
    State linked = make_start(Box(1.25, 0.8, Edge::wall),
                              {.count = 841, .packing_fraction = packing_fraction, .start = StartKind::triangular}, 3);
    draw_velocities(linked, {});
    State packed = linked;
    Counters counters;
    Counters packed_counters;
    make_engine({.grid = GridKind::linked}, linked)->advance(linked, counters, {.step = 300});
    make_engine({.grid = GridKind::packed}, packed)->advance(packed, packed_counters, {.step = 300});
    EXPECT_EQ(hash(linked), hash(packed)) << packing_fraction;
    EXPECT_EQ(counters.pair_virial, packed_counters.pair_virial);
    EXPECT_LT(packed_counters.distance_checks, counters.distance_checks / 5) << "the filter does not filter";
  }
}

/// The disks of a state with what their turns need.
struct Hot {
  Hot(State const& state, EngineSettings const& settings, CellLayout const& layout)
      : box(state.box),
        duration(step_duration(settings, state)),
        disks(state, rows_in_order(state.agents.ids())),
        view(disks.view(box, settings, duration)),
        grid(grid_of<PackedGrid>(layout, disks)),
        turns(view, grid, radius_range(state.agents), duration) {}

  /// Turns of these rows, the first of which are others that have had theirs.
  void take(TakeBatch take_batch, std::vector<std::uint32_t> const& rows) { take(turns, take_batch, rows); }
  void take(PackedTurns& some, TakeBatch take_batch, std::vector<std::uint32_t> rows) {
    constexpr std::size_t first = 3;
    std::size_t const count = rows.size();
    rows.insert(rows.begin(), first, 0);
    rows.resize(rows.size() + PackedTurns::read_behind, 0);
    std::vector<PackedGrid::Block*> blocks;
    std::vector<std::uint8_t> slots;
    std::vector<std::uint8_t> places;
    for (std::uint32_t const row : rows) {
      blocks.push_back(&grid.block_of(row));
      slots.push_back(static_cast<std::uint8_t>(grid.slot_of(row)));
      places.push_back(static_cast<std::uint8_t>(places.size() / 2 % 3));
    }
    take_batch(some,
               {.rows = rows.data(),
                .blocks = blocks.data(),
                .slots = slots.data(),
                .places = places.data(),
                .results = results.data()},
               first, count);
  }

  Box box;
  double duration;
  HotDisks disks;
  TurnView view;
  PackedGrid grid;
  PackedTurns turns;
  /// Turns leave behind three results in turns, as those of three tiles do.
  std::array<TurnResult, 3> result{};
  std::array<TurnResult*, 3> results{&result[0], &result[1], &result[2]};
};

CellLayout half_as_many(Box const& box, CellLayout const& layout) {
  auto const half = [](int cells) { return static_cast<std::uint64_t>(std::max(1, cells / 2)); };
  return {box, half(layout.columns()), half(layout.rows())};
}

/// Rows, in any order, that have no common neighbour with an earlier one.
std::vector<std::uint32_t> rows_apart(Hot const& hot, std::size_t most, RandomStream& random) {
  CellLayout const& layout = hot.grid.layout();
  auto const are_apart = [](int a, int b, int cells, bool is_periodic) {
    int const between = std::abs(a - b);
    return between > 2 && (!is_periodic || cells - between > 2);
  };
  std::vector<std::uint32_t> rows;
  for (int trial = 0; trial < 60 && rows.size() < most; ++trial) {
    auto const i = static_cast<std::uint32_t>(random.below(hot.disks.size()));
    PackedGrid::Block const& home = hot.grid.block_of(i);
    bool const is_apart = std::ranges::all_of(rows, [&](std::uint32_t j) {
      PackedGrid::Block const& other = hot.grid.block_of(j);
      return are_apart(home.column, other.column, layout.columns(), layout.is_periodic_x()) ||
             are_apart(home.row, other.row, layout.rows(), layout.is_periodic_y());
    });
    if (is_apart) rows.push_back(i);
  }
  return rows;
}

/// Kernels take groups of a random system one after the other.
class TakenTogether : public testing::TestWithParam<Target> {
 protected:
  void SetUp() override {
    // No machine has the instructions of all processors: those that this one lacks are tested on others.
    if (!is_available(GetParam())) GTEST_SKIP() << "this processor has no " << to_text(GetParam());
  }
};

INSTANTIATE_TEST_SUITE_P(Targets, TakenTogether,
                         testing::Values(Target::sse4, Target::neon, Target::avx2, Target::avx512),
                         [](auto const& target) { return to_text(target.param); });

TEST_P(TakenTogether, AreTheSameAsOneByOne) {
  TakeBatch const take_batch = batch_kernel(GetParam());
  ASSERT_NE(take_batch, take_batch_scalar);
  std::uint64_t collisions = 0;
  std::uint64_t left_out = 0;
  std::size_t with_further_blocks = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    PackedSystem s = any_packed_system(seed);
    s.scene.count += 100;
    State state = random_scene(s.scene);
    for (std::size_t i = 0; i < state.agents.size(); i += 7) state.agents.column<VelocityX>()[i] *= s.fastest;
    CellLayout layout = packed_layout(state.box, state.agents, 0.3 * radius_range(state.agents).smallest);
    // Cells of twice the size hold more disks than a block.
    if (seed % 3 == 0) layout = half_as_many(state.box, layout);
    Hot plain(state, s.engine, layout);
    Hot wide(state, s.engine, layout);
    RandomStream random(seed, 1, 0, Purpose::start_position);
    for (int group = 0; group < 300; ++group) {
      auto const rows = rows_apart(plain, 1 + random.below(PackedTurns::largest_batch), random);
      plain.take(take_batch_scalar, rows);
      wide.take(take_batch, rows);
    }
    for (std::size_t i = 0; i < state.agents.size(); ++i) {
      DiskInTurn const& a = plain.disks[i];
      DiskInTurn const& b = wide.disks[i];
      ASSERT_EQ(a.position, b.position) << "seed " << seed << ", disk " << i << ": " << s.scene;
      ASSERT_EQ(a.velocity, b.velocity) << "seed " << seed << ", disk " << i << ": " << s.scene;
      ASSERT_EQ(a.image_x, b.image_x);
      ASSERT_EQ(a.image_y, b.image_y);
      if (plain.grid.block_of(i).next != PackedGrid::none) ++with_further_blocks;
    }
    ASSERT_TRUE(wide.grid.is_consistent()) << "seed " << seed;
    Counters plain_sum;
    Counters wide_sum;
    for (std::size_t k = 0; k < plain.result.size(); ++k) {
      // Sums of floating-point numbers are those of each result, whole numbers those of all.
      ASSERT_EQ(plain.result[k].counters.wall_impulse, wide.result[k].counters.wall_impulse);
      ASSERT_EQ(plain.result[k].counters.pair_virial, wide.result[k].counters.pair_virial);
      ASSERT_EQ(plain.result[k].not_local, wide.result[k].not_local);
      add(plain_sum, plain.result[k].counters);
      add(wide_sum, wide.result[k].counters);
      left_out += plain.result[k].not_local.size();
    }
    ASSERT_EQ(plain_sum.moves, wide_sum.moves);
    ASSERT_EQ(plain_sum.halted_moves, wide_sum.halted_moves);
    ASSERT_EQ(plain_sum.pair_collisions, wide_sum.pair_collisions);
    ASSERT_EQ(plain_sum.distance_checks, wide_sum.distance_checks);
    collisions += plain_sum.pair_collisions;
  }
  EXPECT_GT(collisions, 20'000U) << "most groups must do something";
  EXPECT_GT(left_out, 1'000U);
  EXPECT_GT(with_further_blocks, 1'000U);
}

TEST_P(TakenTogether, ChooseTheLowerIdOfTwoDisksAsNear) {
  TakeBatch const take_batch = batch_kernel(GetParam());
  // Disks that come exactly between two others, above and below, which they meet in the same sub-step; in every second
  // triple the one above comes first. All numbers are sums of few powers of two.
  State state{.box = Box(64.0, 8.0, Edge::wall)};
  std::vector<std::uint32_t> rows;
  for (int k = 0; k < 14; ++k) {
    double const x = 4.25 + 4.0 * k;
    double const up = k % 2 == 0 ? 0.5625 : -0.5625;
    rows.push_back(static_cast<std::uint32_t>(state.agents.size()));
    state.agents.add(x, 4.0, 0.5, 0.0, 0.5, 1.0, 0, 0);
    state.agents.add(x + 1.0, 4.0 + up, 0.0, 0.0, 0.5, 1.0, 0, 0);
    state.agents.add(x + 1.0, 4.0 - up, 0.0, 0.0, 0.5, 1.0, 0, 0);
  }
  EngineSettings const settings{.time_step = 1.0, .substeps = 4};
  Hot hot(state, settings, packed_layout(state.box, state.agents, 0.5));
  hot.duration = 1.0;
  hot.view.substep = 0.25;
  PackedTurns turns(hot.view, hot.grid, radius_range(state.agents), hot.duration);
  hot.take(turns, take_batch, rows);
  std::uint64_t collisions = 0;
  for (TurnResult const& result : hot.result) collisions += result.counters.pair_collisions;
  EXPECT_EQ(collisions, rows.size());
  for (std::uint32_t const row : rows) {
    EXPECT_NE(hot.disks[row + 1].velocity, (Vector{0.0, 0.0})) << "the first of two disks as near as each other";
    EXPECT_EQ(hot.disks[row + 2].velocity, (Vector{0.0, 0.0}));
  }
}

TEST(PackedLayout, HoldsAtMostFourEqualDisksInACellAndTheWholeCutoffInABlock) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    RandomStream random(seed, 0, 0, Purpose::start_position);
    State const state = random_scene({.edge = seed % 2 == 0 ? Edge::wall : Edge::periodic,
                                      .width = 0.5 + random.uniform(),
                                      .height = 0.5 + random.uniform(),
                                      .count = 20 + random.below(100),
                                      .packing_fraction = 0.3 + 0.4 * random.uniform(),
                                      .seed = seed});
    double const sigma = 2.0 * radius_range(state.agents).largest;
    CellLayout const layout = packed_layout(state.box, state.agents, 0.2 * sigma);
    double const cutoff = 1.2 * sigma;
    bool const is_small = layout.columns() <= 3 || layout.rows() <= 3;
    if (!is_small) {
      EXPECT_GE(std::min(layout.cell_width(), layout.cell_height()), cutoff) << "seed " << seed;
    }
    PackedGrid const grid(layout, state.agents.column<X>(), state.agents.column<Y>());
    if (std::max(layout.cell_width(), layout.cell_height()) > widest_for_four(0.5 * sigma)) continue;
    for (std::size_t i = 0; i < state.agents.size(); ++i) {
      EXPECT_EQ(grid.block_of(i).next, PackedGrid::none) << "seed " << seed;
    }
  }
}

}  // namespace
}  // namespace gridlock
