// The pressure of small periodic systems from independent runs of the engine `exact`, against published values, and
// the errors of single runs against the scatter of all: too long for the tests. The audit is on.
//
//     gridlock_validate_exact_pressure [quick | millions of collisions per system]      200 where nothing is given
//
// 72, 224 and 870 disks, 20 runs each; three times as many collisions near the transition. The last row is a fluid of
// 256 disks at a density that no test uses. quick: 20 million collisions for those that relax soon, half a minute. Each
// row has χ² = Σ (run − mean)²/(error of the run)² with 19 degrees of
// freedom; the last one also has it about the expected value, with 20. The program returns 1 if a pressure differs by
// more than four errors, or if a χ² of the last row is farther than three standard deviations, 3 √(2 · 20), from 20.
//
// Published: Li et al. 2022, P* = βPσ² of N hard disks in a periodic square box, by event-driven dynamics.
//
// The total momentum is 0, so that ⟨(v_i − v_j)²⟩ = 4 kT/m exactly with kT = K/(N − 1), and positions do not depend on
// velocities: P* by the virial of collisions is that of the canonical ensemble for any N, without a correction. The
// canonical fluid of N disks differs from the infinite one. With S = 1 / (d(ηZ)/dη), the variance of the number of
// disks in an open system over its mean, ln Z_N = [βPV − N ln z − ½ ln(2π N S)] + …, and its derivative by V at constant N is
//
//     Z_N = Z + (η / 2N) d ln S / dη + O(1/N²),    in a dilute gas Z − (Z − 1)/N, as pairs are N(N − 1)/2.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <string_view>
#include <vector>

#include "gridlock/engine/engine.hpp"
#include "gridlock/observe/estimate.hpp"
#include "periodic_systems.hpp"

namespace gridlock::validation {
namespace {

struct Published {
  std::uint64_t columns;
  std::uint64_t rows;
  double packing_fraction;
  double pressure;
  double error;
  std::uint64_t length = 1;  ///< of the run; near the transition the blocks scatter more
};

constexpr Published small[] = {
    {8, 9, 0.65, 6.901074, 0.000071},   {8, 9, 0.66, 7.383221, 0.000087},   {8, 9, 0.67, 7.85637, 0.00011},
    {8, 9, 0.68, 8.23631, 0.00034},     {8, 9, 0.69, 8.41814, 0.00038, 3},  {8, 9, 0.70, 8.55170, 0.00059, 3},
    {14, 16, 0.67, 7.979479, 0.000058}, {14, 16, 0.68, 8.49105, 0.00019},   {29, 30, 0.67, 7.986779, 0.000025},
    {29, 30, 0.68, 8.513249, 0.000037}, {29, 30, 0.69, 8.969898, 0.000075},
};

constexpr std::uint64_t runs = 20;
constexpr double held_back = 0.37;

/// βP/ρ of the infinite fluid: Kolafa & Rottner 2006, doi:10.1080/00268970600967963, good to 10⁻⁵ here.
double fluid(double packing_fraction) {
  constexpr double coefficients[] = {
      1.0,          2.0,           1.12801775,     0.00181895291, -0.0526134737,  0.0504963915,  -0.0325578581,
      0.0134816028, 0.00129187484, -0.00808881628, 0.00669011963, -0.00250795961, 0.000336036442};
  double const x = packing_fraction / (1.0 - packing_fraction);
  double z = 0.0;
  double power = 1.0;
  for (double const coefficient : coefficients) {
    z += coefficient * power;
    power *= x;
  }
  return z;  // the terms x²² and x⁵⁷ are below 10⁻⁹
}

/// βP/ρ of n disks.
double fluid_of(double n, double packing_fraction) {
  constexpr double h = 1e-3;
  auto const inverse_s = [&](double at) { return ((at + h) * fluid(at + h) - (at - h) * fluid(at - h)) / (2.0 * h); };
  double const slope =
      -(std::log(inverse_s(packing_fraction + h)) - std::log(inverse_s(packing_fraction - h))) / (2.0 * h);
  return fluid(packing_fraction) + packing_fraction / (2.0 * n) * slope;
}

/// One run: P* with the error of its own blocks.
Estimate pressure_of(Published const& p, std::uint64_t collisions, std::uint64_t seed) {
  constexpr std::uint64_t blocks = 64;
  State state = rows_of_disks(p.columns, p.rows, p.packing_fraction, seed);
  EngineSettings settings;
  settings.kind = "exact";
  settings.audit_every = 1'000'000;
  auto const engine = make_engine(settings, state);
  Counters counters;
  std::uint64_t const start = std::max(collisions / 10, 2000 * p.columns * p.rows);
  engine->advance(state, counters, {.pair_collisions = start});
  BlockAverage average;
  for (std::uint64_t block = 1; block <= blocks; ++block) {
    double const time = state.clock.time;
    double const pressure = pressure_up_to({.pair_collisions = start + collisions / blocks * block}, *engine, state,
                                           counters, p.packing_fraction);
    average.add(pressure, state.clock.time - time);
  }
  return *average.estimate();
}

double chi_squared(std::vector<Estimate> const& estimates, double about) {
  double sum = 0.0;
  for (Estimate const& run : estimates) sum += std::pow((run.value - about) / *run.error, 2);
  return sum;
}

/// Prints a row; returns the χ² about the published value, or infinity if the pressure differs.
double measure(Published const& p, std::uint64_t collisions) {
  std::vector<Estimate> estimates;
  for (std::uint64_t seed = 1; seed <= runs; ++seed) estimates.push_back(pressure_of(p, collisions / runs, seed));
  CombinedEstimate const all = combine(estimates);
  double const error = *all.mean.error;
  double const difference = (all.mean.value - p.pressure) / std::hypot(error, p.error);
  double const about_published = chi_squared(estimates, p.pressure);
  std::printf("%llu,%.3f,%llu,%.6f,%.6f,%.6f,%.6f,%.2f,%.1f,%.1f\n",
              static_cast<unsigned long long>(p.columns * p.rows), p.packing_fraction,
              static_cast<unsigned long long>(collisions), all.mean.value, error, p.pressure, p.error, difference,
              *all.chi_squared, about_published);
  std::fflush(stdout);
  bool const agrees = std::abs(difference) <= 4.0;
  bool const errors_agree = p.error > 0.0 || (*all.chi_squared >= 0.5 && *all.chi_squared <= 37.5);
  return agrees && errors_agree ? about_published : std::numeric_limits<double>::infinity();
}

}  // namespace
}  // namespace gridlock::validation

int main(int argument_count, char** arguments) {
  using namespace gridlock::validation;
  bool const quick = argument_count > 1 && std::string_view(arguments[1]) == "quick";
  std::uint64_t const millions = quick ? 20 : argument_count > 1 ? std::strtoull(arguments[1], nullptr, 10) : 200;
  std::printf(
      "n,packing_fraction,collisions,pressure,error,published,published_error,difference_in_errors,chi_squared,"
      "chi_squared_about_published\n");
  bool agrees = true;
  for (Published const& system : small) {
    if (quick && !(system.columns * system.rows < 300 && system.packing_fraction < 0.675)) continue;
    agrees &= std::isfinite(measure(system, 1'000'000 * millions * system.length));
  }
  double const expected = fluid_of(256.0, held_back) * 4.0 * held_back / std::numbers::pi;
  double const about_expected = measure({16, 16, held_back, expected, 0.0}, 1'000'000 * millions);
  agrees &= std::abs(about_expected - 20.0) <= 3.0 * std::sqrt(2.0 * 20.0);
  return agrees ? 0 : 1;
}
