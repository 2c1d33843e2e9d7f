#pragma once

#include "core/energy_table.hpp"
#include "gridlock/core/pair_potential.hpp"

namespace gridlock {

/// The numbers of a potential that its kernels need.
struct PairConstants {
  explicit PairConstants(PotentialSettings const& settings)
      : energy(settings.energy), exponent(settings.exponent), cutoff(cutoff_of(settings)) {}

  double energy;  ///< ε
  std::uint64_t exponent;
  double cutoff;  ///< in contact distances
};

/// The energy and the force of two disks, pair by pair.
class PairLaw {
 public:
  explicit PairLaw(PotentialSettings const& settings);

  /// Returns V at the squared distance r² of disks whose contact distance is `sigma`; 0 from the cutoff on.
  [[nodiscard]] double energy(double square, double sigma) const;
  /// Returns −(dV/dr)/r; 0 from the cutoff on. At r = 0 it is 0 if the energy is bounded, else infinite. Energy and
  /// push of a table are infinite below its first distance.
  [[nodiscard]] double push(double square, double sigma) const;
  /// Returns the cutoff in contact distances.
  [[nodiscard]] double cutoff() const { return constants_.cutoff; }
  [[nodiscard]] EnergyTable const& table() const { return table_; }

 private:
  [[nodiscard]] bool is_beyond(double square, double sigma) const {
    double const limit = constants_.cutoff * sigma;
    return !(square < limit * limit);
  }
  [[nodiscard]] double unshifted(double s2) const;

  PairPotential kind_;
  PairConstants constants_;
  double shift_ = 0.0;  ///< V_c
  EnergyTable table_;   ///< in ε and contact distances; only of the kind table
};

}  // namespace gridlock
