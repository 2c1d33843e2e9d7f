// Starts that processes share, here threads: the rows of one process, to the bit.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "gridlock/lattice/start.hpp"
#include "gridlock/simulation/run.hpp"
#include "gridlock/simulation/setup.hpp"
#include "thread_ranks.hpp"

namespace gridlock {
namespace {

struct SharedStart {
  std::string name;
  DisksSettings disks;
};

std::vector<SharedStart> shared_starts() {
  SpeciesSettings const small{.fraction = 0.37, .size_ratio = 0.5, .mass = 0.25};
  SpeciesSettings const middle{.fraction = 0.43, .size_ratio = 1.0, .mass = 1.0};
  SpeciesSettings const large{.fraction = 0.2, .size_ratio = 1.3, .mass = 2.0};
  DisksSettings const sparse{.packing_fraction = 0.1};
  auto const with = [&](auto change) {
    DisksSettings disks = sparse;
    change(disks);
    return disks;
  };
  return {
      {"equal", sparse},
      {"one_species", with([&](auto& disks) { disks.species = {{.fraction = 1.0, .size_ratio = 2.0}}; })},
      {"two_species", with([&](auto& disks) {
         disks.species = {{.fraction = 0.8, .size_ratio = 1.0}, large};
       })},
      {"three_species", with([&](auto& disks) {
         disks.species = {small, middle, large};
       })},
      {"inverse_cube", with([&](auto& disks) { disks.sizes = SizeDistribution::inverse_cube; })},
      {"uniform_sizes", with([&](auto& disks) { disks.sizes = SizeDistribution::uniform; })},
      {"normal_by_radius", with([&](auto& disks) {
         disks.sizes = SizeDistribution::normal;
         disks.packing_fraction.reset();
         disks.radius = 1e-4;
       })},
  };
}

/// The hash of a start of `tiled`; `ranks` is 0 in one process.
std::uint64_t hash_of_start(DisksSettings const& disks, Edge edge, std::size_t ranks) {
  Configuration configuration;
  configuration.box = {.edge = edge, .width = 1.5, .height = 1.0};
  configuration.disks = disks;
  configuration.velocities.drift = Drift::remove;
  configuration.engine.kind = "tiled";
  configuration.run = {.steps = 0, .seed = 7};
  std::uint64_t hash = 0;
  auto const work = [&](AllProcesses processes) {
    Setup const setup = set_up(configuration, {.threads = 1, .processes = processes});
    std::uint64_t const of_all = setup.simulation->state_hash();
    if (processes.is_root()) hash = of_all;
  };
  ranks == 0 ? work({}) : test::ThreadRanks(ranks).run([&](Communicator& here) { work(here); });
  return hash;
}

TEST(SharedStart, HasTheRowsOfOneProcess) {
  for (auto [name, disks] : shared_starts()) {
    for (StartKind const start : {StartKind::square, StartKind::triangular, StartKind::random}) {
      disks.start = start;
      for (std::uint64_t const count : {1U, 7U, 2001U, 20'001U}) {
        disks.count = count;
        for (Edge const edge : {Edge::wall, Edge::periodic}) {
          std::uint64_t const expected = hash_of_start(disks, edge, 0);
          for (std::size_t const ranks : {1U, 3U, 8U}) {
            ASSERT_EQ(hash_of_start(disks, edge, ranks), expected)
                << name << ", " << count << " disks on " << ranks << " ranks";
          }
        }
      }
    }
  }
}

/// Of a start, and of the state after the steps of its run; `ranks` is 0 in one process.
std::vector<std::uint64_t> hashes_of_run(std::string const& text, std::size_t ranks) {
  std::vector<std::uint64_t> hashes;
  auto const work = [&](AllProcesses processes) {
    Setup const setup = set_up(SettingsFile::from_text(text, "run.toml"), {.threads = 1, .processes = processes});
    std::uint64_t const start = setup.simulation->state_hash();
    Run(*setup.simulation, plan_of(setup)).advance();
    std::uint64_t const end = setup.simulation->state_hash();
    if (processes.is_root()) hashes = {start, end};
  };
  if (ranks == 0) {
    work({});
  } else {
    test::ThreadRanks(ranks).run([&](Communicator& root) { work(root); });
  }
  return hashes;
}

TEST(SharedStart, GivesTheModelTheDisksOfTheEngine) {
  struct Scene {
    std::string count, edge, start;
  };
  std::vector<Scene> const scenes{{"3", "wall", "square"},    {"3", "periodic", "triangular"},
                                  {"2500", "wall", "square"}, {"2500", "periodic", "triangular"},
                                  {"2500", "wall", "random"}, {"6000", "periodic", "random"}};
  std::string const mixture = "species = [{ fraction = 0.3 }, { fraction = 0.7, size_ratio = 1.4, mass = 3.0 }]";
  for (std::string const kinds : {"sizes = \"equal\"", mixture.c_str(), "sizes = \"normal\", size_spread = 0.2"}) {
    for (auto const& [count, edge, start] : scenes) {
      std::string const disks =
          "disks = { count = " + count + ", packing_fraction = 0.3, start = \"" + start + "\", " + kinds + " }\n";
      std::string const velocities = "velocities.drift = \"remove\"\n";
      std::string const run = "run = { steps = 20, seed = 9 }\nbox.edge = \"" + edge + "\"\n";
      std::string const engine = run + "engine.kind = \"tiled\"\n" + disks + velocities;
      std::string const model =
          run + "model.kind = \"colloid_tiled\"\ncolloid_tiled." + disks + "colloid_tiled." + velocities;
      std::vector<std::uint64_t> const expected = hashes_of_run(engine, 0);
      EXPECT_NE(expected[0], expected[1]) << engine;
      ASSERT_EQ(hashes_of_run(model, 0), expected) << model;
      for (std::size_t ranks = 1; ranks <= 6; ++ranks) {
        ASSERT_EQ(hashes_of_run(engine, ranks), expected) << ranks << " ranks\n" << engine;
        ASSERT_EQ(hashes_of_run(model, ranks), expected) << ranks << " ranks\n" << model;
      }
    }
  }
}

}  // namespace
}  // namespace gridlock
