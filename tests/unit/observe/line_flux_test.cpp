#include "observe/line_flux.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "gridlock/core/error.hpp"
#include "unit/observe/hand_built.hpp"

namespace gridlock {
namespace {

using namespace hand_built;

/// Puts a disk at an unwrapped position in a periodic box, or at a place between walls.
void put(State& state, std::size_t row, Vector place) {
  Box const& box = state.box;
  double const around_x = box.is_periodic() ? std::floor(place.x / box.width()) : 0.0;
  double const around_y = box.is_periodic() ? std::floor(place.y / box.height()) : 0.0;
  state.agents.column<X>()[row] = place.x - around_x * box.width();
  state.agents.column<Y>()[row] = place.y - around_y * box.height();
  state.agents.column<ImageX>()[row] = static_cast<std::int32_t>(around_x);
  state.agents.column<ImageY>()[row] = static_cast<std::int32_t>(around_y);
}

State disks_at(Box const& box, std::vector<Vector> const& places) {
  State state = empty_state(box);
  for (Vector const place : places) {
    add_disk(state, {0.0, 0.0});
    put(state, state.agents.size() - 1, place);
  }
  return state;
}

/// The row of a sample after disks went from some places to others in a time of 2.
std::vector<double> row_of(Box const& box, FluxLine line, std::optional<double> at, std::vector<Vector> const& from,
                           std::vector<Vector> const& to) {
  LineFlux flux(line, at);
  flux.begin({disks_at(box, from), {}});
  State state = disks_at(box, to);
  state.clock.time = 2.0;
  return sample(flux, state);
}

TEST(LineFlux, CountsCrossingsInEachDirectionAndDividesByTheTime) {
  Box const box(4.0, 10.0, Edge::wall);
  std::vector<Vector> const from{{0.9, 1}, {0.5, 1}, {3.0, 9}, {1.1, 2}, {0.1, 2}};
  std::vector<Vector> const to{{1.1, 9}, {2.0, 2}, {0.9, 2}, {3.5, 2}, {0.9, 1}};
  EXPECT_EQ(row_of(box, FluxLine::vertical, 1.0, from, to), (std::vector<double>{2, 1, 1.0, 0.5, 0.5}));
  // The middle of the height is y = 5: the first goes up, the third down.
  EXPECT_EQ(row_of(box, FluxLine::horizontal, std::nullopt, from, to), (std::vector<double>{1, 1, 0.5, 0.5, 0.0}));
}

TEST(LineFlux, CountsNothingWhereADiskGoesStraightUpThroughAnObliqueBox) {
  Box const box = Box(4.0, 10.0, Edge::periodic).tilted(0.15);
  auto const disk_at = [&](Vector place) {
    State state = disks_at(box, {{0.0, 0.0}});
    int crossed_x = 0;
    int crossed_y = 0;
    for (double up = place.y; up >= box.height(); up -= box.height()) ++crossed_y;
    Vector p{place.x - crossed_y * box.shift(), place.y - crossed_y * box.height()};
    p = box.wrap(p, crossed_x, crossed_y);
    put(state, 0, p);
    state.agents.column<ImageX>()[0] = crossed_x;
    state.agents.column<ImageY>()[0] = crossed_y;
    return state;
  };
  LineFlux flux(FluxLine::vertical, 1.0);
  flux.begin({disk_at({2.9, 1.0}), {}});
  State up = disk_at({2.9, 21.0});
  up.clock.time = 1.0;
  EXPECT_EQ(up.agents.column<ImageY>()[0], 2);
  EXPECT_EQ(sample(flux, up)[4], 0.0);
  State right = disk_at({5.1, 21.0});
  right.clock.time = 2.0;
  EXPECT_EQ(sample(flux, right)[4], 1.0);
}

TEST(LineFlux, CountsEveryImageOfTheLineThatADiskPassesAroundThePeriodicBox) {
  Box const box(4.0, 10.0, Edge::periodic);
  auto const crossings = [&](double from, double to) {
    auto const row = row_of(box, FluxLine::vertical, 1.0, {{from, 1}}, {{to, 1}});
    return row[0] - row[1];
  };
  EXPECT_EQ(crossings(0.5, 13.5), 4.0) << "lines at 1, 5, 9, 13";
  EXPECT_EQ(crossings(13.5, 0.5), -4.0);
  EXPECT_EQ(crossings(3.9, 4.9), 0.0) << "the edge is no line";
  EXPECT_EQ(crossings(3.9, 5.1), 1.0);
  EXPECT_EQ(crossings(0.5, -3.5), -1.0);
  EXPECT_EQ(crossings(1.0, 0.99), -1.0) << "on the line is forward";
  EXPECT_EQ(crossings(0.99, 1.0), 1.0);
}

TEST(LineFlux, DoesNotSeeADiskThatReturnsButTheNetFluxIsThatOfMoreSamples) {
  Box const box(4.0, 10.0, Edge::periodic);
  std::vector<double> const path{0.5, 1.5, 0.7, 1.2, 5.5, 4.0, 6.0};
  LineFlux often(FluxLine::vertical, 1.0);
  LineFlux once(FluxLine::vertical, 1.0);
  often.begin({disks_at(box, {{path.front(), 1}}), {}});
  once.begin({disks_at(box, {{path.front(), 1}}), {}});
  double forward = 0.0;
  double backward = 0.0;
  for (std::size_t k = 1; k < path.size(); ++k) {
    auto const row = sample(often, disks_at(box, {{path[k], 1}}));
    forward += row[0];
    backward += row[1];
  }
  auto const row = sample(once, disks_at(box, {{path.back(), 1}}));
  EXPECT_EQ(forward, 4.0);
  EXPECT_EQ(backward, 2.0);
  EXPECT_EQ(row[0], 2.0);
  EXPECT_EQ(row[1], 0.0);
}

TEST(LineFlux, WeighsRatesByTimeInAverages) {
  Box const box(4.0, 10.0, Edge::wall);
  LineFlux flux(FluxLine::vertical, 2.0);
  State state = disks_at(box, {{1.0, 1.0}});
  flux.begin({state, {}});
  EXPECT_TRUE(std::isnan(sample(flux, state)[2])) << "no time has passed";
  put(state, 0, {3.0, 1.0});
  state.clock.time = 1.0;
  sample(flux, state);
  state.clock.time = 4.0;
  sample(flux, state);
  EXPECT_DOUBLE_EQ(result(flux, "flux_forward")->value, 1.0 / 4.0);
  EXPECT_DOUBLE_EQ(result(flux, "net_flux")->value, 1.0 / 4.0);
  EXPECT_FALSE(result(flux, "crossings_forward"));
}

TEST(LineFlux, FollowsIdsWhenRowsAreReorderedAndLeavesFixedDisksOut) {
  Box const box(4.0, 10.0, Edge::wall);
  State state = disks_at(box, {{1.0, 1.0}, {3.0, 1.0}, {1.5, 5.0}});
  state.agents.column<Mass>()[2] = std::numeric_limits<double>::infinity();
  LineFlux flux(FluxLine::vertical, 2.0);
  flux.begin({state, {}});
  EXPECT_EQ(sample(flux, with_rows_reversed(state))[0], 0.0);
  put(state, 2, {2.5, 5.0});
  EXPECT_EQ(sample(flux, state)[0], 0.0);
}

TEST(LineFlux, RefusesALineOutsideTheBox) {
  State const state = disks_at(Box(4.0, 10.0, Edge::wall), {});
  LineFlux(FluxLine::horizontal, 9.5).begin({state, {}});
  try {
    LineFlux(FluxLine::vertical, 9.5).begin({state, {}});
    FAIL();
  } catch (Error const& error) {
    EXPECT_NE(std::string(error.what()).find("the line x = 9.5 of the flux is outside the box, which is 4 wide"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace gridlock
