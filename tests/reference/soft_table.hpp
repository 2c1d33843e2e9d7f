// Tables sampled from the potentials with a formula.
#pragma once

#include <cstddef>

#include "core/pair_law.hpp"

namespace gridlock::reference {

/// Returns a table of `rows` rows from `first` to the cutoff of a potential, nearer to each other where it is steep:
/// the spacing grows by `growth` times itself from the first row to the last.
inline PotentialSettings table_of(PotentialSettings const& potential, double first, std::size_t rows,
                                  double growth = 0.0) {
  PairLaw const law(potential);
  PotentialSettings table{.kind = PairPotential::table, .energy = potential.energy};
  for (std::size_t k = 0; k < rows; ++k) {
    double const part = static_cast<double>(k) / static_cast<double>(rows - 1);
    double const x = k + 1 == rows
                         ? law.cutoff()
                         : first + (law.cutoff() - first) * part * (1.0 + 0.5 * growth * part) / (1.0 + 0.5 * growth);
    table.distances.push_back(x);
    table.energies.push_back(law.energy(x * x, 1.0) / potential.energy);
  }
  return table;
}

}  // namespace gridlock::reference
