// The trajectory is a matter of the rule alone, not of the grid, of rows or of chunks: same bits.

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "gridlock/core/random.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/grid/validate.hpp"
#include "reference/all_pairs.hpp"
#include "reference/paper_rule.hpp"
#include "reference/random_scene.hpp"

namespace gridlock {
namespace {

using reference::random_scene;
using reference::SceneSettings;

/// On k × k linked lists, or with the default cells of either grid.
void advance_with_cells(State& state, EngineSettings settings, std::optional<std::uint64_t> cells, Counters& counters,
                        std::uint64_t steps) {
  settings.cells = cells;
  make_engine(settings, state)->advance(state, counters, {.step = state.clock.step + steps});
}

/// Everything that does not depend on which disks were looked at.
void expect_same_counters(Counters const& a, Counters const& b) {
  EXPECT_EQ(a.moves, b.moves);
  EXPECT_EQ(a.halted_moves, b.halted_moves);
  EXPECT_EQ(a.pair_collisions, b.pair_collisions);
  EXPECT_EQ(a.wall_hits, b.wall_hits);
  EXPECT_EQ(a.wall_impulse, b.wall_impulse);
  EXPECT_EQ(a.pair_virial, b.pair_virial);
}

struct GridCase {
  std::string name;
  SceneSettings scene;
  CollisionRule contact = CollisionRule::always;
  double time_step = 0.1;
  std::uint64_t substeps = 5;

