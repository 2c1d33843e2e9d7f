#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "gridlock/analysis/dynamics.hpp"
#include "gridlock/core/error.hpp"
#include "unit/analysis/random_walk.hpp"

namespace gridlock {
namespace {

/// Every agent has the next ones as neighbours, as many as its number modulo four: agents 0, 4, 8 … have none.
NeighbourLists next_agents(std::size_t agents) {
  NeighbourLists lists;
  lists.begin.push_back(0);
  for (std::size_t i = 0; i < agents; ++i) {
    for (std::size_t n = 1; n <= i % 4; ++n) lists.neighbours.push_back(static_cast<std::uint32_t>((i + n) % agents));
    lists.begin.push_back(lists.neighbours.size());
  }
  return lists;
}

/// ½ N ⟨(Q_a − Q_b)²⟩ over origins a and b whose intervals do not overlap, of the agents of some kinds.
double susceptibility_of(RandomWalk const& walk, std::size_t lag, auto const& belongs) {
  std::vector<double> near;
  double count = 0.0;
  for (std::size_t i = 0; i < walk.agents; ++i) count += belongs(i) ? 1.0 : 0.0;
  for (std::size_t from = 0; from + lag < walk.times.size(); ++from) {
    near.push_back(0.0);
    for (std::size_t i = 0; i < walk.agents; ++i)
      near.back() += belongs(i) && walk.squared(i, from, from + lag) <= 2.25 ? 1.0 / count : 0.0;
  }
  double sum = 0.0, pairs = 0.0;
  for (std::size_t a = 0; a < near.size(); ++a) {
    for (std::size_t b = a + lag; b < near.size(); ++b, ++pairs) sum += std::pow(near[a] - near[b], 2);
  }
  return 0.5 * count * sum / pairs;
}

TEST(DynamicsOfGlass, HasTheSusceptibilityOfTheDefinitionForEachKindAndAll) {
  // Of 1500 frames so few agents fit into a block that there are several.
  for (auto const& walk : {RandomWalk(40, 29), RandomWalk(1500, 150)}) {
    std::vector<std::uint32_t> kinds(walk.agents);
    for (std::size_t i = 0; i < walk.agents; ++i) kinds[i] = i % 3 == 0 ? 1 : 0;
    TrajectoryInMemory mixture = walk.view();
    mixture.kinds = kinds;
    Dynamics const found = find_dynamics(mixture, {.overlap_length = 1.5, .max_lags = 8});
    for (std::size_t l = 0; l < found.lag.size(); ++l) {
      auto const lag = static_cast<std::size_t>(found.lag[l]);
      if (2 * lag >= walk.times.size()) {
        EXPECT_TRUE(std::isnan(found.susceptibility[l].value)) << "all intervals overlap";
        continue;
      }
      EXPECT_NEAR(found.susceptibility[l].value, susceptibility_of(walk, lag, [](std::size_t) { return true; }), 1e-11);
      for (std::size_t kind = 0; kind < 2; ++kind) {
        EXPECT_NEAR(found.kinds[kind].susceptibility[l].value,
                    susceptibility_of(walk, lag, [&](std::size_t i) { return kinds[i] == kind; }), 1e-11);
      }
    }
  }
}

TEST(DynamicsOfGlass, HasTheSusceptibilityOfIndependentWalkersWithinItsErrors) {
  constexpr double length = 1.5;
  double squares = 0.0, sum = 0.0, count = 0.0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    RandomWalk const walk(200, 20, seed);
    Dynamics const found = find_dynamics(walk.view(), {.overlap_length = length});
    for (std::size_t const lag : {1UL, 4UL}) {
      double const p = 1.0 - std::exp(-length * length / (2.0 * static_cast<double>(lag)));  // 4 D t = 2 t
      Estimate const& estimate = found.susceptibility[lag - 1];
      double const z = (estimate.value - p * (1.0 - p)) / estimate.error.value();
      sum += z;
      squares += z * z;
      ++count;
    }
  }
  EXPECT_LT(std::abs(sum / count), 0.5);  // the error is large where the value is, so that z is not symmetric
  EXPECT_GT(std::sqrt(squares / count), 0.6);
  EXPECT_LT(std::sqrt(squares / count), 1.4);
}

TEST(DynamicsOfGlass, RelativeToNeighboursIsThatOfTheDefinition) {
  constexpr std::size_t frames = 9;
  constexpr std::size_t agents = 1101;  // more than a block, and no multiple of the lanes
  RandomWalk const walk(frames, agents);
  NeighbourLists const lists = next_agents(agents);
  std::vector<std::uint32_t> kinds(agents);
  for (std::size_t i = 0; i < agents; ++i) kinds[i] = i % 2;
  TrajectoryInMemory mixture = walk.view();
  mixture.kinds = kinds;
  DynamicsSettings settings{.wave_number = 0.9, .overlap_length = 1.5};
  settings.neighbours = [&](std::size_t) { return lists; };
  Dynamics const found = find_dynamics(mixture, settings);
  for (std::size_t const lag : {1UL, 3UL, 8UL}) {
    for (std::size_t kind = 0; kind < 2; ++kind) {
      double second = 0.0, fourth = 0.0, scattering = 0.0, near = 0.0, count = 0.0;
      for (std::size_t from = 0; from + lag < frames; ++from) {
        for (std::size_t i = kind; i < agents; i += 2, ++count) {
          auto const moved = [&](std::size_t agent, std::size_t axis) {
            return walk.positions[2 * ((from + lag) * agents + agent) + axis] -
                   walk.positions[2 * (from * agents + agent) + axis];
          };
          double square = 0.0;
          for (std::size_t axis = 0; axis < 2; ++axis) {
            double mean = 0.0;
            for (std::size_t n = 1; n <= i % 4; ++n) mean += moved((i + n) % agents, axis) / static_cast<double>(i % 4);
            square += std::pow(moved(i, axis) - mean, 2);
          }
          second += square;
          fourth += square * square;
          scattering += ::j0(0.9 * std::sqrt(square));
          near += square <= 2.25 ? 1.0 : 0.0;
        }
      }
      DynamicsOfKind const& of_kind = found.kinds[kind];
      EXPECT_NEAR(of_kind.squared_displacement[lag - 1].value, second / count, 1e-12 * second / count);
      EXPECT_NEAR(of_kind.non_gaussian[lag - 1].value, fourth * count / (2.0 * second * second) - 1.0, 1e-11);
      EXPECT_NEAR(of_kind.scattering[lag - 1].value, scattering / count, 1e-9);
      EXPECT_NEAR(of_kind.overlap[lag - 1].value, near / count, 1e-15);
    }
  }
}

TEST(DynamicsOfGlass, OfIndependentWalkersRelativeToSixNeighboursIsSevenSixthsAsLarge) {
  // ⟨Δr²⟩ = 4 D t (1 + 1/6), and the overlap that of a Gaussian with this width.
  constexpr std::size_t agents = 400;
  RandomWalk const walk(60, agents);
  NeighbourLists lists;
  for (std::size_t i = 0; i < agents; ++i) {
    lists.begin.push_back(lists.neighbours.size());
    for (std::size_t n = 1; n <= 6; ++n) lists.neighbours.push_back(static_cast<std::uint32_t>((i + n * n) % agents));
  }
  lists.begin.push_back(lists.neighbours.size());
  DynamicsSettings settings{.overlap_length = 2.0};
  settings.neighbours = [&](std::size_t) { return lists; };
  DynamicsOfKind const found = find_dynamics(walk.view(), settings).kinds[0];
  for (std::size_t const lag : {1UL, 5UL}) {
    double const exact = 2.0 * static_cast<double>(lag) * 7.0 / 6.0;
    auto const expect = [](Estimate const& estimate, double value) {
      EXPECT_LT(std::abs(estimate.value - value), 4.0 * estimate.error.value());
    };
    expect(found.squared_displacement[lag - 1], exact);
    expect(found.overlap[lag - 1], 1.0 - std::exp(-4.0 / exact));
  }
}

TEST(DynamicsOfGlass, RelativeToNeighboursDoesNotSeeWavesThatAllFollow) {
  RandomWalk const walk(12, 50);
  RandomWalk moving = walk;
  for (std::size_t k = 0; k < moving.positions.size(); ++k)
    moving.positions[k] += (k % 2 == 0 ? 50.0 : -20.0) * std::sin(static_cast<double>(k / 100));
  NeighbourLists lists = next_agents(50);
  for (std::uint64_t i = 0; i < 50; ++i) lists.begin[i + 1] = 2 * (i + 1);
  lists.neighbours.resize(100);
  for (std::uint32_t n = 0; n < 100; ++n) lists.neighbours[n] = (n / 2 + n % 2 + 1) % 50;
  DynamicsSettings settings;
  settings.neighbours = [&](std::size_t) { return lists; };
  Dynamics const still = find_dynamics(walk.view(), settings);
  Dynamics const moved = find_dynamics(moving.view(), settings);
  for (std::size_t l = 0; l < 11; ++l) {
    double const value = still.kinds[0].squared_displacement[l].value;
    EXPECT_NEAR(moved.kinds[0].squared_displacement[l].value, value, 1e-12 * value);
  }
}

TEST(DynamicsOfGlass, TakesTheNeighboursAtTheOriginAtUnevenTimesAndWithAnyThreads) {
  RandomWalk const walk(6, 60);
  std::vector<double> const times{0.0, 1.0, 3.0, 4.0, 8.0, 9.0};
  TrajectoryInMemory uneven = walk.view();
  uneven.times = times;
  std::vector<std::size_t> asked;
  DynamicsSettings settings{.wave_number = 1.0, .overlap_length = 1.0};
  settings.neighbours = [&](std::size_t frame) {
    asked.push_back(frame);
    // Agent 0 alone has a neighbour, another one in every frame.
    NeighbourLists lists;
    lists.begin.assign(61, 1);
    lists.begin[0] = 0;
    lists.neighbours.push_back(static_cast<std::uint32_t>(frame + 1));
    return lists;
  };
  std::vector<std::uint32_t> kinds(60, 1);
  kinds[0] = 0;
  uneven.kinds = kinds;
  Dynamics const one = find_dynamics(uneven, settings);
  EXPECT_EQ(asked, (std::vector<std::size_t>{0, 1, 2, 3, 4}));
  settings.threads = 3;
  Dynamics const three = find_dynamics(uneven, settings);
  double expected = 0.0;  // lag 1: from frames 0, 2 and 4
  for (std::size_t const from : {0UL, 2UL, 4UL}) {
    for (std::size_t axis = 0; axis < 2; ++axis) {
      auto const moved = [&](std::size_t agent) {
        return walk.positions[2 * ((from + 1) * 60 + agent) + axis] - walk.positions[2 * (from * 60 + agent) + axis];
      };
      expected += std::pow(moved(0) - moved(from + 1), 2) / 3.0;
    }
  }
  EXPECT_NEAR(one.kinds[0].squared_displacement[0].value, expected, 1e-12 * expected);
  for (std::size_t l = 0; l < one.lag.size(); ++l) {
    EXPECT_EQ(one.kinds[1].squared_displacement[l].value, three.kinds[1].squared_displacement[l].value);
    EXPECT_EQ(one.kinds[1].scattering[l].value, three.kinds[1].scattering[l].value);
    EXPECT_EQ(one.kinds[1].overlap[l].value, three.kinds[1].overlap[l].value);
  }
}

TEST(DynamicsOfGlass, RefusesListsThatAreNotOfTheAgents) {
  RandomWalk const walk(4, 8);
  auto const refuses = [&](auto const& spoil) {
    NeighbourLists lists = next_agents(8);
    spoil(lists);
    DynamicsSettings settings;
    settings.neighbours = [&](std::size_t) { return lists; };
    EXPECT_THROW(find_dynamics(walk.view(), settings), Error);
  };
  refuses([](NeighbourLists& lists) { lists.neighbours[3] = 8; });
  refuses([](NeighbourLists& lists) { lists.begin.pop_back(); });
  refuses([](NeighbourLists& lists) { lists.neighbours.push_back(0); });
  refuses([](NeighbourLists& lists) { lists.begin[3] = 0; });
}

}  // namespace
}  // namespace gridlock
