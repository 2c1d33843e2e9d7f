#include "gridlock/analysis/strings.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "gridlock/core/error.hpp"
#include "unit/analysis/random_walk.hpp"

namespace gridlock {
namespace {

/// Nine agents in a box of side 10: agents 0, 1 and 2 follow one another across an edge, agents 3 and 4 change places,
/// agent 5 moves alone, agents 6, 7 and 8 hardly move.
struct Drawing {
  std::vector<double> positions{
      9.5, 1.0, 0.5, 1.0, 1.5, 1.0, 4.0, 4.0, 5.0, 4.0, 7.0, 7.0, 2.6, 1.0, 3.0, 8.0, 5.0, 8.0,
      // and after: agent 0 has come to where agent 1 was, through the edge
      10.6, 1.0, 1.6, 1.0, 2.5, 1.0, 5.1, 4.0, 4.1, 4.0, 7.0, 8.5, 2.61, 1.0, 3.0, 8.0, 5.0, 8.02};
  std::vector<double> times{0.0, 1.0};

  [[nodiscard]] TrajectoryInMemory view() const {
    return {.positions = positions.data(), .frames = 2, .agents = 9, .times = times};
  }
};

TEST(Strings, AreThoseOfTheDrawing) {
  Drawing const drawing;
  Strings const found =
      find_strings(drawing.view(),
                   {.lags = {1.0}, .mobile_share = 6.0 / 9.0, .distance = 0.3, .box = Box(10.0, 10.0, Edge::periodic)});
  EXPECT_EQ(found.mobile_agents, 6U);
  // Agent 2 has moved to where agent 6 stays, which is not mobile: the strings have 3, 2 and 1 agents.
  EXPECT_EQ(found.lags[0].strings, (std::vector<double>{1.0, 1.0, 1.0}));
  EXPECT_DOUBLE_EQ(found.lags[0].mean_length.value, 2.0);
  EXPECT_DOUBLE_EQ(found.lags[0].weighted_length.value, 14.0 / 6.0);
  EXPECT_EQ(found.lags[0].origins, 1U);
  EXPECT_FALSE(found.lags[0].mean_length.error);
}

TEST(Strings, EndAtTheEdgeOfWhatIsNoPeriodicBox) {
  Drawing const drawing;
  Strings const found = find_strings(drawing.view(), {.lags = {1.0}, .mobile_share = 0.66, .distance = 0.3});
  EXPECT_EQ(found.lags[0].strings, (std::vector<double>{2.0, 2.0}));
}

TEST(Strings, NeedOneAgentToComeCloserThanTheDistance) {
  Drawing const drawing;
  Strings const found = find_strings(drawing.view(), {.lags = {1.0}, .mobile_share = 0.66, .distance = 0.05});
  EXPECT_EQ(found.lags[0].strings, (std::vector<double>{6.0}));
  EXPECT_EQ(found.lags[0].mean_length.value, 1.0);
}

TEST(Strings, OfWalkersFarApartAreAllOfOneAgentAtEveryOrigin) {
  RandomWalk walk(30, 40);
  for (std::size_t k = 0; k < walk.positions.size(); k += 2) walk.positions[k] += 1000.0 * static_cast<double>(k % 80);
  Strings const found = find_strings(walk.view(), {.lags = {2.2, 5.0}, .distance = 0.5, .max_origins = 10});
  EXPECT_EQ(found.mobile_agents, 2U);
  EXPECT_EQ(found.lags[0].lag, 2.0);
  EXPECT_EQ(found.lags[0].origins, 10U);
  EXPECT_EQ(found.lags[1].mean_length.value, 1.0);
  EXPECT_EQ(found.lags[1].mean_length.error.value(), 0.0);
}

TEST(Strings, RefuseSharesAndDistancesThatAreNone) {
  Drawing const drawing;
  EXPECT_THROW(find_strings(drawing.view(), {.lags = {1.0}, .mobile_share = 0.0, .distance = 0.3}), Error);
  EXPECT_THROW(find_strings(drawing.view(), {.lags = {1.0}, .mobile_share = 1.5, .distance = 0.3}), Error);
  EXPECT_THROW(find_strings(drawing.view(), {.lags = {1.0}, .distance = -0.3}), Error);
  EXPECT_THROW(find_strings(drawing.view(), {.lags = {1.0}, .distance = 5.1, .box = Box(10.0, 10.0, Edge::periodic)}),
               Error);
}

}  // namespace
}  // namespace gridlock
