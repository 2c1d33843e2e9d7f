#include "study/falling.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "gridlock/core/random.hpp"
#include "observe/mean_over_runs.hpp"

namespace gridlock {
namespace {

constexpr double level = 0.1;

std::vector<MeanOfRuns> with_errors(std::vector<Estimate> const& means, std::size_t runs = 3) {
  std::vector<MeanOfRuns> values;
  for (Estimate const& mean : means) values.push_back({.mean = mean, .runs = runs});
  return values;
}

/// Made-up runs: normal about each truth, with the same relative scatter.
std::vector<MeanOfRuns> simulated(std::vector<double> const& truths, double scatter, std::size_t runs,
                                  RandomStream& random) {
  std::vector<MeanOfRuns> values;
  for (double const truth : truths) {
    std::vector<double> of_runs(runs);
    std::ranges::generate(of_runs, [&] { return truth * (1.0 + scatter * random.normal()); });
    values.push_back({.mean = mean_over_runs(of_runs), .runs = runs});
  }
  return values;
}

/// How often a verdict comes out in 1000 made-up studies.
int count_of(Verdict verdict, std::vector<double> const& truths, double scatter, std::size_t runs) {
  RandomStream random(29, 0, 0, Purpose::start_position);
  int count = 0;
  for (int n = 0; n < 1000; ++n) {
    if (verdict_on_fall(simulated(truths, scatter, runs, random), level) == verdict) ++count;
  }
  return count;
}

TEST(Falling, AgreesWhereEveryValueLiesBelowTheOneBefore) {
  EXPECT_EQ(verdict_on_fall(with_errors({{0.5, 0.01}, {0.3, 0.01}, {0.05, 0.001}}), level), Verdict::agrees);
}

TEST(Falling, TakesRisesWithinTheErrorsForChance) {
  // A plateau whose points differ by what their errors say.
  EXPECT_EQ(verdict_on_fall(with_errors({{0.516, 0.004}, {0.524, 0.006}, {0.515, 0.004}, {0.05, 0.001}}), level),
            Verdict::agrees);
}

TEST(Falling, DiffersWhereValuesRiseBeyondTheirErrors) {
  EXPECT_EQ(verdict_on_fall(with_errors({{0.5, 0.004}, {0.6, 0.004}, {0.05, 0.001}}), level), Verdict::differs);
}

TEST(Falling, DiffersWhereSmallRisesAddUp) {
  // Each step is within its error, 6.6 · √2 · 0.004 = 0.037, and the way from the first to the fourth is not.
  EXPECT_EQ(
      verdict_on_fall(with_errors({{0.50, 0.004}, {0.52, 0.004}, {0.54, 0.004}, {0.56, 0.004}, {0.05, 0.001}}), level),
      Verdict::differs);
}

TEST(Falling, DiffersWhereTheLastLiesAboveTheLevel) {
  EXPECT_EQ(verdict_on_fall(with_errors({{0.5, 0.001}, {0.3, 0.001}}), level), Verdict::differs);
}

TEST(Falling, IsUndecidedWithoutErrors) {
  // One run at each density: whether it rises by chance cannot be told, nor whether it falls.
  EXPECT_EQ(verdict_on_fall(with_errors({{0.516}, {0.524}, {0.05}}, 1), level), Verdict::undecided);
  EXPECT_EQ(verdict_on_fall(with_errors({{0.5}, {0.3}, {0.05}}, 1), level), Verdict::undecided);
  EXPECT_EQ(verdict_on_fall({}, level), Verdict::undecided);
}

TEST(Falling, IsUndecidedWhereErrorsHideTheFallOrTheLevel) {
  EXPECT_EQ(verdict_on_fall(with_errors({{0.09, 0.01}, {0.05, 0.01}}), level), Verdict::undecided);
  EXPECT_EQ(verdict_on_fall(with_errors({{0.5, 0.001}, {0.09, 0.001}}), level), Verdict::undecided);
}

TEST(Falling, SeldomMistakesChanceOnAPlateauForARise) {
  // Six pairs on the plateau, each mistaken in 0.14 % of all cases; the scatter of single runs is the one measured there.
  std::vector<double> const truths{0.52, 0.52, 0.52, 0.52, 0.14, 0.01};
  for (std::size_t const runs : {2U, 3U, 8U}) EXPECT_LE(count_of(Verdict::differs, truths, 0.02, runs), 20) << runs;
}

TEST(Falling, FindsARealFallAndARealRiseInNearlyEveryStudy) {
  EXPECT_GE(count_of(Verdict::agrees, {0.52, 0.52, 0.33, 0.14, 0.01}, 0.05, 4), 950);
  EXPECT_GE(count_of(Verdict::differs, {0.30, 0.52, 0.33, 0.14, 0.01}, 0.05, 4), 950);
}

}  // namespace
}  // namespace gridlock
