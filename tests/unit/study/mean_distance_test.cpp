#include "study/mean_distance.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "gridlock/core/random.hpp"
#include "gridlock/lattice/start.hpp"

namespace gridlock {
namespace {

/// ⟨|q − p|⟩ by the midpoint rule, as the definition says.
double mean_distance_by_midpoints(Vector p, Rectangle const& rectangle, int points) {
  double sum = 0.0;
  for (int i = 0; i < points; ++i) {
    for (int j = 0; j < points; ++j) {
      Vector const q{rectangle.lower.x + rectangle.width() * (i + 0.5) / points,
                     rectangle.lower.y + rectangle.height() * (j + 0.5) / points};
      sum += std::sqrt(squared_length(q - p));
    }
  }
  return sum / points / points;
}

double radius_of(double packing_fraction) { return std::sqrt(packing_fraction / (841.0 * std::numbers::pi)); }

TEST(MeanDistance, IsTheIntegralOfTheDistanceOverTheRectangle) {
  Rectangle const rectangle{{-1.0, 2.0}, {3.0, 2.5}};
  RandomStream random(7, 0, 0, Purpose::start_position);
  for (int n = 0; n < 20; ++n) {
    Vector const p{-1.0 + 4.0 * random.uniform(), 2.0 + 0.5 * random.uniform()};
    EXPECT_NEAR(mean_distance(p, rectangle), mean_distance_by_midpoints(p, rectangle, 400), 2e-5);
  }
  EXPECT_NEAR(mean_distance({-1.0, 2.0}, rectangle), mean_distance_by_midpoints({-1.0, 2.0}, rectangle, 400), 2e-5);
}

TEST(MeanDistance, FromTheCentreOfTheUnitSquareIsTheTextbookValue) {
  // (√2 + arsinh 1)/6, four corners of side ½.
  double const expected = (std::numbers::sqrt2 + std::asinh(1.0)) / 6.0;
  EXPECT_NEAR(mean_distance({0.5, 0.5}, {{0.0, 0.0}, {1.0, 1.0}}), expected, 1e-15);
}

TEST(MeanDistance, OfTwoUniformPointsOfTheUnitSquareIsThePublishedConstant) {
  EXPECT_NEAR(mean_distance_in_square(1.0), 0.5214054332, 1e-10);
  EXPECT_DOUBLE_EQ(mean_distance_in_square(3.0), 3.0 * mean_distance_in_square(1.0));
  // The mean over sites that fill the square evenly is the same double integral; midpoints leave 1/(24 n²) of curvature.
  std::vector<Vector> sites;
  for (int i = 0; i < 300; ++i) {
    for (int j = 0; j < 300; ++j) sites.push_back({(i + 0.5) / 300, (j + 0.5) / 300});
  }
  EXPECT_NEAR(mean_distance(sites, {{0.0, 0.0}, {1.0, 1.0}}), 0.5214054332, 2e-6);
}

TEST(MeanDistance, FromTheSquareStartIsThePlateauOfThePhysicsReference) {
  Box const box;
  std::vector<Vector> const sites = fit_square_lattice(box, 841).sites;
  struct Known {
    double packing_fraction;
    double plateau;
  };
  // Computed once by an independent program for 29² sites (i + ½)/29 and centres uniform in [R, 1 − R]².
  for (auto const& [packing_fraction, plateau] :
       {Known{0.1, 0.51806}, {0.3, 0.51574}, {0.5, 0.51416}, {0.7, 0.51287}}) {
    EXPECT_NEAR(mean_distance(sites, room_of_centres(box, radius_of(packing_fraction))), plateau, 6e-6)
        << packing_fraction;
  }
}

TEST(MeanDistanceAfterDiffusion, GrowsFromTheFreePlaneToThePlateau) {
  Box const box;
  std::vector<Vector> const sites = fit_triangular_lattice(box, 841).sites;
  Rectangle const room = room_of_centres(box, radius_of(0.3));
  EXPECT_EQ(mean_distance_after_diffusion(sites, room, 0.0), 0.0);
  double const short_time = 1e-6;
  EXPECT_NEAR(mean_distance_after_diffusion(sites, room, short_time), std::sqrt(std::numbers::pi * short_time), 1e-12);
  EXPECT_NEAR(mean_distance_after_diffusion(sites, room, 100.0), mean_distance(sites, room), 2e-4);
  double last = 0.0;
  for (double diffused = 1e-6; diffused < 10.0; diffused *= 1.6) {
    double const now = mean_distance_after_diffusion(sites, room, diffused);
    EXPECT_GT(now, 0.999 * last) << "at D t = " << diffused;
    last = now;
  }
}

TEST(MeanDistanceAfterDiffusion, AgreesWithReflectedRandomWalks) {
  Rectangle const room{{0.1, 0.2}, {0.9, 0.8}};
  std::vector<Vector> const sites{{0.15, 0.5}, {0.6, 0.25}, {0.8, 0.75}};
  auto const reflected = [](double x, double low, double high) {
    double const period = 2.0 * (high - low);
    double const inside = std::fmod(std::fmod(x - low, period) + period, period);
    return low + std::min(inside, period - inside);
  };
  for (double const diffused : {0.005, 0.03, 0.2}) {
    RandomStream random(3, 0, 0, Purpose::start_position);
    double sum = 0.0;
    double squares = 0.0;
    constexpr int walks = 60'000;
    for (int n = 0; n < walks; ++n) {
      Vector const start = sites[static_cast<std::size_t>(n % 3)];
      // Between reflecting walls one normal step, folded back, is distributed as the whole walk.
      double const deviation = std::sqrt(2.0 * diffused);
      Vector const end{reflected(start.x + deviation * random.normal(), room.lower.x, room.upper.x),
                       reflected(start.y + deviation * random.normal(), room.lower.y, room.upper.y)};
      double const distance = std::sqrt(squared_length(end - start));
      sum += distance;
      squares += distance * distance;
    }
    double const mean = sum / walks;
    double const error = std::sqrt((squares / walks - mean * mean) / walks);
    EXPECT_NEAR(mean_distance_after_diffusion(sites, room, diffused), mean, 4.0 * error + 1e-3 * mean) << diffused;
  }
}

TEST(EnskogDiffusion, IsThatOfThePhysicsReference) {
  struct Known {
    double packing_fraction;
    double diffusion;  // over σ √(kT/m)
    double tolerance;  // of Henderson's contact value
  };
  for (auto const& [packing_fraction, diffusion, tolerance] : {Known{0.05, 4.088225, 1e-3},
                                                               {0.1, 1.876457, 1e-3},
                                                               {0.3, 0.416750, 2e-3},
                                                               {0.5, 0.142647, 1e-2},
                                                               {0.6, 0.081226, 2e-2}}) {
    double const radius = 0.02;
    double const unit = 2.0 * radius * std::sqrt(0.25);
    EXPECT_NEAR(enskog_diffusion(packing_fraction, radius, 0.25) / unit, diffusion, tolerance * diffusion);
  }
}

}  // namespace
}  // namespace gridlock
