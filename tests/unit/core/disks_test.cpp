#include "gridlock/core/disks.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace gridlock {
namespace {

Disks three_disks() {
  Disks disks;
  disks.add(0.1, 0.2, 3.0, 4.0, 0.5, 2.0, 0, 0);
  disks.add(0.3, 0.4, -1.0, 0.0, 0.25, 1.0, -1, 2);
  disks.add(0.5, 0.6, 0.0, -2.0, 0.75, 4.0, 0, 0);
  return disks;
}

TEST(Disks, ColumnsAreFilledInTheOrderTheyAreDeclared) {
  Disks const disks = three_disks();
  EXPECT_EQ(position(disks, 1), (Vector{0.3, 0.4}));
  EXPECT_EQ(velocity(disks, 1), (Vector{-1.0, 0.0}));
  EXPECT_EQ(disks.column<Radius>()[1], 0.25);
  EXPECT_EQ(disks.column<Mass>()[2], 4.0);
  EXPECT_EQ(disks.column<ImageX>()[1], -1);
  EXPECT_EQ(disks.column<ImageY>()[1], 2);
}

TEST(Disks, SumsWeighEveryDiskWithItsMass) {
  Disks const disks = three_disks();
  EXPECT_DOUBLE_EQ(kinetic_energy(disks), 0.5 * (2.0 * 25.0 + 1.0 * 1.0 + 4.0 * 4.0));
  EXPECT_EQ(momentum(disks), (Vector{2.0 * 3.0 - 1.0, 2.0 * 4.0 - 4.0 * 2.0}));
  EXPECT_DOUBLE_EQ(largest_speed(disks), 5.0);
  EXPECT_DOUBLE_EQ(covered_area(disks), std::numbers::pi * (0.25 + 0.0625 + 0.5625));
  EXPECT_EQ(radius_range(disks).smallest, 0.25);
  EXPECT_EQ(radius_range(disks).largest, 0.75);
}

TEST(Disks, NoDisksHaveNothingOfAnything) {
  Disks const disks;
  EXPECT_EQ(kinetic_energy(disks), 0.0);
  EXPECT_EQ(momentum(disks), Vector{});
  EXPECT_EQ(largest_speed(disks), 0.0);
  EXPECT_EQ(covered_area(disks), 0.0);
  EXPECT_EQ(radius_range(disks).smallest, 0.0);
  EXPECT_EQ(radius_range(disks).largest, 0.0);
}

}  // namespace
}  // namespace gridlock
