#include "gridlock/grid/validate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "gridlock/core/error.hpp"

namespace gridlock {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

State empty_state(Edge edge) { return {.box = Box(1.0, 1.0, edge)}; }

void add(State& state, double x, double y, double r) { state.agents.add(x, y, 0.0, 0.0, r, 1.0, 0, 0); }

std::string problems_of(State const& state) {
  try {
    validate(state);
    return "";
  } catch (Error const& error) {
    for (Problem const& problem : error.problems()) EXPECT_FALSE(problem.hint.empty()) << problem.what;
    return error.what();
  }
}

void expect_problem(State const& state, std::string const& words) {
  EXPECT_NE(problems_of(state).find(words), std::string::npos) << "got: " << problems_of(state);
}

TEST(Validate, AcceptsNothingOneAndTouchingDisks) {
  State state = empty_state(Edge::wall);
  EXPECT_NO_THROW(validate(state));
  add(state, 0.25, 0.25, 0.25);
  EXPECT_NO_THROW(validate(state)) << "touching two walls";
  add(state, 0.75, 0.25, 0.25);
  EXPECT_NO_THROW(validate(state)) << "touching a wall and a disk";
  EXPECT_EQ(largest_overlap(state), 0.0);
}

TEST(Validate, NamesBothDisksAndTheGapOfAnOverlap) {
  State state = empty_state(Edge::wall);
  add(state, 0.25, 0.25, 0.125);
  add(state, 0.25, 0.75, 0.125);
  add(state, 0.4375, 0.25, 0.125);
  expect_problem(state, "disks 0 and 2 overlap by 0.0625");
  EXPECT_DOUBLE_EQ(largest_overlap(state), 0.0625);
}

TEST(Validate, UsesTheIdsNotTheRows) {
  State state = empty_state(Edge::wall);
  ASSERT_TRUE(state.agents.add_as(9, 0.5, 0.5, 0.0, 0.0, 0.1, 1.0, 0, 0));
  ASSERT_TRUE(state.agents.add_as(4, 0.5, 0.6, 0.0, 0.0, 0.1, 1.0, 0, 0));
  expect_problem(state, "disks 4 and 9 overlap by 0.1");
}

TEST(Validate, SeesAnOverlapOfTheLastBitWithAGapAboveZero) {
  State state = empty_state(Edge::wall);
  add(state, 0.25, 0.5, 0.125);
  add(state, std::nextafter(0.5, 0.0), 0.5, 0.125);
  EXPECT_GT(largest_overlap(state), 0.0);
  EXPECT_LT(largest_overlap(state), 1e-15);
  expect_problem(state, "disks 0 and 1 overlap by");
  EXPECT_EQ(problems_of(state).find("overlap by 0\n"), std::string::npos);
  EXPECT_EQ(problems_of(state).find("overlap by -"), std::string::npos);
}

TEST(Validate, SeesAnOverlapAcrossTheEdgeOfAPeriodicBoxOnly) {
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    State state = empty_state(edge);
    add(state, 0.125, 0.5, 0.125);
    add(state, 0.875, 0.5, 0.125);
    EXPECT_NO_THROW(validate(state)) << "they touch at most";
    state.agents.column<Radius>()[0] = 0.0625;
    state.agents.column<X>()[0] = 0.0625;
    EXPECT_EQ(problems_of(state).empty(), true);
    state.agents.column<X>()[1] = 0.890625;
    if (edge == Edge::periodic) {
      expect_problem(state, "disks 0 and 1 overlap by 0.0156");
    } else {
      expect_problem(state, "disk 1 at (0.890625, 0.5) with radius 0.125 is not inside");
    }
  }
}

TEST(Validate, FindsCoincidentDisks) {
  State state = empty_state(Edge::periodic);
  add(state, 0.5, 0.5, 0.1);
  add(state, 0.5, 0.5, 0.1);
  expect_problem(state, "overlap by 0.2");
}

TEST(Validate, FindsAnOverlapOfASmallDiskWithALargeOneFarAway) {
  State state = empty_state(Edge::wall);
  add(state, 0.4, 0.4, 0.4);
  for (int n = 0; n < 50; ++n) add(state, 0.01 + 0.019 * n, 0.99, 0.009);
  EXPECT_NO_THROW(validate(state));
  add(state, 0.69, 0.69, 0.02);  // 0.29 √2 = 0.4101 from the centre, 0.42 needed
  expect_problem(state, "disks 0 and 51 overlap by 0.00988");
}

TEST(Validate, RefusesADiskThatReachesThroughAWall) {
  for (Vector const p :
       {Vector{0.05, 0.5}, Vector{0.95, 0.5}, Vector{0.5, 0.05}, Vector{0.5, 0.95}, Vector{-3.0, 0.5}}) {
    State state = empty_state(Edge::wall);
    add(state, p.x, p.y, 0.1);
    expect_problem(state, "is not inside the box");
  }
}

TEST(Validate, RefusesADiskWiderThanTheBox) {
  State state = empty_state(Edge::wall);
  add(state, 0.5, 0.5, 0.6);
  expect_problem(state, "is not inside the box");
  State periodic = empty_state(Edge::periodic);
  add(periodic, 0.5, 0.5, 0.6);
  expect_problem(periodic, "overlaps its own image");
}

TEST(Validate, PeriodicCentresLieInTheHalfOpenBox) {
  for (double const good : {0.0, 0.05, std::nextafter(1.0, 0.0)}) {
    State state = empty_state(Edge::periodic);
    add(state, good, 0.5, 0.1);
    EXPECT_NO_THROW(validate(state)) << good;
  }
  for (double const bad : {-1e-300, 1.0, 1.5, -2.0}) {
    State state = empty_state(Edge::periodic);
    add(state, bad, 0.5, 0.1);
    expect_problem(state, "is not inside the box");
    state.agents.column<X>()[0] = 0.5;
    state.agents.column<Y>()[0] = bad;
    expect_problem(state, "is not inside the box");
  }
}

