#include "observe/displacement_curve.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <vector>

#include "gridlock/core/error.hpp"
#include "unit/observe/hand_built.hpp"

namespace gridlock {
namespace {

using namespace hand_built;

/// Moves all disks of a state and folds them into its box.
void move(State& state, double time, std::vector<Vector> const& by) {
  state.clock.time = time;
  Disks& d = state.agents;
  for (std::size_t i = 0; i < d.size(); ++i) {
    int crossed_x = 0;
    int crossed_y = 0;
    Vector const p = state.box.wrap({d.column<X>()[i] + by[i].x, d.column<Y>()[i] + by[i].y}, crossed_x, crossed_y);
    d.column<X>()[i] = p.x;
    d.column<Y>()[i] = p.y;
    d.column<ImageX>()[i] += crossed_x;
    d.column<ImageY>()[i] += crossed_y;
  }
}

/// A walk of independent Gaussian steps in a periodic box: its states, and unwrapped positions.
struct Walk {
  std::vector<State> states;
  std::vector<std::vector<Vector>> places;

  Walk(std::size_t disks, std::size_t samples, std::uint64_t seed, double step = 0.3) {
    State state = ideal_gas(Box(3.0, 2.0, Edge::periodic), disks, 0.01, seed);
    std::vector<Vector> place;
    for (std::size_t i = 0; i < disks; ++i) place.push_back(position(state.agents, i));
    for (std::size_t sample = 0; sample < samples; ++sample) {
      states.push_back(state);
      places.push_back(place);
      std::vector<Vector> by;
      for (std::size_t i = 0; i < disks; ++i) {
        RandomStream random(seed, sample, i, Purpose::start_velocity);
        double const x = step * random.normal();
        by.push_back({x, step * random.normal()});
        place[i] = place[i] + by[i];
      }
      move(state, 0.5 * static_cast<double>(sample + 1), by);
    }
  }
  [[nodiscard]] double squared(std::size_t from, std::size_t to) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < places[from].size(); ++i) sum += squared_length(places[to][i] - places[from][i]);
    return sum / static_cast<double>(places[from].size());
  }
};

TEST(LagsOfCurve, AscendFromOneToTheLongestAndHaveAThirdOfIt) {
  for (std::uint64_t const longest : {1U, 2U, 3U, 17U, 60U, 1000U, 1'000'000U}) {
    auto const lags = lags_of_curve(longest);
    EXPECT_EQ(lags.front(), 1U);
    EXPECT_EQ(lags.back(), longest);
    EXPECT_EQ(std::set(lags.begin(), lags.end()).size(), lags.size());
    EXPECT_TRUE(std::ranges::binary_search(lags, std::max<std::uint64_t>(1, (longest + 1) / 3)));
    EXPECT_LT(lags.size(), 200U);
  }
  EXPECT_EQ(lags_of_curve(5), (std::vector<std::uint64_t>{1, 2, 3, 4, 5}));
}

TEST(DisplacementCurve, IsTheMeanOverEveryOriginOfASlowSum) {
  Walk const walk(20, 61, 3);
  for (std::uint64_t const every : {1U, 2U, 3U, 10U, 25U}) {
    constexpr std::uint64_t longest = 10;
    DisplacementCurve curve(longest, every);
    curve.begin({walk.states[0], {}});
    for (State const& state : walk.states) sample(curve, state);
    auto const table = curve.distributions().at(0).columns_of_values;
    ASSERT_EQ(table[0].size(), longest);
    for (std::size_t lag = 1; lag <= longest; ++lag) {
      double sum = 0.0;
      double origins = 0.0;
      for (std::size_t origin = 0; origin + lag < walk.states.size(); origin += every, ++origins) {
        sum += walk.squared(origin, origin + lag);
      }
      EXPECT_DOUBLE_EQ(table[0][lag - 1], 0.5 * static_cast<double>(lag));
      EXPECT_NEAR(table[1][lag - 1], sum / origins, 1e-11) << lag << " every " << every;
      EXPECT_EQ(table[3][lag - 1], origins);
    }
    double slopes = 0.0;
    double origins = 0.0;
    for (std::size_t origin = 0; origin + longest < walk.states.size(); origin += every, ++origins) {
      slopes += (walk.squared(origin, origin + 10) - walk.squared(origin, origin + 3)) / (4.0 * 3.5);
    }
    EXPECT_NEAR(result(curve, "diffusion_coefficient")->value, slopes / origins, 1e-11);
  }
}