  friend std::ostream& operator<<(std::ostream& out, GridCase const& c) {
    return out << c.scene << ", time step " << c.time_step << ", sub-steps " << c.substeps
               << (c.contact == CollisionRule::always ? ", always" : ", approaching");
  }
};

std::vector<GridCase> grid_cases() {
  SceneSettings const dense{.count = 81, .packing_fraction = 0.7};
  SceneSettings const mixture{
      .width = 1.7, .height = 0.9, .count = 60, .packing_fraction = 0.5, .smallest_ratio = 0.3, .heaviest_mass = 5.0};
  std::vector<GridCase> all{
      {.name = "dense", .scene = dense},
      {.name = "dense_approaching", .scene = dense, .contact = CollisionRule::approaching},
      {.name = "mixture", .scene = mixture},
      // Several cells of the finer grids in one step, so that the block must widen.
      {.name = "long_steps", .scene = {.count = 30, .packing_fraction = 0.1}, .time_step = 2.0, .substeps = 6},
      {.name = "one_substep", .scene = mixture, .time_step = 0.3, .substeps = 1},
      {.name = "gas", .scene = {.count = 40, .packing_fraction = 0.02}, .time_step = 0.5},
  };
  std::size_t const walled = all.size();
  for (std::size_t n = 0; n < walled; ++n) {
    all.push_back(all[n]);
    all.back().name += "_periodic";
    all.back().scene.edge = Edge::periodic;
  }
  return all;
}

class SteppedCase : public testing::TestWithParam<GridCase> {
 protected:
  [[nodiscard]] EngineSettings settings() const {
    return {.time_step = GetParam().time_step, .substeps = GetParam().substeps, .contact = GetParam().contact};
  }
};

using SteppedGrid = SteppedCase;

TEST_P(SteppedGrid, GivesTheBitsOfAllPairsForEveryNumberOfCells) {
  constexpr std::uint64_t steps = 200;
  State const start = random_scene(GetParam().scene);
  ASSERT_NO_THROW(validate(start)) << "the scene itself is broken";
  State expected = start;
  Counters expected_counters;
  reference::advance_all_pairs(expected, settings(), expected_counters, steps);
  ASSERT_GT(expected_counters.pair_collisions, 20U) << "nothing happens in this scene";
  for (std::optional<std::uint64_t> const cells :
       {std::optional<std::uint64_t>{}, {1}, {2}, {3}, {5}, {10}, {20}, {57}}) {
    SCOPED_TRACE(cells ? "k = " + std::to_string(*cells) : "default cells");
    for (GridKind const grid : {GridKind::linked, GridKind::packed}) {
      if (cells && grid == GridKind::packed) continue;
      SCOPED_TRACE(grid == GridKind::linked ? "linked" : "packed");
      EngineSettings on_grid = settings();
      on_grid.grid = grid;
      State state = start;
      Counters counters;
      advance_with_cells(state, on_grid, cells, counters, steps);
      EXPECT_EQ(hash(state), hash(expected));
      expect_same_counters(counters, expected_counters);
      EXPECT_LE(counters.distance_checks, expected_counters.distance_checks);
    }
  }
}

using SteppedRule = SteppedCase;

TEST_P(SteppedRule, GivesTheBitsOfTheRuleWrittenASecondTime) {
  constexpr std::uint64_t steps = 200;
  State state = random_scene(GetParam().scene);
  auto const engine = make_engine(settings(), state);
  reference::PaperRule rule(state, engine->time_step(), static_cast<int>(GetParam().substeps),
                            GetParam().contact == CollisionRule::always);
  Counters counters;
  for (std::uint64_t step = 1; step <= steps; ++step) {
    engine->advance(state, counters, {.step = step});
    rule.step();
    for (reference::PaperRule::Disk const& disk : rule.disks) {
      std::size_t const row = state.agents.index_of(disk.id);
      ASSERT_EQ(position(state.agents, row), (Vector{disk.x, disk.y})) << "disk " << disk.id << " at step " << step;
      ASSERT_EQ(velocity(state.agents, row), (Vector{disk.vx, disk.vy})) << "disk " << disk.id << " at step " << step;
      ASSERT_EQ(state.agents.column<ImageX>()[row], disk.image_x);
      ASSERT_EQ(state.agents.column<ImageY>()[row], disk.image_y);
    }
  }
  EXPECT_EQ(counters.moves, steps * state.agents.size());
  EXPECT_EQ(counters.halted_moves, rule.halted_moves);
  EXPECT_EQ(counters.pair_collisions, rule.pair_collisions);
  EXPECT_EQ(counters.wall_hits, rule.wall_hits);
  EXPECT_NEAR(counters.pair_virial, rule.pair_virial, 1e-12 * (std::abs(rule.pair_virial) + 1.0));
}

auto const case_name = [](testing::TestParamInfo<GridCase> const& info) { return info.param.name; };
INSTANTIATE_TEST_SUITE_P(Scenes, SteppedGrid, testing::ValuesIn(grid_cases()), case_name);
INSTANTIATE_TEST_SUITE_P(Scenes, SteppedRule, testing::ValuesIn(grid_cases()), case_name);

TEST(SteppedStress, ThreeHundredTinySystemsOfAFewCellsGiveTheBitsOfAllPairs) {
  RandomStream random(2024, 0, 0, Purpose::start_position);
  for (int n = 0; n < 300; ++n) {
    SceneSettings const scene{.edge = n % 2 == 0 ? Edge::wall : Edge::periodic,
                              .width = 0.3 + random.uniform(),
                              .height = 0.3 + random.uniform(),
                              .count = 1 + random.below(8),
                              .packing_fraction = 0.05 + 0.6 * random.uniform(),
                              .smallest_ratio = 0.2 + 0.8 * random.uniform(),
                              .heaviest_mass = 1.0 + 9.0 * random.uniform(),
                              .seed = static_cast<std::uint64_t>(n)};
    EngineSettings settings{.time_step = 0.02 + 0.5 * random.uniform(),
                            .substeps = 1 + random.below(8),
                            .contact = random.below(2) == 0 ? CollisionRule::always : CollisionRule::approaching};
    // 1–3 cells of the default layout in most of these boxes, and of these settings in all.
    if (random.below(2) == 0) settings.cells = 1 + random.below(3);
    settings.grid = n % 4 < 2 ? GridKind::linked : GridKind::packed;
    State const start = random_scene(scene);
    State state = start;
    State expected = start;
    Counters counters;
    Counters expected_counters;
    advance_with_cells(state, settings, settings.cells, counters, 300);
    reference::advance_all_pairs(expected, settings, expected_counters, 300);
    ASSERT_EQ(hash(state), hash(expected))
        << "system " << n << ": " << scene << ", time step " << settings.time_step << ", sub-steps "
        << settings.substeps << ", cells " << static_cast<int>(settings.cells.value_or(0))
        << (settings.grid == GridKind::linked ? ", linked" : ", packed");
    expect_same_counters(counters, expected_counters);
    ASSERT_NO_THROW(validate(state)) << "system " << n << ": " << scene;
  }
}

TEST(SteppedRows, TheOrderOfTheRowsDoesNotMatter) {
  State const plain =
      random_scene({.edge = Edge::periodic, .count = 50, .packing_fraction = 0.5, .heaviest_mass = 2.0});
  State reversed{.box = plain.box, .clock = plain.clock, .seed = plain.seed};
  for (std::size_t row = plain.agents.size(); row-- > 0;) {
    Vector const p = position(plain.agents, row);
    Vector const v = velocity(plain.agents, row);
    ASSERT_TRUE(reversed.agents.add_as(plain.agents.ids()[row], p.x, p.y, v.x, v.y, plain.agents.column<Radius>()[row],
                                       plain.agents.column<Mass>()[row], 0, 0));
  }
  State forward = plain;
  Counters counters;
  Counters reversed_counters;
  advance_with_cells(forward, {}, {}, counters, 300);
  advance_with_cells(reversed, {}, {}, reversed_counters, 300);
  EXPECT_EQ(hash(forward), hash(reversed));
  EXPECT_EQ(counters.pair_collisions, reversed_counters.pair_collisions);
}

}  // namespace
}  // namespace gridlock
