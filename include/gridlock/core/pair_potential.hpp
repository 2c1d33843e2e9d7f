#pragma once

/// \file
/// The potentials of soft disks that move.
///
/// ```cpp
/// PotentialSettings const liquid{.kind = PairPotential::lennard_jones, .energy = 2.0};
/// double const cutoff = cutoff_of(liquid);  // 2.5 contact distances
/// ```

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gridlock/core/setting.hpp"

namespace gridlock {

/// The potential energy V of two disks at a distance r, with s = σ/r and the contact distance σ = R_i + R_j. Beyond the
/// cutoff it is 0, and V_c is the value that the formula has there: energies have no step, only forces may have one.
///
/// harmonic:      V = (ε/2) (1 − r/σ)²          for r < σ
/// hertzian:      V = (2ε/5) (1 − r/σ)^(5/2)    for r < σ
/// wca:           V = 4ε (s¹² − s⁶) + ε         for r < 2^(1/6) σ (Weeks, Chandler, Andersen 1971,
///                                              doi:10.1063/1.1674820)
/// inverse_power: V = ε sⁿ − V_c                for r < cutoff · σ
/// lennard_jones: V = 4ε (s¹² − s⁶) − V_c       for r < cutoff · σ
/// table:         V = ε u(r/σ), a cubic spline u through rows of distances and energies, shifted to 0 at the last,
///                which is the cutoff; u' is 0 there. Below the first distance V is unknown: a run fails.
enum class PairPotential { harmonic, hertzian, wca, inverse_power, lennard_jones, table };
/// Returns the word of a potential, as in potential.kind.
std::string_view to_text(PairPotential potential);

/// The settings `[potential]`, which the engine `soft` knows.
struct PotentialSettings {
  PairPotential kind = PairPotential::harmonic;
  double energy = 1.0;                 ///< ε
  std::uint64_t exponent = 12;         ///< n of inverse_power
  std::optional<double> cutoff = {};   ///< of inverse_power and lennard_jones, in contact distances; left out: 2.5
  std::vector<double> distances = {};  ///< of a table, in contact distances
  std::vector<double> energies = {};   ///< of a table, in ε, at the distances
  std::string file = {};               ///< of a table: CSV with the columns distance and energy, read by set_up()
};
void describe(PotentialSettings& settings, SettingVisitor& visitor);

/// Errors: Error for a table with fewer than four rows, or whose rows are no function of the distance.
void require_valid(PotentialSettings const& settings);

/// Returns the distance, in contact distances, from which on disks do not feel each other.
double cutoff_of(PotentialSettings const& settings);

/// Returns whether the energy stays finite however much two disks overlap.
bool is_bounded(PairPotential potential);

}  // namespace gridlock