TEST(DisplacementCurve, OfFreeFlightIsTheSquareOfTheLagAroundTheBoxManyTimes) {
  State state = ideal_gas(Box(2.0, 5.0, Edge::periodic), 9, 0.01, 1);
  DisplacementCurve curve(40, 0);
  curve.begin({state, {}});
  for (int n = 0; n <= 100; ++n) {
    sample(curve, state);
    move(state, 0.1 * (n + 1), std::vector<Vector>(9, Vector{0.7, -0.4}));
  }
  auto const table = curve.distributions().at(0).columns_of_values;
  for (std::size_t k = 0; k < table[0].size(); ++k) {
    double const expected = 65.0 * table[0][k] * table[0][k];  // speed 7, 4
    EXPECT_NEAR(table[1][k], expected, 1e-9 * expected);
  }
}

TEST(DisplacementCurve, StartsAtTheFirstSampleThatCountsAndLeavesAnEarlyLastSampleOut) {
  Walk walk(5, 14, 1);
  DisplacementCurve curve(4, 1);
  curve.begin({walk.states[0], {}});
  for (std::size_t n = 0; n < 13; ++n) sample(curve, walk.states[n], {}, n >= 3);
  walk.states[13].clock.time -= 0.3;
  sample(curve, walk.states[13]);
  auto const table = curve.distributions().at(0).columns_of_values;
  EXPECT_EQ(table[3], (std::vector<double>{9, 8, 7, 6})) << "of samples 3 to 12";
  EXPECT_EQ(table[0], (std::vector<double>{0.5, 1.0, 1.5, 2.0}));
}

TEST(DisplacementCurve, LeavesFixedDisksOut) {
  State state = ideal_gas(Box(3.0, 2.0, Edge::periodic), 2, 0.01, 1);
  state.agents.column<Mass>()[1] = std::numeric_limits<double>::infinity();
  DisplacementCurve curve(1, 1);
  curve.begin({state, {}});
  sample(curve, state);
  move(state, 1.0, {{0.6, 0.8}, {0.0, 0.0}});
  sample(curve, state);
  EXPECT_NEAR(curve.distributions().at(0).columns_of_values[1][0], 1.0, 1e-14);
}

TEST(DisplacementCurve, ErrorsAreThoseOfManyRunsThoughOriginsOverlap) {
  constexpr int replicas = 150;
  constexpr std::size_t place = 5;  // a lag of 6 samples out of 12, with four origins at one time
  double sum = 0.0, squares = 0.0, told = 0.0, slope_sum = 0.0, slope_squares = 0.0, slope_told = 0.0;
  for (int replica = 1; replica <= replicas; ++replica) {
    Walk const walk(10, 500, static_cast<std::uint64_t>(replica));
    DisplacementCurve curve(12, 3);
    curve.begin({walk.states[0], {}});
    for (State const& state : walk.states) sample(curve, state);
    auto const table = curve.distributions().at(0).columns_of_values;
    sum += table[1][place] / replicas;
    squares += table[1][place] * table[1][place] / replicas;
    told += table[2][place] * table[2][place] / replicas;
    Estimate const slope = *result(curve, "diffusion_coefficient");
    slope_sum += slope.value / replicas;
    slope_squares += slope.value * slope.value / replicas;
    slope_told += *slope.error * *slope.error / replicas;
  }
  // The variance of 150 runs has a relative error of √(2/150), and what blocks tell scatters less.
  EXPECT_NEAR(told / (squares - sum * sum), 1.0, 4.0 * std::sqrt(2.0 / replicas));
  EXPECT_NEAR(slope_told / (slope_squares - slope_sum * slope_sum), 1.0, 4.0 * std::sqrt(2.0 / replicas));
  double const expected = 2.0 * 6.0 * 0.09;
  EXPECT_NEAR(sum, expected, 4.0 * std::sqrt((squares - sum * sum) / replicas));
  EXPECT_NEAR(slope_sum, 0.09, 4.0 * std::sqrt((slope_squares - slope_sum * slope_sum) / replicas));
}

TEST(DisplacementCurve, HasNoErrorFromOneGroupOfOrigins) {
  Walk const walk(5, 12, 1);
  DisplacementCurve curve(4, 2);
  curve.begin({walk.states[0], {}});
  for (State const& state : walk.states) sample(curve, state);
  EXPECT_TRUE(std::isnan(curve.distributions().at(0).columns_of_values[2][0]));
}

TEST(DisplacementCurve, RefusesMoreOriginsAtOneTimeThanItKeeps) {
  EXPECT_NO_THROW(DisplacementCurve(640, 10));
  try {
    DisplacementCurve(650, 10);
    FAIL();
  } catch (Error const& error) {
    std::string const text = error.what();
    EXPECT_NE(text.find("lags up to 650 samples with an origin every 10 samples keep 65 origins"), std::string::npos)
        << text;
    EXPECT_NE(text.find("at least 11 samples apart"), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace gridlock
