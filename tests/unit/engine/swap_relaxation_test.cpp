#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "engine/swap/relaxation.hpp"
#include "io/checkpoint.hpp"

namespace gridlock {
namespace {

/// Disks near the places of a square lattice of spacing 1; `is_turned` takes x for y.
State jittered_lattice(int columns, int rows, bool is_turned, unsigned seed = 3) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> jitter(-0.15, 0.15);
  State state{.box = is_turned ? Box(rows, columns, Edge::periodic) : Box(columns, rows, Edge::periodic),
              .clock = {},
              .seed = 1};
  for (int k = 0; k < columns * rows; ++k) {
    double const x = k % columns + 0.5 + jitter(random);
    double const y = k / columns + 0.5 + jitter(random);
    state.agents.add(is_turned ? y : x, is_turned ? x : y, 0.0, 0.0, 0.3, 1.0, 0, 0);
  }
  return state;
}

/// All disks together, around the edges.
State moved(State state, Vector by) {
  Disks& disks = state.agents;
  for (std::size_t i = 0; i < disks.size(); ++i) {
    int image_x = disks.column<ImageX>()[i];
    int image_y = disks.column<ImageY>()[i];
    Vector const p = state.box.wrap(Vector{disks.column<X>()[i], disks.column<Y>()[i]} + by, image_x, image_y);
    disks.column<X>()[i] = p.x;
    disks.column<Y>()[i] = p.y;
    disks.column<ImageX>()[i] = image_x;
    disks.column<ImageY>()[i] = image_y;
  }
  return state;
}

TEST(SwapRelaxation, IsNoneWhereAllDisksMoveTogetherAcrossTheEdges) {
  // Of the last 5000 disks every second one is watched.
  for (auto const& [columns, rows] : {std::pair(12, 5), std::pair(5, 12), std::pair(100, 50)}) {
    State const start = jittered_lattice(columns, rows, false);
    Relaxation relaxation(start, 100);
    relaxation.look_at(SwapTrials(start), 0);
    relaxation.look_at(SwapTrials(moved(start, {0.8, 0.0})), 1);
    relaxation.look_at(SwapTrials(moved(start, {0.0, 0.9})), 2);
    ASSERT_EQ(relaxation.correlations().size(), 2U);
    for (SwapCorrelation const& correlation : relaxation.correlations()) {
      EXPECT_EQ(correlation.self_overlap, 1.0) << columns << " × " << rows;
      EXPECT_NEAR(correlation.bond_orientation, 1.0, 1e-9);
    }
  }
}

TEST(SwapRelaxation, OfATallBoxIsThatOfTheWideOneTurned) {
  // Two rows: in so flat a box neighbours are nearer than half its shorter side.
  for (int const rows : {2, 3, 8}) {
    std::vector<SwapCorrelation> found;
    for (bool const is_turned : {false, true}) {
      State const start = jittered_lattice(11, rows, is_turned);
      Relaxation relaxation(start, 100);
      relaxation.look_at(SwapTrials(start), 0);
      relaxation.look_at(SwapTrials(jittered_lattice(11, rows, is_turned, 8)), 1);
      found.push_back(relaxation.correlations().at(0));
    }
    EXPECT_EQ(found[0].self_overlap, found[1].self_overlap) << rows;
    EXPECT_NEAR(found[0].bond_orientation, found[1].bond_orientation, 1e-12) << rows;
    EXPECT_LT(found[0].self_overlap, 1.0);
  }
}

TEST(SwapRelaxation, IsLookedAtAfterPowersOfTwoAndThreeTimesThem) {
  State const start = jittered_lattice(6, 4, false);
  SwapTrials const trials(start);
  Relaxation relaxation(start, 1600);  // origins are 100 sweeps apart
  for (std::uint64_t sweep = 0; sweep <= 300; ++sweep) relaxation.look_at(trials, sweep);
  std::vector<std::uint64_t> lags;
  std::vector<std::uint64_t> origins;
  for (SwapCorrelation const& correlation : relaxation.correlations()) {
    lags.push_back(correlation.lag);
    origins.push_back(correlation.origins);
  }
  EXPECT_EQ(lags, (std::vector<std::uint64_t>{1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 100, 200, 300}));
  EXPECT_EQ(origins, (std::vector<std::uint64_t>{3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 2, 1}));
}

TEST(SwapRelaxation, GoesOnFromACheckpoint) {
  State const start = jittered_lattice(9, 6, false);
  Relaxation whole(start, 100);
  Relaxation restored(start, 100);
  for (std::uint64_t sweep = 0; sweep <= 30; ++sweep) {
    SwapTrials const trials(jittered_lattice(9, 6, false, 3 + static_cast<unsigned>(sweep)));
    whole.look_at(trials, sweep);
    restored.look_at(trials, sweep);
    std::string const saved =
        to_checkpoint([&](Archive& archive) { restored.serialize(archive, start.agents.size(), sweep); });
    restored = Relaxation(start, 100);
    from_checkpoint(saved, "saved", [&](Archive& archive) { restored.serialize(archive, start.agents.size(), sweep); });
  }
  std::vector<SwapCorrelation> const expected = whole.correlations();
  std::vector<SwapCorrelation> const found = restored.correlations();
  ASSERT_EQ(found.size(), expected.size());
  ASSERT_GT(expected.size(), 5U);
  for (std::size_t k = 0; k < expected.size(); ++k) {
    EXPECT_EQ(found[k].lag, expected[k].lag);
    EXPECT_EQ(found[k].origins, expected[k].origins);
    EXPECT_EQ(found[k].self_overlap, expected[k].self_overlap);
    EXPECT_EQ(found[k].bond_orientation, expected[k].bond_orientation);
  }
}

TEST(SwapRelaxation, TimeIsWhereAStraightLineBetweenTwoLagsMeetsTheLevel) {
  double const end = std::exp(-1.0);
  auto const time_of = [](std::vector<double> const& values) {
    std::vector<SwapCorrelation> correlations;
    for (std::size_t k = 0; k < values.size(); ++k)
      correlations.push_back({.lag = 2 * (k + 1), .origins = 1, .self_overlap = values[k]});
    return relaxation_time(correlations, &SwapCorrelation::self_overlap);
  };
  EXPECT_NEAR(*time_of({0.9, end + 0.1, end - 0.3, 0.0}), 4.0 + 2.0 * 0.25, 1e-12);
  EXPECT_NEAR(*time_of({end - 0.2}), 2.0 * (1.0 - end) / (1.2 - end), 1e-12) << "from 1 at no lag";
  EXPECT_EQ(time_of({0.9, 0.8, 0.5}), std::nullopt);
}

}  // namespace
}  // namespace gridlock
