// Quenched and decompressed packings against those of an independent program: half the disks of diameter D, half of 1.4 D, random
// points quenched at a packing fraction of 0.86 and decompressed to p = 1e-8.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "gridlock/packing/pressure_ramp.hpp"
#include "reference/random_packing.hpp"

namespace gridlock {
namespace {

struct Jammed {
  std::vector<double> packing_fractions;
  std::vector<double> slopes;  ///< p/Δφ at the last level
};

double mean(std::vector<double> const& values) {
  double sum = 0.0;
  for (double const value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

double standard_error(std::vector<double> const& values) {
  double sum = 0.0;
  for (double const value : values) sum += (value - mean(values)) * (value - mean(values));
  auto const n = static_cast<double>(values.size());
  return std::sqrt(sum / (n * (n - 1.0)));
}

Jammed quenched_and_decompressed(std::size_t disks, std::uint64_t starts) {
  Jammed jammed;
  for (std::uint64_t seed = 1; seed <= starts; ++seed) {
    Minimizer quench({}, reference::random_packing(disks, 0.86, seed));
    quench.advance();
    PressureRamp ramp({}, quench.packing());
    ramp.advance();
    EXPECT_EQ(ramp.status(), RampStatus::reached) << disks << " disks, seed " << seed;
    PressureLevel const& last = ramp.levels().back();
    jammed.packing_fractions.push_back(last.jamming_packing_fraction);
    jammed.slopes.push_back(last.pressure / (last.packing_fraction - last.jamming_packing_fraction));
  }
  return jammed;
}

/// The exponent of p ∝ Δφ^x by least squares in the logarithms over the last three decades of pressure.
double exponent_of_pressure(PressureRamp const& ramp) {
  std::vector<PressureLevel> const& levels = ramp.levels();
  double const jamming = levels.back().jamming_packing_fraction;
  std::vector<double> x;
  std::vector<double> y;
  for (std::size_t k = levels.size() - 7; k < levels.size(); ++k) {
    x.push_back(std::log(levels[k].packing_fraction - jamming));
    y.push_back(std::log(levels[k].pressure));
  }
  double above = 0.0;
  double below = 0.0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    above += (x[k] - mean(x)) * (y[k] - mean(y));
    below += (x[k] - mean(x)) * (x[k] - mean(x));
  }
  return above / below;
}

std::vector<double> exponents(Potential potential, double pressure, std::uint64_t starts) {
  std::vector<double> exponents;
  for (std::uint64_t seed = 1; seed <= starts; ++seed) {
    Minimizer quench({.potential = potential}, reference::random_packing(64, 0.86, seed));
    quench.advance();
    PressureRamp ramp({.minimizer = {.potential = potential}, .pressure = pressure}, quench.packing());
    ramp.advance();
    exponents.push_back(exponent_of_pressure(ramp));
  }
  return exponents;
}

TEST(JammingPhysics, PressureOfHarmonicDisksIsProportionalToTheDistanceToJamming) {
  for (double const exponent : exponents(Potential::harmonic, 1e-8, 16)) EXPECT_NEAR(exponent, 1.0, 0.002);
}

TEST(JammingPhysics, PressureOfHertzianDisksGrowsWithTheExponentThreeHalves) {
  // Contacts that close on the way make single starts differ by 0.006. They close above p = 1e-6 most of all: from there to 1e-5 the
  // mean over starts would be 1.505(2).
  std::vector<double> const all = exponents(Potential::hertzian, 1e-9, 40);
  EXPECT_LT(standard_error(all), 0.0015);
  EXPECT_NEAR(mean(all), 1.5, 0.003);
}

TEST(JammingPhysics, MeanJammingPackingFractionOf64DisksIsThatOfAnIndependentProgram) {
  Jammed const jammed = quenched_and_decompressed(64, 40);
  double const error = std::hypot(standard_error(jammed.packing_fractions), 0.00024);
  EXPECT_LT(error, 0.001);
  EXPECT_NEAR(mean(jammed.packing_fractions), 0.83812, 4.0 * error);
  EXPECT_NEAR(mean(jammed.slopes), 0.2671, 0.05 * 0.2671);
}

TEST(JammingPhysics, MeanJammingPackingFractionOf256DisksIsThatOfAnIndependentProgram) {
  Jammed const jammed = quenched_and_decompressed(256, 12);
  double const error = std::hypot(standard_error(jammed.packing_fractions), 0.00024);
  EXPECT_LT(error, 0.001);
  EXPECT_NEAR(mean(jammed.packing_fractions), 0.84231, 4.0 * error);
  EXPECT_NEAR(mean(jammed.slopes), 0.2613, 0.05 * 0.2613);
}

}  // namespace
}  // namespace gridlock
