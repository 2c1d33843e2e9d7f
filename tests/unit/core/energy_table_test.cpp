// A table of energies: its spline, and rows that are refused.

#include "core/energy_table.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "gridlock/core/error.hpp"
#include "reference/soft_table.hpp"

namespace gridlock {
namespace {

PotentialSettings const wca{.kind = PairPotential::wca, .energy = 0.7};

TEST(EnergyTable, GoesThroughItsRowsAndEndsAtZeroWithoutForce) {
  std::vector<double> const x{0.5, 0.7, 1.0, 1.1, 1.6};
  std::vector<double> const y{3.0, 2.0, -1.0, 0.5, 0.25};
  EnergyTable const table(x, y);
  for (std::size_t k = 0; k < x.size(); ++k) EXPECT_NEAR(table.energy(x[k]), y[k] - y.back(), 1e-14) << k;
  EXPECT_NEAR(table.slope(x.back()), 0.0, 1e-13);
  EXPECT_EQ(table.first_distance(), 0.5);
}

TEST(EnergyTable, HasNoStepInEnergyForceAndStiffnessAtItsRows) {
  PotentialSettings const rows = reference::table_of(wca, 0.8, 12, 3.0);
  EnergyTable const table(rows.distances, rows.energies);
  for (std::size_t k = 1; k + 1 < rows.distances.size(); ++k) {
    double const x = rows.distances[k];
    double const h = 1e-7;
    EXPECT_NEAR(table.energy(x + h), table.energy(x - h), 3.0 * h * std::abs(table.slope(x)) + 1e-9);
    double const stiffness = (table.slope(x + h) - table.slope(x)) / h;
    EXPECT_NEAR(table.slope(x + h), table.slope(x - h), 3.0 * h * std::abs(stiffness) + 1e-9);
    EXPECT_NEAR((table.slope(x) - table.slope(x - h)) / h, stiffness, 1e-5 * std::abs(stiffness) + 1e-2);
  }
}

/// The largest error of the energy of a table of rows sampled from a potential.
double largest_error(PotentialSettings const& potential, std::size_t rows) {
  PairLaw const exact(potential);
  PairLaw const law(reference::table_of(potential, 0.85, rows));
  double largest = 0.0;
  for (double x = 0.85; x < exact.cutoff(); x += 0.000'37) {
    largest = std::max(largest, std::abs(law.energy(x * x, 1.0) - exact.energy(x * x, 1.0)));
  }
  return largest;
}

TEST(EnergyTable, ComesNearerToAPotentialWithTheFourthPowerOfTheSpacing) {
  double const coarse = largest_error(wca, 41);
  double const fine = largest_error(wca, 81);
  double const finest = largest_error(wca, 161);
  EXPECT_NEAR(coarse / fine, 16.0, 4.0);
  EXPECT_NEAR(fine / finest, 16.0, 2.5);
  EXPECT_LT(finest, 3e-6);
  // A parabola is a spline already.
  EXPECT_LT(largest_error({.kind = PairPotential::harmonic}, 5), 1e-15);
}

TEST(EnergyTable, FindsThePieceOfAnyDistance) {
  PotentialSettings rows = reference::table_of({.kind = PairPotential::harmonic}, 0.01, 7);
  // Spacings from 1e-3 to 0.1, each less than ten times the one before.
  rows.distances = {0.01, 0.011, 0.02, 0.1, 0.4, 0.9, 1.0};
  for (std::size_t k = 0; k < rows.distances.size(); ++k) {
    rows.energies[k] = 0.5 * (1.0 - rows.distances[k]) * (1.0 - rows.distances[k]);
  }
  PairLaw const law(rows);
  PairLaw const exact({.kind = PairPotential::harmonic});
  for (double x = 0.01; x < 1.1; x += 0.000'1) {
    EXPECT_NEAR(law.energy(x * x, 1.0), exact.energy(x * x, 1.0), 1e-12) << x;
    EXPECT_NEAR(law.push(x * x, 1.0) * x, exact.push(x * x, 1.0) * x, 1e-10) << x;
  }
}

TEST(EnergyTable, SaysNothingBelowItsFirstDistance) {
  PairLaw const law(reference::table_of(wca, 0.8, 20));
  EXPECT_EQ(law.energy(0.799 * 0.799, 1.0), std::numeric_limits<double>::infinity());
  EXPECT_EQ(law.push(0.799 * 0.799, 1.0), std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isfinite(law.push(0.801 * 0.801, 1.0)));
}

std::string problem_of(std::vector<double> const& distances, std::vector<double> const& energies) {
  try {
    require_valid(PotentialSettings{.kind = PairPotential::table, .distances = distances, .energies = energies});
  } catch (Error const& error) {
    return error.problems().front().key + ": " + error.problems().front().what;
  }
  return "";
}

TEST(EnergyTable, RefusesRowsOfWhichNoPotentialCanBeMade) {
  std::vector<double> const y{3.0, 2.0, 1.0, 0.0};
  EXPECT_EQ(problem_of({0.8, 0.9, 1.0, 1.1}, y), "");
  EXPECT_EQ(problem_of({0.8, 0.9, 1.0, 1.1, 1.2}, y),
            "potential.energies: the table of the potential has 5 distances and 4 energies");
  EXPECT_EQ(problem_of({0.8, 0.9, 1.0}, {2.0, 1.0, 0.0}),
            "potential.distances: the table of the potential has 3 rows, and a spline needs at least 4");
  EXPECT_EQ(problem_of({}, {}),
            "potential.distances: the table of the potential has 0 rows, and a spline needs at least 4");
  EXPECT_EQ(
      problem_of({0.8, 0.9, 0.9, 1.1}, y),
      "potential.distances[2]: the distances of the table of the potential do not increase: row 2 has 0.9, and row 3 "
      "after it 0.9");
  EXPECT_EQ(problem_of({0.8, 0.9, std::nan(""), 1.1}, y),
            "potential.distances[2]: row 3 of the table of the potential has the distance nan, out of bounds");
  EXPECT_EQ(problem_of({0.8, 0.9, 1.0, 200.0}, y),
            "potential.distances[3]: row 4 of the table of the potential has the distance 200, out of bounds");
  EXPECT_EQ(problem_of({0.8, 0.9, 1.0, 1.1}, {1.0, -1e70, 1.0, 0.0}),
            "potential.energies[1]: row 2 of the table of the potential has the energy -1e+70, out of bounds");
  EXPECT_EQ(problem_of({0.0, 0.5, 1.0, 1.5}, y),
            "potential.distances[0]: the first distance of the table of the potential is 0, not above 0");
  EXPECT_EQ(
      problem_of({0.8, 0.81, 0.82, 1.1}, y),
      "potential.distances[2]: the table of the potential has a gap at row 3: the distances before and after 0.82 are "
      "0.01 and 0.28 away, and one of them is more than 10 times the other");
  EXPECT_EQ(problem_of({0.5, 0.6, 0.7, 0.8}, y),
            "potential.distances[3]: the table of the potential ends at 0.8, below the contact distance 1");
}

TEST(EnergyTable, IsRefusedWhereItsSplineTurnsBackBetweenRowsThatOnlyFall) {
  auto const steep = [](std::size_t spacings) {
    std::pair<std::vector<double>, std::vector<double>> rows;
    for (std::size_t k = 0; k <= spacings; ++k) {
      double const r = 0.8 + 0.7 * static_cast<double>(k) / static_cast<double>(spacings);
      rows.first.push_back(r);
      rows.second.push_back(std::pow(r, -36.0));
    }
    return rows;
  };
  auto const [coarse_x, coarse_y] = steep(14);
  std::string const problem = problem_of(coarse_x, coarse_y);
  // SciPy's spline with these ends goes down to −2.538 there, and in no piece before by 1 % of the rows around.
  EXPECT_NE(problem.find("potential.energies[3]: the spline through the table of the potential turns back between the "
                         "distances 0.95 and 1, whose energies are 6.33797 and 1 above that of the last row: it "
                         "reaches -2.54"),
            std::string::npos)
      << problem;
  auto const [fine_x, fine_y] = steep(56);
  EXPECT_EQ(problem_of(fine_x, fine_y), "");
  EXPECT_NE(problem_of({0.9, 0.95, 1.0, 1.05, 1.1, 1.15, 1.2, 1.25, 1.3}, {50, 20, 1, 1, 1, 1, 1, 0, 0}), "");
  // A well that the rows have is one.
  EXPECT_EQ(problem_of({0.9, 1.0, 1.1, 1.2, 1.3, 1.4}, {4.0, 0.5, -1.0, -0.9, -0.3, 0.0}), "");
}

}  // namespace
}  // namespace gridlock
