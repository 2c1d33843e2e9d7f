#pragma once

/// \file
/// The spectral density of disks of any sizes in a periodic box, which shows how evenly they fill it at each length.
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

/// The spectral density χ_V(q), averaged over rings of wave vectors of the box.
struct SpectralDensity {
  std::vector<double> wave_number;     ///< the mean length of the wave vectors of a ring, in 1/length
  std::vector<double> density;         ///< the mean of χ_V over the wave vectors of a ring, in length²
  std::vector<std::uint64_t> vectors;  ///< number of wave vectors of a ring, counting q and −q once
};

/// Returns the spectral density of the area that disks cover, averaged over rings of wave vectors of equal width.
///
///     χ_V(q) = |Σ_j exp(i q·r_j) 2π R_j J₁(q R_j)/q|² / A
///
/// It vanishes for q → 0 if the disks are hyperuniform, also for disks of several sizes, whose structure factor does
/// not vanish. Overlaps count twice. Rings without wave vectors are left out.
/// Errors: Error for a box that is not periodic, other than one positive radius for each point, no bins or more than
/// 10⁷, a largest wave number that is not positive, and more than 10⁸ wave vectors. The result does not depend on
/// `threads` (0: one for each core).
/// Cost: 2 ns a disk and wave vector, and 40 ns a wave vector and different radius.
/// Source: C. E. Zachary, Y. Jiao, S. Torquato (2011), doi:10.1103/PhysRevE.83.051308.
SpectralDensity find_spectral_density(Box const& box, PointsInMemory const& points, std::span<double const> radii,
                                      double largest_wave_number, std::size_t bins, std::uint64_t threads = 1);

}  // namespace gridlock
