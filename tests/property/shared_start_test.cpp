// Starts that processes share, here threads: the rows of one process, to the bit.
#include <gtest/gtest.h>

#include <cstdint>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/lattice/start.hpp"
#include "gridlock/simulation/run.hpp"
#include "gridlock/simulation/setup.hpp"
#include "lattice/kinds.hpp"
#include "thread_ranks.hpp"

namespace gridlock {
namespace {

TEST(RowsBeforeDeal, AreWhereTheDisksOfEachRowCameFrom) {
  for (std::uint64_t const count : {1U, 2U, 3U, 10U, 1000U, 1025U, 5000U}) {
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
      std::vector<std::uint64_t> dealt(count);
      std::iota(dealt.begin(), dealt.end(), 0);
      RandomStream random(seed, 0, 0, Purpose::species);
      for (std::uint64_t last = count - 1; last > 0; --last) std::swap(dealt[last], dealt[random.below(last + 1)]);
      for (std::uint64_t const parts : {1U, 2U, 7U}) {
        std::vector<std::uint64_t> found;
        for (std::uint64_t part = 0; part < parts; ++part) {
          auto const own = rows_before_deal(count, seed, count * part / parts, count * (part + 1) / parts);
          found.insert(found.end(), own.begin(), own.end());
        }
        ASSERT_EQ(found, dealt) << count << " disks in " << parts << " parts, seed " << seed;
      }
    }
  }
}

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

/// Ids, columns and box, with velocities whose drift is removed.
void expect_rows_of_one_process(std::string const& name, DisksSettings const& disks, Edge edge, std::size_t ranks) {
  Box const box(1.5, 1.0, edge);
  constexpr std::uint64_t seed = 7;
  VelocitySettings const velocities{.drift = Drift::remove};
  State whole = make_start(box, disks, seed);
  draw_velocities(whole, velocities);
  RowDivision const rows = RowDivision::even(count_of(disks), ranks);
  std::vector<State> parts(ranks);
  test::ThreadRanks(ranks).run_on_all([&](Communicator& here) {
    ShareOfRows const share(here, rows);
    State own = make_start(box, disks, seed, share);
    draw_velocities(own, velocities, share);
    parts[here.rank()] = std::move(own);
  });
  State joined{.box = box, .seed = seed};
  for (State const& part : parts) {
    Disks const& own = part.agents;
    for (std::size_t i = 0; i < own.size(); ++i) {
      ASSERT_EQ(own.ids()[i], joined.agents.size()) << name;
      joined.agents.add(own.column<X>()[i], own.column<Y>()[i], own.column<VelocityX>()[i], own.column<VelocityY>()[i],
                        own.column<Radius>()[i], own.column<Mass>()[i], 0, 0);
    }
  }
  ASSERT_EQ(joined.agents.size(), whole.agents.size());
  EXPECT_EQ(hash(joined), hash(whole)) << name << ", " << whole.agents.size() << " disks on " << ranks << " ranks";
}

TEST(SharedStart, HasTheRowsOfOneProcess) {
  for (auto [name, disks] : shared_starts()) {
    for (StartKind const start : {StartKind::square, StartKind::triangular, StartKind::uniform, StartKind::random}) {
      disks.start = start;
      for (std::uint64_t const count : {1U, 2U, 3U, 7U, 1000U, 20'001U}) {
        disks.count = count;
        for (std::size_t ranks = 1; ranks <= 9; ++ranks) {
          // Random starts take longer.
          if (start == StartKind::random && count > 1000 && ranks != 4) continue;
          Edge const edge = ranks % 2 == 0 ? Edge::wall : Edge::periodic;
          ASSERT_NO_FATAL_FAILURE(expect_rows_of_one_process(name, disks, edge, ranks));
          if (count > 1000) continue;
          Edge const other = ranks % 2 == 0 ? Edge::periodic : Edge::wall;
          ASSERT_NO_FATAL_FAILURE(expect_rows_of_one_process(name, disks, other, ranks));
        }
      }
    }
  }
}

TEST(SharedStart, RefusesOnAllRanksWhatOneProcessRefuses) {
  DisksSettings disks{.count = 3000, .packing_fraction = 0.7};
  disks.species = {{.fraction = 0.5}, {.fraction = 0.5, .size_ratio = 3.0}};
  Box const box(1.25, 0.8, Edge::periodic);
  auto const refusal_of = [&](ShareOfRows const& share) {
    try {
      static_cast<void>(make_start(box, disks, 1, share));
    } catch (Error const& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  std::string const expected = refusal_of(ShareOfRows(3000));
  EXPECT_NE(expected, "");
  std::vector<std::string> refusals(3);
  test::ThreadRanks(3).run_on_all([&](Communicator& here) {
    refusals[here.rank()] = refusal_of({here, RowDivision::even(3000, 3)});
  });
  EXPECT_EQ(refusals, std::vector<std::string>(3, expected));
}

/// Of a start, and of the state after the steps of its run; `ranks` is 0 in one process.
std::vector<std::uint64_t> hashes_of_run(std::string const& text, std::size_t ranks) {
  std::vector<std::uint64_t> hashes;
  auto const work = [&](AllProcesses processes) {
    Setup const setup = set_up(SettingsFile::from_text(text, "run.toml"), {.threads = 1, .processes = processes});
    hashes.push_back(setup.simulation->state_hash());
    Run(*setup.simulation, plan_of(setup)).advance();
    hashes.push_back(setup.simulation->state_hash());
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
  // Random starts of more than 5,000 disks are made by all ranks together.
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
