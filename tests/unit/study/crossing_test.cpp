#include "study/crossing.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "gridlock/core/random.hpp"

namespace gridlock {
namespace {

std::vector<CurvePoint> exponential(std::vector<double> const& xs, double error = 0.0) {
  std::vector<CurvePoint> points;
  for (double const x : xs) {
    Estimate y{.value = std::exp(-10.0 * (x - 0.5))};
    if (error > 0.0) y.error = error * y.value;
    points.push_back({x, y});
  }
  return points;
}

TEST(Crossing, OfAnExponentialIsExactWhereverThePointsLie) {
  for (auto const& xs : {std::vector{0.1, 0.9}, {0.1, 0.6, 0.75, 0.8}, {0.0, 0.2, 0.73, 0.9}}) {
    Crossing const crossing = find_crossing(exponential(xs), 0.1);
    ASSERT_EQ(crossing.kind, CrossingKind::crossed);
    EXPECT_NEAR(crossing.x, 0.5 + std::log(10.0) / 10.0, 1e-12);
    EXPECT_EQ(crossing.statistical, 0.0);
    EXPECT_FALSE(crossing.comes_back);
  }
}

TEST(Crossing, NamesThePointsAroundIt) {
  Crossing const crossing = find_crossing(exponential({0.1, 0.6, 0.75, 0.8}), 0.1);
  EXPECT_EQ(crossing.last_above, 0.6);
  EXPECT_EQ(crossing.first_below, 0.75);
}

TEST(Crossing, SaysHowFarAStraightLineWouldPutItElsewhere) {
  // y falls from 1 to 0.01 over [0, 1]; the level is met at ½ on the logarithmic line and at 0.9/0.99 on the straight one.
  std::vector<CurvePoint> const points{{0.0, {1.0}}, {1.0, {0.01}}};
  Crossing const crossing = find_crossing(points, 0.1);
  EXPECT_NEAR(crossing.x, 0.5, 1e-12);
  EXPECT_NEAR(crossing.interpolation, 0.9 / 0.99 - 0.5, 1e-12);
  EXPECT_NEAR(crossing.error(), crossing.interpolation, 1e-15);
}

TEST(Crossing, StandardErrorIsTheScatterOfCrossingsOfNoisyCurves) {
  double const noise = 0.02;
  std::vector<double> const xs{0.1, 0.7, 0.8, 0.9};
  double sum = 0.0;
  double squares = 0.0;
  constexpr int curves = 4000;
  RandomStream random(11, 0, 0, Purpose::start_position);
  for (int n = 0; n < curves; ++n) {
    std::vector<CurvePoint> points = exponential(xs);
    for (CurvePoint& point : points) point.y.value *= std::exp(noise * random.normal());
    double const x = find_crossing(points, 0.1).x;
    sum += x;
    squares += x * x;
  }
  double const scatter = std::sqrt(squares / curves - sum * sum / curves / curves);
  // The scatter of 4000 curves is itself known to 1/√8000 = 1.1 %.
  EXPECT_NEAR(find_crossing(exponential(xs, noise), 0.1).statistical, scatter, 0.05 * scatter);
}

TEST(Crossing, IsNoneWhereTheCurveStaysAbove) {
  EXPECT_EQ(find_crossing(exponential({0.1, 0.2, 0.5}), 0.1).kind, CrossingKind::stays_above);
  // Touching the level is not falling below it.
  std::vector<CurvePoint> const touching{{0.0, {1.0}}, {1.0, {0.1}}};
  EXPECT_EQ(find_crossing(touching, 0.1).kind, CrossingKind::stays_above);
}

TEST(Crossing, IsNoneWhereTheCurveStartsBelow) {
  EXPECT_EQ(find_crossing(exponential({0.8, 0.9}), 0.1).kind, CrossingKind::starts_below);
}

TEST(Crossing, IsNoneWithoutPoints) { EXPECT_EQ(find_crossing({}, 0.1).kind, CrossingKind::no_points); }

TEST(Crossing, NoticesACurveThatComesBackAboveTheLevel) {
  auto const curve = [](double last, double error) {
    return std::vector<CurvePoint>{{0.0, {1.0}}, {1.0, {0.05}}, {2.0, {last, error}}};
  };
  EXPECT_TRUE(find_crossing(curve(0.2, 0.04), 0.1).comes_back);
  EXPECT_FALSE(find_crossing(curve(0.2, 0.06), 0.1).comes_back);
  EXPECT_EQ(find_crossing(curve(0.2, 0.04), 0.1).first_below, 1.0);
}

}  // namespace
}  // namespace gridlock
