#include "gridlock/analysis/dynamics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "analysis/bessel_table.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/observe/estimate.hpp"
#include "unit/analysis/random_walk.hpp"

namespace gridlock {
namespace {

TEST(Dynamics, IsThatOfTheDefinitions) {
  RandomWalk const walk(12, 13);  // no multiple of the lanes
  Dynamics const found = find_dynamics(walk.view(), {.wave_number = 1.3, .overlap_length = 1.5});
  for (std::size_t lag = 1; lag < 12; ++lag) {
    double second = 0.0, fourth = 0.0, scattering = 0.0, near = 0.0, count = 0.0;
    for (std::size_t from = 0; from + lag < 12; ++from) {
      for (std::size_t agent = 0; agent < 13; ++agent, ++count) {
        double const square = walk.squared(agent, from, from + lag);
        second += square;
        fourth += square * square;
        scattering += ::j0(1.3 * std::sqrt(square));
        near += square <= 2.25 ? 1.0 : 0.0;
      }
    }
    DynamicsOfKind const& kind = found.kinds[0];
    EXPECT_EQ(found.origins[lag - 1], 12 - lag);
    EXPECT_EQ(found.independent_origins[lag - 1], 11 / lag);
    EXPECT_NEAR(kind.squared_displacement[lag - 1].value, second / count, 1e-12 * second);
    EXPECT_NEAR(kind.non_gaussian[lag - 1].value, fourth * count / (2.0 * second * second) - 1.0, 1e-12);
    EXPECT_NEAR(kind.scattering[lag - 1].value, scattering / count, 1e-9);
    EXPECT_NEAR(kind.overlap[lag - 1].value, near / count, 1e-15);
  }
}

TEST(Dynamics, HasErrorsFromTheScatterOfItsIndependentOrigins) {
  constexpr std::size_t frames = 200;
  constexpr std::size_t agents = 13;
  RandomWalk const walk(frames, agents);
  Dynamics const found = find_dynamics(walk.view(), {.wave_number = 0.9, .overlap_length = 1.5});
  for (std::size_t const lag : {1UL, 3UL, 10UL}) {
    // What each origin has: the means of Δr², Δr⁴, J₀ and of those that are near.
    struct Means {
      double second = 0.0, fourth = 0.0, scattering = 0.0, near = 0.0;
    };
    std::vector<Means> origins;
    for (std::size_t from = 0; from + lag < frames; from += lag) {
      Means& means = origins.emplace_back();
      for (std::size_t agent = 0; agent < agents; ++agent) {
        double const square = walk.squared(agent, from, from + lag);
        means.second += square / agents;
        means.fourth += square * square / agents;
        means.scattering += ::j0(0.9 * std::sqrt(square)) / agents;
        means.near += square <= 2.25 ? 1.0 / agents : 0.0;
      }
    }
    double second = 0.0, fourth = 0.0;
    for (std::size_t from = 0; from + lag < frames; ++from) {
      for (std::size_t agent = 0; agent < agents; ++agent) {
        double const square = walk.squared(agent, from, from + lag);
        second += square / static_cast<double>(agents * (frames - lag));
        fourth += square * square / static_cast<double>(agents * (frames - lag));
      }
    }
    auto const error_of = [&](auto const& value) {
      BlockAverage average;
      for (Means const& means : origins) average.add(value(means));
      return average.estimate().value().error.value();
    };
    // How α₂ changes with a small share of what an origin has more than the mean.
    auto const change = [&](Means const& means) {
      double const share = 1e-6;
      double const s = second + share * (means.second - second);
      double const f = fourth + share * (means.fourth - fourth);
      return (f / (2.0 * s * s) - fourth / (2.0 * second * second)) / share;
    };
    DynamicsOfKind const& kind = found.kinds[0];
    auto const expect_error = [&](Estimate const& estimate, double expected) {
      EXPECT_NEAR(estimate.error.value(), expected, 1e-4 * expected) << "lag " << lag;
    };
    expect_error(kind.squared_displacement[lag - 1], error_of([](Means const& means) { return means.second; }));
    expect_error(kind.non_gaussian[lag - 1], error_of(change));
    expect_error(kind.scattering[lag - 1], error_of([](Means const& means) { return means.scattering; }));
    expect_error(kind.overlap[lag - 1], error_of([](Means const& means) { return means.near; }));
  }
}

TEST(Dynamics, HasTheScatteringOfDisplacementsBeyondTheTable) {
  // Some of eight neighbours in memory are beyond it, some are not.
  RandomWalk walk(2, 21);
  for (std::size_t agent = 0; agent < 21; agent += 3) walk.positions[2 * (21 + agent)] += 30.0;
  Dynamics const found = find_dynamics(walk.view(), {.wave_number = 2.0});
  double expected = 0.0;
  for (std::size_t agent = 0; agent < 21; ++agent) expected += ::j0(2.0 * std::sqrt(walk.squared(agent, 0, 1))) / 21.0;
  EXPECT_NEAR(found.kinds[0].scattering[0].value, expected, 1e-9);
}

TEST(Dynamics, DoesNotDependOnTheThreadsAndHasEveryKindByItself) {
  RandomWalk const walk(40, 700);
  std::vector<std::uint32_t> kinds(700);
  for (std::size_t i = 0; i < kinds.size(); ++i) kinds[i] = i % 3 == 0 ? 1 : 0;
  TrajectoryInMemory mixture = walk.view();
  mixture.kinds = kinds;
  Dynamics const one = find_dynamics(mixture, {.wave_number = 0.7, .threads = 1});
  Dynamics const three = find_dynamics(mixture, {.wave_number = 0.7, .threads = 3});
  Dynamics const all = find_dynamics(walk.view(), {.threads = 1});
  ASSERT_EQ(one.kinds.size(), 2U);
  for (std::size_t l = 0; l < one.lag.size(); ++l) {
    double mean = 0.0;
    for (std::size_t kind = 0; kind < 2; ++kind) {
      EXPECT_EQ(one.kinds[kind].squared_displacement[l].value, three.kinds[kind].squared_displacement[l].value);
      EXPECT_EQ(one.kinds[kind].scattering[l].value, three.kinds[kind].scattering[l].value);
      mean += one.kinds[kind].squared_displacement[l].value * (kind == 0 ? 466.0 : 234.0) / 700.0;
    }
    EXPECT_NEAR(mean, all.kinds[0].squared_displacement[l].value, 1e-12 * mean);
  }
}

TEST(Dynamics, WithoutDriftDoesNotSeeThatAllMove) {
  RandomWalk const walk(10, 20);
  RandomWalk moving = walk;
  // By more along x than along y.
  for (std::size_t k = 0; k < moving.positions.size(); ++k)
    moving.positions[k] += (k % 2 == 0 ? 5.0 : -2.0) * static_cast<double>(k / 40);
  Dynamics const still = find_dynamics(walk.view(), {.keeps_drift = false});
  Dynamics const moved = find_dynamics(moving.view(), {.keeps_drift = false});
  for (std::size_t l = 0; l < 9; ++l) {
    double const value = still.kinds[0].squared_displacement[l].value;
    EXPECT_NEAR(moved.kinds[0].squared_displacement[l].value, value, 1e-9 * value);
  }
}

TEST(Dynamics, OfOneOriginHasNoErrorAndOfNoMotionNoRatio) {
  std::vector<double> const positions{0.0, 0.0, 0.0, 0.0};
  std::vector<double> const times{0.0, 1.0};
  Dynamics const found = find_dynamics({.positions = positions.data(), .frames = 2, .agents = 1, .times = times}, {});
  EXPECT_EQ(found.kinds[0].squared_displacement[0].value, 0.0);
  EXPECT_FALSE(found.kinds[0].squared_displacement[0].error);
  EXPECT_TRUE(std::isnan(found.kinds[0].non_gaussian[0].value));
}

TEST(Dynamics, RefusesWhatIsNoTrajectory) {
  RandomWalk walk(4, 2);
  std::vector<std::uint32_t> const gap{0, 2};
  TrajectoryInMemory with_gap = walk.view();
  with_gap.kinds = gap;
  EXPECT_THROW(find_dynamics(with_gap, {}), Error);
  TrajectoryInMemory short_times = walk.view();
  short_times.times = short_times.times.first(3);
  EXPECT_THROW(find_dynamics(short_times, {}), Error);
  EXPECT_THROW(find_dynamics(walk.view(), {.wave_number = -1.0}), Error);
  EXPECT_THROW(find_dynamics(walk.view(), {.overlap_length = std::nan("")}), Error);
  TrajectoryInMemory nobody = walk.view();
  nobody.agents = 0;
  EXPECT_THROW(find_dynamics(nobody, {}), Error);
  walk.positions[5] = std::nan("");
  EXPECT_THROW(find_dynamics(walk.view(), {}), Error);
}

TEST(BesselTable, IsThatOfTheLibrary) {
  BesselTable const table;
  for (double s = 0.0; s < 700.0; s += 0.037) EXPECT_NEAR(table(s), ::j0(std::sqrt(s)), 1e-9) << s;
}

}  // namespace
}  // namespace gridlock
