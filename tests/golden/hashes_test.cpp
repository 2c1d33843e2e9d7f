// The bits of a few runs, for ever: the same on every compiler, in debug and release. A difference is either a mistake or
// a change of the physics that belongs in the change log. To accept the bits of this build, run
//
//     GRIDLOCK_WRITE_GOLDEN=1 build/tests/gridlock_golden_tests
//
// and commit tests/golden/hashes.csv with the reason.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <ostream>
#include <set>
#include <string>
#include <vector>

#include "golden/table.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/grid/validate.hpp"
#include "gridlock/lattice/start.hpp"
#include "gridlock/simulation/setup.hpp"

namespace gridlock {
namespace {

struct Scene {
  std::string name;
  Box box;
  DisksSettings disks;
  VelocitySettings velocities;
  EngineSettings engine;
  double time = 1.0;
};

std::vector<Scene> scenes() {
  Box const walls(1.0, 1.0, Edge::wall);
  Box const periodic(1.0, 1.0, Edge::periodic);
  return {
      {.name = "paper",
       .box = walls,
       .disks = {.count = 841, .packing_fraction = 0.7},
       .engine = {.cells = 10},
       .time = 0.5},
      {.name = "triangular",
       .box = walls,
       .disks = {.count = 400, .packing_fraction = 0.8, .start = StartKind::triangular},
       .engine = {.contact = CollisionRule::approaching}},
      {.name = "mixture",
       .box = periodic,
       .disks = {.count = 200,
                 .packing_fraction = 0.4,
                 .start = StartKind::random,
                 .species = {{.fraction = 0.5}, {.fraction = 0.5, .size_ratio = 1.4, .mass = 1.96}}},
       .velocities = {.kind = VelocityKind::maxwell}},
      {.name = "rectangle",
       .box = Box(3.0, 0.7, Edge::periodic),
       .disks = {.count = 150, .packing_fraction = 0.6, .start = StartKind::triangular},
       .engine = {.time_step = 0.3, .substeps = 2}},
      {.name = "gas", .box = walls, .disks = {.count = 100, .packing_fraction = 0.02}, .time = 10.0},
      {.name = "few", .box = periodic, .disks = {.count = 4, .packing_fraction = 0.4}, .time = 20.0},
      // Enough disks for many tiles of each colour; in the second one some cells hold more disks than a block.
      {.name = "crowd",
       .box = walls,
       .disks = {.count = 10'000, .packing_fraction = 0.65, .start = StartKind::triangular},
       .time = 0.05},
      {.name = "large_and_small",
       .box = periodic,
       .disks = {.count = 4'000,
                 .packing_fraction = 0.3,
                 .start = StartKind::random,
                 .species = {{.fraction = 0.9}, {.fraction = 0.1, .size_ratio = 4.0, .mass = 16.0}}},
       .time = 0.05},
  };
}

constexpr std::uint64_t seed = 20;

/// Settings that must not change a bit.
struct Variant {
  std::uint64_t threads = 0;
  GridKind grid = GridKind::packed;
};

std::vector<Variant> variants_of(std::string const& engine) {
  if (engine == "tiled") return {{.threads = 1}, {.threads = 2}, {.threads = 3}, {.threads = 8}};
  if (engine == "stepped") return {{.grid = GridKind::packed}, {.grid = GridKind::linked}};
  return {{}};
}

Hashes run(Scene const& scene, std::string const& engine, Variant const& variant) {
  State state = make_start(scene.box, scene.disks, seed);
  draw_velocities(state, scene.velocities);
  std::string const start = fmt::format("{:016x}", hash(state));
  EngineSettings settings = scene.engine;
  settings.kind = engine;
  settings.threads = variant.threads;
  settings.grid = variant.grid;
  Counters counters;
  make_engine(settings, state)->advance(state, counters, {.time = scene.time});
  EXPECT_NO_THROW(validate(state));
  EXPECT_GT(counters.pair_collisions, 0U) << "a scene in which nothing happens proves nothing";
  return {start, fmt::format("{:016x}", hash(state))};
}

struct Row {
  Scene scene;
  std::string engine;

  friend std::ostream& operator<<(std::ostream& out, Row const& row) {
    return out << row.scene.name << " " << row.engine;
  }
};

std::vector<Row> rows() {
  std::vector<Row> all;
  for (Scene const& scene : scenes()) {
    for (std::string const& engine : engine_kinds()) all.push_back({scene, engine});
  }
  return all;
}

class Golden : public testing::TestWithParam<Row> {};

TEST_P(Golden, GivesTheBitsOfTheTable) {
  Row const row = GetParam();
  std::vector<Variant> const variants = variants_of(row.engine);
  Hashes const now = run(row.scene, row.engine, variants.front());
  for (Variant const& variant : variants) {
    EXPECT_EQ(run(row.scene, row.engine, variant).end, now.end)
        << variant.threads << " threads, grid " << static_cast<int>(variant.grid);
  }
  HashTable("hashes.csv").expect({row.scene.name, row.engine}, now);
}

std::string row_name(testing::TestParamInfo<Row> const& row) { return row.param.scene.name + "_" + row.param.engine; }
INSTANTIATE_TEST_SUITE_P(Scenes, Golden, testing::ValuesIn(rows()), row_name);

/// Of a protocol alone: no engine moves the disks after it.
HashTable::Name const jamming{"jamming", "protocol"};

TEST(GoldenProtocol, OfTheSceneGivesTheBitsOfTheTable) {
  auto const setup = set_up(SettingsFile::from_path(std::string(GRIDLOCK_SOURCE_DIR) + "/scenes/jamming.toml"));
  std::string const start = fmt::format("{:016x}", setup.simulation->state_hash());
  ASSERT_TRUE(setup.simulation->prepare({}));
  HashTable("hashes.csv").expect(jamming, {start, fmt::format("{:016x}", setup.simulation->state_hash())});
}

TEST(GoldenTable, HasNoRowsOfScenesOrEnginesThatAreGone) {
  std::set<HashTable::Name> known;
  for (Row const& row : rows()) known.emplace(row.scene.name, row.engine);
  known.insert(jamming);
  HashTable("hashes.csv").expect_only(known);
}

}  // namespace
}  // namespace gridlock
