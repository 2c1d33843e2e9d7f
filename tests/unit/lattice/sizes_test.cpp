// Disks of continuous sizes, and starts that overlap.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/grid/validate.hpp"
#include "gridlock/lattice/start.hpp"
#include "unit/lattice/refusal.hpp"

namespace gridlock {
namespace {

DisksSettings sizes_of(SizeDistribution sizes, std::uint64_t count, double spread) {
  return {.count = count, .packing_fraction = 0.4, .sizes = sizes, .size_spread = spread, .start = StartKind::random};
}

std::vector<double> sorted_radii(State const& state) {
  auto const radii = state.agents.column<Radius>();
  std::vector<double> sorted(radii.begin(), radii.end());
  std::ranges::sort(sorted);
  return sorted;
}

struct SizeMoments {
  double mean = 0.0;
  double spread = 0.0;
};

SizeMoments size_moments_of(std::vector<double> const& values) {
  SizeMoments moments;
  double squares = 0.0;
  for (double const v : values) moments.mean += v / static_cast<double>(values.size());
  for (double const v : values) squares += (v - moments.mean) * (v - moments.mean) / static_cast<double>(values.size());
  moments.spread = std::sqrt(squares) / moments.mean;
  return moments;
}

TEST(Sizes, HaveTheSpreadThePackingFractionAndTheMassesAskedFor) {
  for (auto const sizes : {SizeDistribution::inverse_cube, SizeDistribution::uniform, SizeDistribution::normal}) {
    for (double const spread : {0.05, 0.23, 0.3}) {
      State const state = make_start(Box(1.0, 1.0, Edge::periodic), sizes_of(sizes, 20'000, spread), 3);
      SizeMoments const moments = size_moments_of(sorted_radii(state));
      EXPECT_NEAR(moments.spread, spread, 2e-3 * spread) << static_cast<int>(sizes);
      EXPECT_NEAR(covered_area(state.agents), 0.4, 1e-12);
      EXPECT_NO_THROW(validate(state));
      EXPECT_TRUE(std::ranges::all_of(state.agents.column<Mass>(), [](double m) { return m == 1.0; }));
    }
  }
}

// P(σ) = A σ⁻³ from a to b: the share below σ is (1 − a²/σ²)/(1 − a²/b²), and ⟨σ⟩ = 2 a b/(a + b).
TEST(Sizes, OfTheInverseCubeHaveItsShares) {
  State const state =
      make_start(Box(1.0, 1.0, Edge::periodic), sizes_of(SizeDistribution::inverse_cube, 4000, 0.23), 3);
  std::vector<double> const radii = sorted_radii(state);
  double const ratio = 2.2277061;  // √(½ ln λ (λ + 1)/(λ − 1) − 1) = 0.23
  EXPECT_NEAR(std::sqrt(0.5 * std::log(ratio) * (ratio + 1.0) / (ratio - 1.0) - 1.0), 0.23, 1e-7);
  EXPECT_NEAR(radii.back() / radii.front(), ratio, 2e-3 * ratio);
  double const mean = size_moments_of(radii).mean;
  double const a = mean * (1.0 + ratio) / (2.0 * ratio);
  double const b = a * ratio;
  for (double const sigma : {1.1 * a, 1.3 * a, 1.6 * a, 2.0 * a}) {
    double const expected = (1.0 - a * a / (sigma * sigma)) / (1.0 - a * a / (b * b));
    auto const below = static_cast<double>(std::ranges::lower_bound(radii, sigma) - radii.begin());
    EXPECT_NEAR(below / 4000.0, expected, 1e-3) << sigma / a;
  }
}

TEST(Sizes, OfTheNormalDistributionHaveItsShares) {
  State const state = make_start(Box(1.0, 1.0, Edge::periodic), sizes_of(SizeDistribution::normal, 4000, 0.1), 3);
  std::vector<double> const radii = sorted_radii(state);
  double const mean = size_moments_of(radii).mean;
  double const deviation = 0.1 * mean / 0.986578;  // before it is cut off
  double const within = std::erf(3.0 / std::numbers::sqrt2);
  for (double const x : {-2.5, -1.0, 0.3, 2.0}) {
    double const expected = 0.5 + 0.5 * std::erf(x / std::numbers::sqrt2) / within;
    auto const below = static_cast<double>(std::ranges::lower_bound(radii, mean + x * deviation) - radii.begin());
    EXPECT_NEAR(below / 4000.0, expected, 1e-3) << x;
  }
  EXPECT_NEAR(radii.front(), mean - 3.0 * deviation, 0.05 * deviation);
}

TEST(Sizes, AreTheSameForEverySeedAndDealtOutByIt) {
  DisksSettings const disks = sizes_of(SizeDistribution::inverse_cube, 300, 0.23);
  Box const box(1.0, 1.0, Edge::periodic);
  State const one = make_start(box, disks, 1);
  State const other = make_start(box, disks, 2);
  EXPECT_EQ(hash(one), hash(make_start(box, disks, 1)));
  EXPECT_EQ(sorted_radii(one), sorted_radii(other));
  EXPECT_FALSE(std::ranges::equal(one.agents.column<Radius>(), other.agents.column<Radius>()));
  // In no order of sizes: the first half of the Ids has the mean of all.
  auto const radii = one.agents.column<Radius>();
  SizeMoments const half = size_moments_of({radii.begin(), radii.begin() + 150});
  EXPECT_NEAR(half.mean / size_moments_of(sorted_radii(one)).mean, 1.0, 4.0 * 0.23 / std::sqrt(150.0));
}

TEST(Sizes, TakeTheRadiusAsTheirMean) {
  DisksSettings disks = sizes_of(SizeDistribution::uniform, 100, 0.2);
  disks.packing_fraction = std::nullopt;
  disks.radius = 0.02;
  disks.start = StartKind::triangular;
  State const state = make_start(Box(1.0, 1.0, Edge::wall), disks, 1);
  EXPECT_NEAR(size_moments_of(sorted_radii(state)).mean, 0.02, 1e-15);
  EXPECT_NO_THROW(validate(state));
}

TEST(Sizes, ThatContradictEachOtherAreRefusedWithAHint) {
  DisksSettings both = sizes_of(SizeDistribution::uniform, 100, 0.2);
  both.species = {{.fraction = 0.5}, {.fraction = 0.5, .size_ratio = 1.4}};
  EXPECT_EQ(refusal_of(both).key, "disks.sizes");
  Problem const spread_of_equal = refusal_of(sizes_of(SizeDistribution::equal, 100, 0.2));
  EXPECT_EQ(spread_of_equal.key, "disks.size_spread");
  EXPECT_NE(spread_of_equal.hint.find("inverse_cube"), std::string::npos);
}

TEST(Sizes, WiderThanADistributionCanBeAreRefusedWithAnUpperBoundThatWorks) {
  for (auto const sizes : {SizeDistribution::uniform, SizeDistribution::normal}) {
    Problem const problem = refusal_of(sizes_of(sizes, 100, 0.6));
    EXPECT_EQ(problem.key, "disks.size_spread");
    std::string const words = "below ";
    double const most = std::stod(problem.hint.substr(problem.hint.find(words) + words.size()));
    EXPECT_GT(most, 0.3);
    State const state = make_start(Box(1.0, 1.0, Edge::periodic), sizes_of(sizes, 100, most - 1e-9), 1);
    EXPECT_GT(radius_range(state.agents).smallest, 0.0);
  }
  // The tail of σ⁻³ has no such bound.
  State const wide = make_start(Box(1.0, 1.0, Edge::periodic), sizes_of(SizeDistribution::inverse_cube, 50, 0.99), 1);
  EXPECT_NO_THROW(validate(wide));
}

TEST(UniformStart, HasThePackingFractionAskedForAndOverlaps) {
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    for (double const packing_fraction : {0.3, 0.86, 2.0}) {
      Box const box(2.0, 1.5, edge);
      DisksSettings const disks{.count = 200, .packing_fraction = packing_fraction, .start = StartKind::uniform};
      State const state = make_start(box, disks, 4);
      EXPECT_NEAR(covered_area(state.agents) / box.area(), packing_fraction, 1e-12);
      EXPECT_GT(largest_overlap(state), 0.0);
      EXPECT_NO_THROW(validate(state, {.overlap = 10.0})) << "they lie inside";
    }
  }
}

TEST(UniformStart, IsUniformAndAFunctionOfTheSeed) {
  Box const box(1.0, 1.0, Edge::periodic);
  DisksSettings const disks{.count = 10'000, .packing_fraction = 0.9, .start = StartKind::uniform};
  State const state = make_start(box, disks, 4);
  EXPECT_EQ(hash(state), hash(make_start(box, disks, 4)));
  EXPECT_NE(hash(state), hash(make_start(box, disks, 5)));
  // χ² of 100 squares: mean 99, variance 198.
  std::vector<double> counts(100, 0.0);
  for (std::size_t i = 0; i < state.agents.size(); ++i) {
    Vector const p = position(state.agents, i);
    ++counts[static_cast<std::size_t>(10.0 * p.x) + 10 * static_cast<std::size_t>(10.0 * p.y)];
  }
  double chi_squared = 0.0;
  for (double const count : counts) chi_squared += (count - 100.0) * (count - 100.0) / 100.0;
  EXPECT_NEAR(chi_squared, 99.0, 4.0 * std::sqrt(198.0));
}

TEST(UniformStart, IsRefusedByHardDisksWithWhatToDo) {
  DisksSettings const disks{.count = 100, .packing_fraction = 0.86, .start = StartKind::uniform};
  try {
    validate(make_start(Box(1.0, 1.0, Edge::periodic), disks, 4));
    ADD_FAILURE() << "disks that overlap are valid";
  } catch (Error const& error) {
    EXPECT_NE(error.problems().front().hint.find("quench"), std::string::npos) << error.what();
  }
}

TEST(UniformStart, OfDisksWiderThanTheBoxIsRefused) {
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    DisksSettings const disks{.count = 1, .packing_fraction = 1.5, .start = StartKind::uniform};
    EXPECT_NE(refusal_of(disks, edge).what.find("does not fit into the box"), std::string::npos);
  }
}

TEST(OtherStarts, RefusePackingFractionsThatOnlyDisksThatOverlapHave) {
  DisksSettings disks = sizes_of(SizeDistribution::inverse_cube, 100, 0.23);
  disks.packing_fraction = 1.1;
  EXPECT_NE(refusal_of(disks).hint.find("\"uniform\""), std::string::npos);
}

}  // namespace
}  // namespace gridlock
