#include "core/pair_law.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "core/magnitude.hpp"
#include "core/overlap_law.hpp"

namespace gridlock {

namespace {

constexpr std::array<std::string_view, 6> potentials{"harmonic",      "hertzian",      "wca",
                                                     "inverse_power", "lennard_jones", "table"};

constexpr double infinite_energy = std::numeric_limits<double>::infinity();

constexpr double sixth_root_of_two = 1.122462048309373;

template <class N>
N broadcast(double value) {
  return value;
}
double square_root(double value) { return std::sqrt(value); }

#include "core/pair_pushes-inl.hpp"

}  // namespace

std::string_view to_text(PairPotential potential) { return potentials[static_cast<std::size_t>(potential)]; }

void describe(PotentialSettings& settings, SettingVisitor& visitor) {
  visit_enum(
      visitor,
      {.key = "kind",
       .documentation =
           "The energy V(r) of two disks of the engine soft, with σ the sum of their radii: \"harmonic\" is "
           "(ε/2)(1 − r/σ)², \"hertzian\" is (2ε/5)(1 − r/σ)^(5/2), \"wca\" and \"lennard_jones\" are "
           "4ε((σ/r)¹² − (σ/r)⁶), cut at the minimum or later, \"inverse_power\" is ε(σ/r)ⁿ, \"table\" is a cubic "
           "spline through the rows of distances and energies."},
      potentials, settings.kind);
  visitor.visit({.key = "energy",
                 .unit = "energy",
                 .documentation = "ε, the energy of the potential.",
                 .min = 0.0,
                 .max = max_magnitude,
                 .min_is_allowed = false},
                settings.energy);
  visitor.visit({.key = "exponent", .documentation = "n of inverse_power.", .min = 1.0, .max = 100.0},
                settings.exponent);
  visitor.visit({.key = "cutoff",
                 .unit = "sums of two radii",
                 .documentation = "inverse_power and lennard_jones: the distance from which on two disks do not feel "
                                  "each other; the energy is shifted so that it is 0 there.",
                 .min = 1.0,
                 .max = 100.0,
                 .default_note = "2.5"},
                settings.cutoff);
  visitor.visit({.key = "distances",
                 .unit = "sums of two radii",
                 .documentation = "table: at least four distances, in increasing order; the last is the cutoff, and "
                                  "disks nearer than the first end the run.",
                 .default_note = "none"},
                settings.distances);
  visitor.visit({.key = "energies",
                 .unit = "potential.energy",
                 .documentation = "table: the energy at each of the distances; it is shifted to 0 at the last of them.",
                 .default_note = "none"},
                settings.energies);
  visitor.visit({.key = "file",
                 .documentation = "table: a CSV file, relative to the configuration, with the columns distance and "
                                  "energy in place of the two lists.",
                 .default_note = "no file"},
                settings.file);
}

double cutoff_of(PotentialSettings const& settings) {
  if (is_bounded(settings.kind)) return 1.0;
  if (settings.kind == PairPotential::table) return settings.distances.empty() ? 1.0 : settings.distances.back();
  return settings.kind == PairPotential::wca ? sixth_root_of_two : settings.cutoff.value_or(2.5);
}

bool is_bounded(PairPotential potential) {
  return potential == PairPotential::harmonic || potential == PairPotential::hertzian;
}

void require_valid(PotentialSettings const& settings) {
  if (settings.kind == PairPotential::table) require_table(settings.distances, settings.energies);
}

PairLaw::PairLaw(PotentialSettings const& settings) : kind_(settings.kind), constants_(settings) {
  if (kind_ == PairPotential::table) {
    table_ = EnergyTable(settings.distances, settings.energies);
  } else if (!is_bounded(kind_)) {
    shift_ = unshifted(1.0 / (constants_.cutoff * constants_.cutoff));
  }
}

/// Returns the energy of a potential that is not bounded, without its shift, for s² = σ²/r².
double PairLaw::unshifted(double s2) const {
  if (kind_ == PairPotential::inverse_power) {
    // The push of disks at σ = 1 is n V/r².
    return InversePowerPush<double>(constants_)(1.0 / s2, 1.0) / (static_cast<double>(constants_.exponent) * s2);
  }
  double const s6 = s2 * s2 * s2;
  return 4.0 * constants_.energy * (s6 * s6 - s6);
}

double PairLaw::energy(double square, double sigma) const {
  if (is_beyond(square, sigma)) return 0.0;
  if (is_bounded(kind_)) {
    return constants_.energy * OverlapLaw(kind_ == PairPotential::harmonic).energy(1.0 - std::sqrt(square) / sigma);
  }
  if (kind_ == PairPotential::table) {
    double const distance = std::sqrt(square) / sigma;
    return distance < table_.first_distance() ? infinite_energy : constants_.energy * table_.energy(distance);
  }
  return unshifted(sigma * sigma / square) - shift_;
}

double PairLaw::push(double square, double sigma) const {
  if (is_beyond(square, sigma) || (square == 0.0 && is_bounded(kind_))) return 0.0;
  switch (kind_) {
    case PairPotential::harmonic:
      return HarmonicPush<double>(constants_)(square, sigma);
    case PairPotential::hertzian:
      return HertzianPush<double>(constants_)(square, sigma);
    case PairPotential::inverse_power:
      return InversePowerPush<double>(constants_)(square, sigma);
    case PairPotential::table:
      return constants_.energy * table_.push(square, sigma);
    case PairPotential::wca:
    case PairPotential::lennard_jones:
      break;
  }
  return LennardJonesPush<double>(constants_)(square, sigma);
}

}  // namespace gridlock
