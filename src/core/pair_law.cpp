#include "core/pair_law.hpp"

#include <array>
#include <cmath>
#include <cstddef>

#include "core/magnitude.hpp"
#include "core/overlap_law.hpp"

namespace gridlock {

namespace {

constexpr std::array<std::string_view, 5> potentials{"harmonic", "hertzian", "wca", "inverse_power", "lennard_jones"};

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
  visit_enum(visitor,
             {.key = "kind",
              .documentation =
                  "The energy V(r) of two disks of the engine soft, with σ the sum of their radii: \"harmonic\" is "
                  "(ε/2)(1 − r/σ)², \"hertzian\" is (2ε/5)(1 − r/σ)^(5/2), \"wca\" and \"lennard_jones\" are "
                  "4ε((σ/r)¹² − (σ/r)⁶), cut at the minimum or later, \"inverse_power\" is ε(σ/r)ⁿ."},
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
}

double cutoff_of(PotentialSettings const& settings) {
  if (is_bounded(settings.kind)) return 1.0;
  return settings.kind == PairPotential::wca ? sixth_root_of_two : settings.cutoff.value_or(2.5);
}

bool is_bounded(PairPotential potential) {
  return potential == PairPotential::harmonic || potential == PairPotential::hertzian;
}

PairLaw::PairLaw(PotentialSettings const& settings) : kind_(settings.kind), constants_(settings) {
  if (!is_bounded(kind_)) shift_ = unshifted(1.0 / (constants_.cutoff * constants_.cutoff));
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
    case PairPotential::wca:
    case PairPotential::lennard_jones:
      break;
  }
  return LennardJonesPush<double>(constants_)(square, sigma);
}

}  // namespace gridlock
