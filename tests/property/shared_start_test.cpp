// Starts that processes share, here threads: the rows of one process, to the bit.
#include <gtest/gtest.h>

#include <cstdint>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "gridlock/core/random.hpp"
#include "gridlock/lattice/start.hpp"
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
  test::ThreadRanks(ranks).run_on_all([&](Ranks& here) {
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
      for (std::uint64_t const count : {1U, 2U, 3U, 7U, 1000U}) {
        disks.count = count;
        for (std::size_t ranks = 1; ranks <= 9; ++ranks) {
          Edge const edge = ranks % 2 == 0 ? Edge::wall : Edge::periodic;
          ASSERT_NO_FATAL_FAILURE(expect_rows_of_one_process(name, disks, edge, ranks));
        }
      }
      disks.count = 20'001;
      ASSERT_NO_FATAL_FAILURE(expect_rows_of_one_process(name, disks, Edge::periodic, 4));
    }
  }
}

}  // namespace
}  // namespace gridlock
