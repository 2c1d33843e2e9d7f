// The graphics processor, a real one or emulated: the bits, counters and words of the cores of the machine.

#include "gridlock/engine/device.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <string>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/device/neighbour_lists.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/lattice/start.hpp"
#include "reference/tiled_system.hpp"

namespace gridlock {
namespace {

using reference::advance;
using reference::any_tiled_system;
using reference::Ended;
using reference::expect_same;
using reference::TiledSystem;

EngineSettings on_device(EngineSettings settings) {
  settings.device = Device::gpu;
  return settings;
}

class OnDevice : public testing::Test {
  void SetUp() override {
    if (!find_device()) GTEST_SKIP() << "there is no graphics processor";
  }
};

TEST_F(OnDevice, TiledGivesTheBitsAndCountersOfTheCores) {
  reference::expect_same_of_any_system({1, 3}, "threads of a device",
                                       [](TiledSystem const& s, std::size_t threads, State& state, std::uint64_t step) {
                                         return advance(on_device(s.engine), threads, state, step);
                                       });
}

TEST_F(OnDevice, TiledGivesTheSameOfPropelledDisksAndBetweenInnerWalls) {
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    for (double const speed : {0.0, 1.0}) {
      State start = make_start(Box(1.3, 1.0, edge, Edge::wall),
                               {.count = 2000, .packing_fraction = 0.45, .region = {0.2, 0.0, 0.54, 0.7}}, 3);
      draw_velocities(start, {});
      EngineSettings settings{.kind = "tiled", .threads = 1};
      settings.propulsion = {.speed = speed, .rotational_diffusion = 2.0};
      settings.walls = {{.from = {0.2, 0.0}, .to = {0.2, 0.8}}, {.from = {0.55, 0.3}, .to = {0.75, 0.5}}};
      State cores = start;
      State device = start;
      Ended const expected = advance(settings, 2, cores, 60);
      ASSERT_EQ(expected.failure, "");
      Ended const ended = advance(on_device(settings), 2, device, 60);
      ASSERT_NO_FATAL_FAILURE(expect_same(expected, ended, "speed " + std::to_string(speed)));
      EXPECT_GT(expected.counters.inner_wall_hits, 0U);
      EXPECT_EQ(ended.counters.inner_wall_hits, expected.counters.inner_wall_hits);
      EXPECT_EQ(ended.counters.inner_wall_impulse, expected.counters.inner_wall_impulse);
      EXPECT_EQ(ended.counters.swum, expected.counters.swum);
      EXPECT_EQ(ended.counters.swum_if_free, expected.counters.swum_if_free);
    }
  }
}

TEST_F(OnDevice, ARunGoesOnWhereTheCoresEndedAndBack) {
  for (std::uint64_t const seed : {2U, 3U, 5U}) {
    TiledSystem s = any_tiled_system(seed);
    s.fastest = 1.0;
    s.engine.time_step = 0.05;
    State whole = s.start();
    State cut = whole;
    Ended const expected = advance(s.engine, 1, whole, 120);
    ASSERT_EQ(expected.failure, "");
    Counters counters;
    for (std::uint64_t step = 20; step <= 120; step += 20) {
      EngineSettings const settings = step % 40 == 0 ? s.engine : on_device(s.engine);
      make_engine(settings, cut)->advance(cut, counters, {.step = step});
    }
    EXPECT_EQ(hash(cut), expected.hash);
    EXPECT_EQ(counters.pair_collisions, expected.counters.pair_collisions);
  }
}

TEST_F(OnDevice, TheVariableOfTheEnvironmentIsTheSetting) {
  EXPECT_EQ(device_of(Device::cpu), Device::cpu);
  setenv("GRIDLOCK_DEVICE", "gpu", 1);
  EXPECT_EQ(device_of(Device::cpu), Device::gpu);
  setenv("GRIDLOCK_DEVICE", "cpu", 1);
  EXPECT_EQ(device_of(Device::gpu), Device::cpu);
  setenv("GRIDLOCK_DEVICE", "tpu", 1);
  EXPECT_THROW(device_of(Device::gpu), Error);
  unsetenv("GRIDLOCK_DEVICE");
}

TEST_F(OnDevice, DisksThatDoNotFitAreRefusedWithTheNumberThatDoes) {
  State state = make_start(Box(1.0, 1.0, Edge::periodic), {.count = 10'000, .packing_fraction = 0.5}, 1);
  draw_velocities(state, {});
  setenv("GRIDLOCK_DEVICE_MEMORY", "1000000", 1);
  std::string what;
  std::string hint;
  try {
    make_engine(on_device({.kind = "tiled"}), state);
  } catch (Error const& error) {
    what = error.problems().front().what;
    hint = error.problems().front().hint;
  }
  EXPECT_NE(what.find("10000 disks need "), std::string::npos) << what;
  EXPECT_NE(hint.find("use at most about "), std::string::npos) << hint;
  std::size_t const fits = std::stoul(hint.substr(hint.find("about ") + 6));
  EXPECT_GT(fits, 1000U);
  State fewer = make_start(Box(1.0, 1.0, Edge::periodic), {.count = fits * 9 / 10, .packing_fraction = 0.5}, 1);
  draw_velocities(fewer, {});
  EXPECT_NO_THROW(make_engine(on_device({.kind = "tiled"}), fewer));
  for (char const* const wrong : {"much", "-5", " -5", "1e9", "99999999999999999999"}) {
    setenv("GRIDLOCK_DEVICE_MEMORY", wrong, 1);
    EXPECT_THROW(find_device(), Error) << wrong;
  }
  unsetenv("GRIDLOCK_DEVICE_MEMORY");
}

/// Points in and around a box, some of them at the same place.
std::vector<double> points_around(Box const& box, std::size_t count, double beyond, RandomStream& random) {
  std::vector<double> xy;
  for (std::size_t i = 0; i < count; ++i) {
    xy.push_back(box.width() * (-beyond + (1.0 + 2.0 * beyond) * random.uniform()));
    xy.push_back(box.height() * (-beyond + (1.0 + 2.0 * beyond) * random.uniform()));
  }
  for (std::size_t i = 0; i + 3 < xy.size(); i += 50) xy[i + 2] = xy[i], xy[i + 3] = xy[i + 1];
  return xy;
}

TEST_F(OnDevice, NeighboursAndPairsAreThoseOfTheCoresInTheSameOrder) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    RandomStream random(seed, 0, 0, Purpose::start_position);
    auto const edge = [&] { return random.below(2) == 0 ? Edge::wall : Edge::periodic; };
    Box const box(0.5 + random.uniform(), 0.5 + random.uniform(), edge(), edge());
    // From hundreds of cells to three, where the cores search; a crowd, where they do as well.
    double const cutoff = random.below(4) == 0 ? 0.2 : 0.01 + 0.04 * random.uniform();
    std::vector<double> xy = points_around(box, random.below(3000), random.below(2) == 0 ? 0.0 : 0.4, random);
    if (random.below(4) == 0) {
      for (double& p : xy) p *= 0.01;
    }
    PointsInMemory const points{.x = xy.data(), .y = xy.data() + 1, .count = xy.size() / 2, .stride = 2};
    PointPairs const expected = find_pairs(box, cutoff, points);
    PointPairs const found = find_pairs_on_device(box, cutoff, points);
    ASSERT_TRUE(std::ranges::equal(found.indices, expected.indices)) << "seed " << seed;
    NeighbourLists const expected_lists = find_neighbour_lists(box, cutoff, points);
    NeighbourLists const lists = find_neighbour_lists_on_device(box, cutoff, points);
    ASSERT_EQ(lists.begin, expected_lists.begin) << "seed " << seed;
    ASSERT_TRUE(std::ranges::equal(lists.neighbours, expected_lists.neighbours)) << "seed " << seed;
  }
}

TEST_F(OnDevice, PointsThatDoNotFitOrAreNoNumbersAreRefused) {
  std::vector<double> xy(2000, 0.5);
  RandomStream random(1, 0, 0, Purpose::start_position);
  for (double& p : xy) p = random.uniform();
  PointsInMemory const points{.x = xy.data(), .y = xy.data() + 1, .count = xy.size() / 2, .stride = 2};
  Box const box(1.0, 1.0, Edge::periodic);
  setenv("GRIDLOCK_DEVICE_MEMORY", "1000", 1);
  EXPECT_THROW(find_pairs_on_device(box, 0.01, points), Error);
  // Enough for the points, and not for 63,000 pairs besides.
  setenv("GRIDLOCK_DEVICE_MEMORY", "400000", 1);
  EXPECT_NO_THROW(find_pairs_on_device(box, 0.01, points));
  EXPECT_THROW(find_pairs_on_device(box, 0.2, points), Error);
  unsetenv("GRIDLOCK_DEVICE_MEMORY");
  EXPECT_THROW(find_pairs_on_device(box, 0.6, points), Error);
  xy[77] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(find_neighbour_lists_on_device(box, 0.01, points), Error);
}

}  // namespace
}  // namespace gridlock