TEST(Validate, RefusesWhatIsNotFiniteAndWhatMustBePositive) {
  for (double const bad : {std::nan(""), infinity, -infinity}) {
    for (int column = 0; column < 4; ++column) {
      State state = empty_state(Edge::wall);
      add(state, 0.5, 0.5, 0.1);
      (column == 0   ? state.agents.column<X>()
       : column == 1 ? state.agents.column<Y>()
       : column == 2 ? state.agents.column<VelocityX>()
                     : state.agents.column<VelocityY>())[0] = bad;
      expect_problem(state, "disk 0 has position");
    }
  }
  for (double const bad : {0.0, -0.1, std::nan(""), infinity}) {
    State state = empty_state(Edge::wall);
    add(state, 0.5, 0.5, bad);
    expect_problem(state, "disk 0 has position");
    state.agents.column<Radius>()[0] = 0.1;
    state.agents.column<Mass>()[0] = bad;
    state.agents.column<VelocityX>()[0] = 1.0;  // at rest a disk of infinite mass is a fixed one
    expect_problem(state, "disk 0 has position");
  }
}

TEST(Validate, TakesADiskOfInfiniteMassAtRestForAFixedOne) {
  State state = empty_state(Edge::wall);
  add(state, 0.5, 0.5, 0.1);
  state.agents.column<Mass>()[0] = infinity;
  EXPECT_NO_THROW(validate(state));
}

TEST(Validate, ShowsTheFirstFewOfManyAndCountsTheRest) {
  State state = empty_state(Edge::wall);
  for (int n = 0; n < 10; ++n) add(state, 2.0, 0.5, 0.1);
  try {
    validate(state);
    FAIL();
  } catch (Error const& error) {
    EXPECT_EQ(error.problems().size(), 3U);
    EXPECT_NE(error.problems()[2].what.find("(and 7 more like it)"), std::string::npos);
  }
}

TEST(Validate, ReportsEveryKindOfBrokenRowAtOnce) {
  State state = empty_state(Edge::wall);
  add(state, 2.0, 0.5, 0.1);
  add(state, 0.5, std::nan(""), 0.1);
  expect_problem(state, "disk 0 at (2, 0.5)");
  expect_problem(state, "disk 1 has position (0.5, nan)");
}

TEST(Validate, LetsRoundingPassWhereItIsAllowedFor) {
  State state = empty_state(Edge::wall);
  add(state, 0.25, 0.25, 0.125);
  add(state, 0.5 - 1e-14, 0.25, 0.125);
  expect_problem(state, "overlap");
  EXPECT_NO_THROW(validate(state, {.overlap = rounding_of_contact(state)}));
  state.agents.column<X>()[1] = 0.5 - 1e-12;
  EXPECT_THROW(validate(state, {.overlap = rounding_of_contact(state)}), Error);
  state.agents.column<X>()[1] = 0.875 + 1e-14;
  expect_problem(state, "not inside the box");
  EXPECT_NO_THROW(validate(state, {.beyond_walls = 1e-13}));
  EXPECT_THROW(validate(state, {.beyond_walls = 1e-15}), Error);
}

TEST(Validate, RoundingGrowsWithTheCoordinatesOfALargeBox) {
  State state{.box = Box(1e6, 1.0, Edge::wall)};
  add(state, 999'000.0, 0.5, 0.05);
  add(state, std::nextafter(999'000.1, 0.0), 0.5, 0.05);
  expect_problem(state, "overlap by");
  EXPECT_NO_THROW(validate(state, {.overlap = rounding_of_contact(state)}));
}

// Where squares or products leave the range of numbers, disks would go through each other without a word.
TEST(Validate, RefusesMagnitudesThatCannotBeComputedWith) {
  for (double const extreme : {1e-170, 1e-61, 1e61, 1e160, 1.7e308}) {
    State state = empty_state(Edge::wall);
    state.agents.add(0.5, 0.5, 0.0, -extreme, 0.1, 1.0, 0, 0);
    expect_problem(state, "velocity");
    state.agents.column<VelocityY>()[0] = 0.0;
    EXPECT_EQ(problems_of(state), "");
    state.agents.column<Mass>()[0] = extreme;
    expect_problem(state, "mass");
    state = {.box = Box(extreme, 1.0, Edge::periodic)};
    add(state, 0.0, 0.5, 0.1);
    expect_problem(state, "the box of");
  }
  State state = empty_state(Edge::wall);
  add(state, 0.5, 0.5, 1e-170);
  expect_problem(state, "radius");
  // What hardly moves among others that do is as good as at rest.
  state = empty_state(Edge::wall);
  state.agents.add(0.25, 0.5, 1.0, 1e-170, 0.1, 1e50, 0, 0);
  state.agents.add(0.75, 0.5, 1e-300, 0.0, 0.1, 1e-50, 0, 0);
  EXPECT_EQ(problems_of(state), "");
}

TEST(LargestOverlap, IsTheWorstOfAllPairs) {
  State state = empty_state(Edge::periodic);
  add(state, 0.01, 0.5, 0.05);
  add(state, 0.94, 0.5, 0.05);  // distance 0.07 across the edge, 0.03 too near
  add(state, 0.10, 0.5, 0.05);  // distance 0.09, 0.01 too near
  EXPECT_NEAR(largest_overlap(state), 0.03, 1e-15);
}

}  // namespace
}  // namespace gridlock
