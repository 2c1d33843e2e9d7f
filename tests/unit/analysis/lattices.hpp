#pragma once

#include <cmath>
#include <complex>
#include <cstddef>
#include <vector>

#include "gridlock/core/box.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/grid/neighbour_lists.hpp"
#include "unit/analysis/points.hpp"

namespace gridlock {

/// A periodic triangular lattice of spacing 1 with independent Gaussian displacements, `noise` along each axis. The
/// numbers in tests of it are those of the exact mean ⟨exp(6 i δθ)⟩ of one bond, c₆ = κ³/120 ₁F₁(3; 7; −κ) with
/// κ = 1/(4 noise²), or, where a comment says so, of simulations by another program.
struct NoisyLattice {
  static constexpr int columns = 24;
  static constexpr int rows = 28;

  Box box{columns, rows* std::sqrt(0.75), Edge::periodic};
  RandomPoints points{0, 1.0, 1.0};

  explicit NoisyLattice(double noise, unsigned seed = 1) {
    RandomStream random(seed, 0, 0, Purpose::start_position);  // not of the standard library, whose numbers differ
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        double const x = column + 0.5 * (row % 2) + noise * random.normal();
        points.values.insert(points.values.end(), {x, row * std::sqrt(0.75) + noise * random.normal()});
      }
    }
  }
  [[nodiscard]] PointsInMemory view() const { return points.view(); }
  /// The neighbours in the lattice without noise.
  [[nodiscard]] static NeighbourLists bonds() {
    NoisyLattice const perfect(0.0);
    return find_neighbour_lists(perfect.box, 1.2, perfect.view());
  }
};

/// Mean and standard error of independent values.
struct MeanOfValues {
  double sum = 0.0, squares = 0.0, count = 0.0;

  void add(double value) { sum += value, squares += value * value, count += 1.0; }
  [[nodiscard]] double mean() const { return sum / count; }
  [[nodiscard]] double error() const { return std::sqrt((squares / count - mean() * mean()) / (count - 1.0)); }
};

}  // namespace gridlock
