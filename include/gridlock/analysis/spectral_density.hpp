#pragma once

/// \file
/// How evenly disks of any sizes fill a periodic box on each length.
///
/// ```cpp
/// std::vector<double> const x{0.25, 0.75};
/// std::vector<double> const y{0.25, 0.75};
/// std::vector<double> const radius{0.1, 0.1};
/// PointsInMemory const points{.x = x.data(), .y = y.data(), .count = 2};
/// SpectralDensity const found = find_spectral_density(Box(1.0, 1.0, Edge::periodic), points, radius, 40.0, 20);
/// double const least = found.density.front();  // of the longest waves
/// ```

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gridlock/core/box.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/grid/neighbour_lists.hpp"

namespace gridlock {

/// χ_V(q) in rings of wave vectors of the box.
struct SpectralDensity {
  std::vector<double> wave_number;     ///< the mean length of the wave vectors of a ring, in 1/length
  std::vector<double> density;         ///< the mean of χ_V over them, in length²
  std::vector<std::uint64_t> vectors;  ///< how many there are in the ring, one of every two opposite ones
};

/// The spectral density of the area that disks cover, on the wave vectors of a periodic box, averaged over rings of
/// equal width.
///
///     χ_V(q) = |Σ_j exp(i q·r_j) 2π R_j J₁(q R_j)/q|² / A
///
/// It vanishes for q → 0 where the disks are hyperuniform, for disks of several sizes too, whose structure factor does
/// not. What overlaps counts twice. Rings without wave vectors are left out.
/// Errors: Error for a box that is not periodic, radii whose number is not that of the points or that are not positive,
/// no bins or more than 10⁷, a largest wave number that is not positive, and more than 10⁸ wave vectors. The result
/// does not depend on `threads` (0: all cores).
/// Cost: 2 ns a disk and wave vector, and 40 ns a wave vector and radius that differs from the others.
/// Source: C. E. Zachary, Y. Jiao, S. Torquato (2011), doi:10.1103/PhysRevE.83.051308.
SpectralDensity find_spectral_density(Box const& box, PointsInMemory const& points, std::span<double const> radii,
                                      double largest_wave_number, std::size_t bins, std::uint64_t threads = 1);

}  // namespace gridlock
