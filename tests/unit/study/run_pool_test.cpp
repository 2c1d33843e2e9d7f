#include "study/run_pool.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "gridlock/core/error.hpp"
#include "gridlock/grid/validate.hpp"

namespace gridlock {
namespace {

StudyRun small_run(std::uint64_t seed, std::uint64_t steps = 20) {
  StudyRun run;
  run.configuration.disks = {.count = 25, .packing_fraction = 0.4};
  run.configuration.run = {.steps = steps, .seed = seed};
  run.configuration.observe = {.every = 10, .structure_every = 0};
  return run;
}

TEST(RunPool, DoesTheSameRunOnce) {
  RunPool pool;
  pool.add(small_run(1));
  pool.add(small_run(2));
  pool.add(small_run(1));
  EXPECT_EQ(pool.size(), 2U);
  EXPECT_DOUBLE_EQ(pool.work(), 2.0 * 25.0 * 20.0);
}

TEST(RunPool, ExpectsExactDisksToCostMoreTheDenserTheyAre) {
  auto const work_at = [](double packing_fraction) {
    StudyRun run = small_run(1);
    run.configuration.engine.kind = "exact";
    run.configuration.disks.packing_fraction = packing_fraction;
    RunPool pool;
    pool.add(run);
    return pool.work() / (25.0 * 20.0);
  };
  // Seconds of runs of 841 disks beside those of the paper's rule: 0.15, 0.47 and 2.02 to 0.35, 0.43 and 0.55.
  EXPECT_NEAR(work_at(0.3), 0.15 / 0.35, 0.2 * 0.15 / 0.35);
  EXPECT_NEAR(work_at(0.6), 0.47 / 0.43, 0.2 * 0.47 / 0.43);
  EXPECT_NEAR(work_at(0.8), 2.02 / 0.55, 0.4 * 2.02 / 0.55);
}

TEST(RunPool, TellsRunsApartByTheirSites) {
  RunPool pool;
  pool.add(small_run(1));
  StudyRun other = small_run(1);
  other.sites = Sites::to_walls;
  pool.add(other);
  EXPECT_EQ(pool.size(), 2U);
}

TEST(RunPool, GivesTheSameBitsOnAnyNumberOfThreads) {
  auto const hashes = [](unsigned threads) {
    RunPool pool;
    for (std::uint64_t seed = 0; seed < 6; ++seed) pool.add(small_run(seed, 10 * (seed + 1)));
    pool.run_all(threads, {});
    std::vector<std::uint64_t> all;
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
      StudyOutcome const& outcome = pool.outcome_of(small_run(seed, 10 * (seed + 1)));
      EXPECT_TRUE(outcome.is_finished);
      EXPECT_EQ(outcome.steps.back(), static_cast<double>(10 * (seed + 1)));
      all.push_back(outcome.state_hash);
    }
    return all;
  };
  EXPECT_EQ(hashes(1), hashes(3));
}

TEST(RunPool, ReportsUpToTheWholeWork) {
  RunPool pool;
  for (std::uint64_t seed = 0; seed < 4; ++seed) pool.add(small_run(seed));
  double last = 0.0;
  std::size_t finished = 0;
  pool.run_all(2, [&](double fraction, std::size_t runs) {
    EXPECT_GE(fraction, last);
    last = fraction;
    finished = std::max(finished, runs);
    return true;
  });
  EXPECT_DOUBLE_EQ(last, 1.0);
  EXPECT_EQ(finished, 4U);
}

TEST(RunPool, StopsWhenAskedAndKeepsOnlyFinishedRuns) {
  RunPool pool;
  for (std::uint64_t seed = 0; seed < 5; ++seed) pool.add(small_run(seed));
  pool.run_all(1, [](double, std::size_t finished) { return finished < 2; });
  EXPECT_EQ(pool.rows().row_count(), 2U);
  EXPECT_TRUE(pool.failures().empty());
}

TEST(RunPool, RecordsARunThatCannotBeSetUpAndGoesOn) {
  RunPool pool;
  StudyRun impossible = small_run(1);
  impossible.configuration.disks.packing_fraction = 0.8;
  pool.add(impossible);
  pool.add(small_run(2));
  pool.run_all(1, {});
  ASSERT_EQ(pool.failures().size(), 1U);
  EXPECT_NE(pool.failures().front().find("square"), std::string::npos);
  EXPECT_TRUE(pool.outcome_of(small_run(2)).is_finished);
}

TEST(SquareSitesToWalls, PutTheOutermostDisksAgainstTheWalls) {
  SiteList const list = square_sites_to_walls(2.0, 49, 0.1);
  ASSERT_EQ(list.sites.size(), 49U);
  EXPECT_EQ(list.sites.front(), (Vector{0.1, 0.1}));
  EXPECT_EQ(list.sites.back(), (Vector{1.9, 1.9}));
  EXPECT_NEAR(list.sites[1].x - list.sites[0].x, 1.8 / 6.0, 1e-15);
  EXPECT_THROW(square_sites_to_walls(2.0, 50, 0.1), Error);
}

TEST(PerfectTriangularSites, ReachThePackingFractionOfThePhysicsReference) {
  SiteList const list = perfect_triangular_sites(1.0, 841);
  ASSERT_EQ(list.sites.size(), 841U);
  EXPECT_NEAR(841.0 * std::numbers::pi * list.radius * list.radius, 0.8518, 5e-5);
}

TEST(StudyRun, OnOtherSitesIsAValidStart) {
  for (auto const& [start, sites, density] :
       {std::tuple{StartKind::square, Sites::to_walls, 0.78}, {StartKind::triangular, Sites::perfect, 0.85}}) {
    StudyRun run = small_run(1);
    run.configuration.disks = {.count = 841, .packing_fraction = density, .start = start};
    run.sites = sites;
    State const state = disks_of(set_up(run));
    EXPECT_NO_THROW(validate(state));
    run.sites = Sites::fitted;
    EXPECT_NE(hash(state), hash(disks_of(set_up(run))));
  }
  StudyRun too_dense = small_run(1);
  too_dense.configuration.disks = {.count = 841, .packing_fraction = 0.86, .start = StartKind::triangular};
  too_dense.sites = Sites::perfect;
  EXPECT_THROW(set_up(too_dense), Error);
}

}  // namespace
}  // namespace gridlock
