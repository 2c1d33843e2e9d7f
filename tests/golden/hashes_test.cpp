// The bits of a few runs, for ever: the same on every compiler, in debug and release. A difference is either a mistake
// or a change of the physics that belongs in the change log. To accept the bits of this build, run
//
//     GRIDLOCK_WRITE_GOLDEN=1 build/tests/gridlock_golden_tests
//
// and commit tests/golden/hashes.csv with the reason.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <ostream>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "golden/scenes.hpp"
#include "golden/table.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/grid/validate.hpp"
#include "gridlock/simulation/setup.hpp"
#include "reference/hard_engines.hpp"
#include "state_on_ranks.hpp"

namespace gridlock {
namespace {

using golden::Scene;
using golden::scenes;

/// Settings that must not change a bit.
struct Variant {
  std::uint64_t threads = 0;
  GridKind grid = GridKind::packed;
  std::size_t ranks = 1;
  Device device = Device::cpu;
};

/// Returns the variants of an engine, the plain one first. What else is in the list does not depend on instructions,
/// so that one other number of threads is enough where those of another processor are asked for.
std::vector<Variant> variants_of(std::string const& engine) {
  if (std::getenv("GRIDLOCK_TARGET") != nullptr) return {{.threads = 1}, {.threads = 3}};
  if (engine == "tiled") {
    std::vector<Variant> tiled{
        {.threads = 1}, {.threads = 2}, {.threads = 3}, {.threads = 8}, {.threads = 1, .ranks = 3}};
    for (std::uint64_t const threads : {1, 3}) {
      if (find_device()) tiled.push_back({.threads = threads, .device = Device::gpu});
    }
    return tiled;
  }
  if (engine == "stepped") return {{.grid = GridKind::packed}, {.grid = GridKind::linked}};
  return {{.threads = 1}, {.threads = 2}, {.threads = 3}};
}

Hashes run(Scene const& scene, std::string const& engine, Variant const& variant) {
  State state = golden::start_of(scene);
  std::string const start = golden::hash_text(state);
  EngineSettings settings = scene.engine;
  settings.kind = engine;
  settings.threads = variant.threads;
  settings.grid = variant.grid;
  settings.device = variant.device;
  Counters counters;
  test::ThreadRanks ranks(variant.ranks);
  test::advance_on_ranks(settings, ranks, state, counters, {.time = scene.time});
  bool const is_soft = engine_record(engine).has_potential;
  // Chains leave disks in contact.
  double const rounding = engine_record(engine).is_monte_carlo ? rounding_of_contact(state) : 0.0;
  EXPECT_NO_THROW(validate(state, {.overlap = is_soft ? std::numeric_limits<double>::infinity() : rounding}));
  EXPECT_GT(is_soft ? counters.moves : counters.pair_collisions, 0U)
      << "a scene in which nothing happens proves nothing";
  return {start, golden::hash_text(state)};
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
  for (std::vector<Scene> const& some : {scenes(), golden::scenes_of_channels()}) {
    for (Scene const& scene : some) {
      for (std::string const& engine : reference::hard_engine_kinds()) all.push_back({scene, engine});
    }
  }
  for (Scene const& scene : golden::scenes_of_exact()) all.push_back({scene, "exact"});
  for (Scene const& scene : golden::scenes_of_active_disks()) {
    for (char const* const engine : {"stepped", "tiled"}) all.push_back({scene, engine});
  }
  for (Scene const& scene : golden::scenes_of_chains()) all.push_back({scene, "event_chain"});
  for (Scene const& scene : golden::scenes_of_soft_disks()) all.push_back({scene, "soft"});
  return all;
}

class Golden : public testing::TestWithParam<Row> {};

TEST_P(Golden, GivesTheBitsOfTheTable) {
  Row const row = GetParam();
  std::vector<Variant> const variants = variants_of(row.engine);
  Hashes const now = run(row.scene, row.engine, variants.front());
  for (Variant const& variant : std::span(variants).subspan(1)) {
    EXPECT_EQ(run(row.scene, row.engine, variant).end, now.end)
        << variant.threads << " threads, " << variant.ranks << " ranks, grid " << static_cast<int>(variant.grid)
        << ", device " << static_cast<int>(variant.device);
  }
  HashTable("hashes.csv").expect({row.scene.name, row.engine}, now);
}

std::string row_name(testing::TestParamInfo<Row> const& row) { return row.param.scene.name + "_" + row.param.engine; }
INSTANTIATE_TEST_SUITE_P(Scenes, Golden, testing::ValuesIn(rows()), row_name);

/// Scenes of a protocol alone: no engine moves the disks after it.
constexpr std::array<char const*, 3> protocols{"jamming", "shear", "shear_stable"};

TEST(GoldenProtocol, OfEachSceneGivesTheBitsOfTheTable) {
  for (char const* const scene : protocols) {
    auto const setup = set_up(SettingsFile::from_path(fmt::format("{}/scenes/{}.toml", GRIDLOCK_SOURCE_DIR, scene)));
    std::string const start = fmt::format("{:016x}", setup.simulation->state_hash());
    ASSERT_TRUE(setup.simulation->prepare({}));
    HashTable("hashes.csv")
        .expect({scene, "protocol"}, {start, fmt::format("{:016x}", setup.simulation->state_hash())});
  }
}

TEST(GoldenTable, HasNoRowsOfScenesOrEnginesThatAreGone) {
  std::set<HashTable::Name> known;
  for (Row const& row : rows()) known.emplace(row.scene.name, row.engine);
  for (char const* const scene : protocols) known.emplace(scene, "protocol");
  HashTable("hashes.csv").expect_only(known);
}

}  // namespace
}  // namespace gridlock
