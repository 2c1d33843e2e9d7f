#pragma once

#include <string>

#include "gridlock/io/xyz.hpp"
#include "gridlock/packing/soft_disks.hpp"

namespace gridlock {

/// A minimum of 64 harmonic disks in a box of side 1: "over" far above jamming, "mid", "marginal".
inline Packing harmonic64(std::string const& name) {
  return packing_of(
      read_xyz(std::string(GRIDLOCK_SOURCE_DIR "/tests/reference/packings/harmonic64_") + name + ".xyz").state);
}

/// A triangular lattice of equal disks whose overlap is δ, `columns` × `rows` in a periodic box; `rows` is even.
inline Packing triangular_lattice(std::size_t columns, std::size_t rows, double overlap) {
  double const height = 0.8660254037844386;  // √3/2
  Packing packing{.box = Box(static_cast<double>(columns), height * static_cast<double>(rows), Edge::periodic),
                  .x = {},
                  .y = {},
                  .radius = {}};
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < columns; ++column) {
      packing.x.push_back(static_cast<double>(column) + (row % 2 == 0 ? 0.25 : 0.75));
      packing.y.push_back(height * (static_cast<double>(row) + 0.5));
      packing.radius.push_back(0.5 / (1.0 - overlap));
    }
  }
  return packing;
}

}  // namespace gridlock
