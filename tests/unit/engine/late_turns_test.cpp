// Which late turns may disturb each other, and when those of several ranks come.

#include "engine/tiled/late_turns.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace gridlock::tiled {
namespace {

LateDisk late(int column, int row, std::uint32_t rank, double energy = 1.0, double mass = 1.0) {
  return {.tile = 0,
          .id_index = 0,
          .cell = row * 100 + column,
          .process = rank,
          .energy = energy,
          .smallest_mass = mass,
          .largest_radius = 0.1,
          .smallest_radius = 0.1};
}

CellLayout const walls(Box(1.0, 1.0, Edge::wall), 100, 100);
CellLayout const periodic(Box(1.0, 1.0, Edge::periodic), 100, 100);

TEST(LateTurns, MeetWhereTheyLookAtACommonCell) {
  EXPECT_TRUE(may_meet(walls, 50 * 100 + 50, 50 * 100 + 54, 2));
  EXPECT_FALSE(may_meet(walls, 50 * 100 + 50, 50 * 100 + 55, 2));
  EXPECT_FALSE(may_meet(walls, 50 * 100 + 1, 50 * 100 + 99, 2));
  EXPECT_TRUE(may_meet(periodic, 50 * 100 + 1, 50 * 100 + 99, 2)) << "across the edge of the box";
}

TEST(LateTurns, ShareTheirEnergyWithAllWhomTheyMayReachThroughOthers) {
  // A chain of three, and one far away.
  std::vector<LateDisk> const disks{late(10, 10, 0, 1.0), late(18, 10, 0, 2.0, 0.5), late(14, 10, 0, 4.0),
                                    late(60, 60, 0, 8.0)};
  LateGroups const groups = groups_of(walls, disks, 2);
  ASSERT_EQ(groups.groups.size(), 2U);
  EXPECT_EQ(groups.group_of[0], groups.group_of[1]);
  EXPECT_EQ(groups.group_of[0], groups.group_of[2]);
  EXPECT_NE(groups.group_of[0], groups.group_of[3]);
  EXPECT_DOUBLE_EQ(groups.groups[groups.group_of[0]].energy, 7.0);
  EXPECT_DOUBLE_EQ(groups.groups[groups.group_of[0]].smallest_mass, 0.5);
  EXPECT_DOUBLE_EQ(groups.groups[groups.group_of[3]].energy, 8.0);
}

TEST(LateTurns, WaitForEarlierOnesOfOtherRanksAlone) {
  // Two of one rank beside each other need no message between them.
  EXPECT_EQ(levels_of(walls, std::vector{late(10, 10, 0), late(11, 10, 0)}, 2), (std::vector<std::size_t>{0, 0}));
  EXPECT_EQ(levels_of(walls, std::vector{late(10, 10, 0), late(11, 10, 1)}, 2), (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(levels_of(walls, std::vector{late(10, 10, 0), late(11, 10, 1), late(12, 10, 0), late(80, 80, 2)}, 2),
            (std::vector<std::size_t>{0, 1, 2, 0}));
  // Its own order is kept: what follows a turn that waits waits too.
  EXPECT_EQ(levels_of(walls, std::vector{late(10, 10, 0), late(11, 10, 1), late(90, 90, 1)}, 2),
            (std::vector<std::size_t>{0, 1, 1}));
}

}  // namespace
}  // namespace gridlock::tiled
