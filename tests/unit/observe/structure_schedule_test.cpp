#include "observe/structure_schedule.hpp"

#include <gtest/gtest.h>

#include <string>

namespace gridlock {
namespace {

/// One letter per sample: X where a structure is measured. `counting` has a + for every sample that counts.
std::string measured(StructureSchedule& schedule, std::string const& counting) {
  std::string result;
  for (char const c : counting) result += schedule.is_due(c == '+') ? 'X' : '.';
  return result;
}

TEST(StructureSchedule, MeasuresTheFirstSampleTheFirstThatCountsAndEveryNthAfterIt) {
  StructureSchedule schedule(3);
  EXPECT_EQ(measured(schedule, "-----++++++++"),
            /*                */ "X..X.X..X..X.");
}

TEST(StructureSchedule, AShortRunHasOneMeasurementThatCounts) {
  StructureSchedule schedule(10);
  EXPECT_EQ(measured(schedule, "-+"), "XX");
}

TEST(StructureSchedule, OfOneMeasuresAlwaysAndOfZeroNever) {
  StructureSchedule always(1);
  EXPECT_EQ(measured(always, "--++"), "XXXX");
  StructureSchedule never(0);
  EXPECT_EQ(measured(never, "--++"), "....");
}

TEST(StructureSchedule, ResetStartsOver) {
  StructureSchedule schedule(4);
  measured(schedule, "-++");
  schedule.reset();
  EXPECT_EQ(measured(schedule, "-+...."), "XX...X");
}

}  // namespace
}  // namespace gridlock
