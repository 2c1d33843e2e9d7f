// Soft disks under quasi-static shear, and their moduli.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "dynamics/sections.hpp"
#include "gridlock/packing/elasticity.hpp"
#include "gridlock/packing/quasistatic_shear.hpp"
#include "reference/random_packing.hpp"
#include "unit/packing/packings.hpp"

namespace gridlock::validation {
namespace {

/// A packing of 64 disks in a box of side 1, and its numbers in ε.
struct Known {
  char const* name;
  double stress;   ///< dE/dγ
  double modulus;  ///< relaxed, under simple shear, for γ → 0
  double shear_xy;
  double pure;
  double mean;
  double strain;  ///< at which the packing is still linear
};

double stress_at(Packing const& packing, double strain) {
  QuasistaticShear shear({.minimizer = {.residual = 1e-13}, .step = std::abs(strain), .until_strain = strain}, packing);
  shear.advance();
  return shear.minima().back().shear_stress;
}

void moduli_of_packings() {
  for (Known const& known : {Known{"over", 6.87498704e-2, 5.18355425, 5.49128537, 3.51235526, 4.50182032, 1e-6},
                             Known{"mid", 2.32624102e-3, 1.10812706, 1.11273321, -0.170890191, 0.47092151, 1e-6},
                             Known{"marginal", 2.19425315e-7, 1.18133438, 1.18133482, 8.558155e-5, 0.5907102, 1e-9}}) {
    Packing const packing = harmonic64(known.name);
    double const unit = std::pow(smallest_diameter(packing), 2);
    ContactNetwork const network = find_contact_network(packing, Potential::harmonic);
    ElasticModuli const moduli = find_elastic_moduli(packing, network).value();
    auto const row = [&](std::string const& quantity, double measured, double expected, double scale) {
      within(fmt::format("{} of the packing {}", quantity, known.name), {measured / unit, 0.0}, expected, 1e-6 * scale);
    };
    double const difference =
        (stress_at(packing, known.strain) - stress_at(packing, -known.strain)) / (2.0 * known.strain);
    double const simple = simple_shear_modulus(moduli, network);
    row("dE/dgamma", network.stress.xy, known.stress, known.stress);
    row("modulus of simple shear from minima", difference, known.modulus, known.modulus);
    row("modulus of simple shear from the Hessian", simple, known.modulus, known.modulus);
    row("C_xyxy", moduli.shear_xy(), known.shear_xy, known.shear_xy);
    row("C of pure shear", moduli.shear_xx_yy(), known.pure, std::abs(known.pure));
    row("shear modulus", moduli.shear(), known.mean, known.mean);
  }
}

Packing quenched(std::size_t disks, std::uint64_t seed) {
  Minimizer quench({}, reference::random_packing(disks, 0.86, seed, Edge::periodic, 1.0));
  quench.advance();
  return quench.packing();
}

/// The shear of 64 or 256 disks, 1 : 1.4 at φ = 0.86, far beyond its start; units of ε/D².
struct SteadyState {
  std::size_t disks;
  double step;
  double until_strain;
  std::uint64_t runs;
  std::uint64_t expected_runs;  ///< of the independent program
  Estimate stress;
  double deviation;  ///< of the stress in time
  Estimate pressure;
  Estimate energy;  ///< of a disk
  double drops;     ///< in a unit of strain
};

Numbers sheared_far(SteadyState const& of, std::uint64_t seed) {
  QuasistaticShear shear({.step = of.step, .until_strain = of.until_strain, .accuracy = of.step},
                         quenched(of.disks, seed));
  shear.advance();
  double count = 0.0;
  double stress = 0.0;
  double square = 0.0;
  double pressure = 0.0;
  double energy = 0.0;
  for (ShearedMinimum const& minimum : shear.minima()) {
    if (minimum.strain <= 0.5) continue;
    count += 1.0;
    stress += minimum.shear_stress;
    square += minimum.shear_stress * minimum.shear_stress;
    pressure -= 0.5 * (minimum.stress.xx + minimum.stress.yy);
    energy += minimum.energy / static_cast<double>(of.disks);
  }
  auto const drops = std::ranges::count_if(shear.events(), [](ShearEvent const& e) { return e.strain > 0.5; });
  double const mean = stress / count;
  return {mean, std::sqrt(square / count - mean * mean), pressure / count, energy / count,
          static_cast<double>(drops) / (of.until_strain - 0.5)};
}

void steady_states() {
  for (SteadyState const& of :
       {SteadyState{64, 1e-3, 2.5, 24, 12, {4.97e-4, 1.5e-5}, 4.9e-4, {6.24e-3, 9e-5}, {1.011e-4, 2.9e-6}, 28.0},
        SteadyState{64, 2e-4, 2.0, 12, 3, {4.8e-4, 7e-5}, 5.3e-4, {6.36e-3, 1.6e-4}, {1.05e-4, 4e-6}, 72.0},
        SteadyState{256, 1e-3, 2.0, 6, 3, {4.19e-4, 1.5e-5}, 2.4e-4, {5.20e-3, 1.4e-4}, {6.8e-5, 3e-6}, 36.0}}) {
    auto const found = means(of.runs, [&](std::uint64_t seed) { return sheared_far(of, seed); });
    std::string const name = fmt::format("quasi-static shear of {} steps of {}", of.disks, of.step);
    within_errors("stress: " + name, found[0], of.stress);
    within_scatter("its deviation in time: " + name, found[1], of.runs, of.deviation, of.expected_runs);
    within_errors("pressure: " + name, found[2], of.pressure);
    within_errors("energy of a disk: " + name, found[3], of.energy);
    within_scatter("drops in a unit of strain: " + name, found[4], of.runs, of.drops, of.expected_runs);
  }
}

/// The first step of 1e-4 in which the stress falls by a fifth of the step or more.
struct FirstDrop {
  std::size_t disks;
  std::uint64_t runs;
  Estimate strain;
  Estimate slope;  ///< of the first step; its deviation is not compared, since one start of 600 doubles it
  Estimate drop;
};

void first_drops() {
  constexpr double step = 1e-4;
  for (FirstDrop const& of : {FirstDrop{64, 300, {0.0122, 8e-4}, {0.0288, 0.0027}, {2.1e-4, 2e-5}},
                              FirstDrop{256, 150, {0.0059, 5e-4}, {0.022, 0.006}, {9.9e-5, 1.1e-5}}}) {
    auto const found = means(of.runs, [&](std::uint64_t seed) -> Numbers {
      QuasistaticShear shear({.step = step, .until_strain = 0.3, .accuracy = step}, quenched(of.disks, seed));
      shear.advance([&] { return shear.events().empty(); });
      ShearEvent const& event = shear.events().at(0);
      double const slope = (shear.minima()[1].shear_stress - shear.minima()[0].shear_stress) / step;
      return {event.strain + event.width, slope, event.stress_drop};
    });
    std::string const name = fmt::format("quasi-static shear of {}", of.disks);
    within_errors("strain of the first drop: " + name, found[0], of.strain);
    within_errors("slope of the first step: " + name, found[1], of.slope);
    within_errors("first drop: " + name, found[2], of.drop);
  }
}

}  // namespace

void shear() {
  moduli_of_packings();
  first_drops();
  steady_states();
}

}  // namespace gridlock::validation
