#pragma once

/// \file
/// The structure factor in the plane of wave vectors, around a peak.
///
/// ```cpp
/// #include <numbers>
///
/// std::vector<double> const x{0.25, 0.75}, y{0.25, 0.75};
/// PointsInMemory const points{.x = x.data(), .y = y.data(), .count = 2};
/// double const q = 2.0 * std::numbers::pi;
/// StructurePeak const peak = find_structure_peak(Box(1.0, 1.0, Edge::periodic), points, {q, q}, 0.5 * q);
/// double const height = peak.height;  // 1: both points are on one lattice
/// ```

#include <cstdint>
#include <vector>

#include "gridlock/core/box.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/core/vector.hpp"
#include "gridlock/grid/neighbour_lists.hpp"

namespace gridlock {

/// S(q) on the wave vectors of a box in a square, and the largest of them.
struct StructurePeak {
  Vector at;            ///< G, the wave vector of the largest S, in 1/length
  double height = 0.0;  ///< S(G)/N, from 0 to 1
  std::vector<Vector> wave_vectors;
  std::vector<double> structure_factor;  ///< S of each of them
};

/// Returns the structure factor on the wave vectors q of a periodic box with |q_x − c_x| and |q_y − c_y| ≤ half_width.
///
///     S(q) = |Σ_j exp(i q·r_j)|² / N
///
/// q = 0 is left out. The peak at G = (4π/√3 a)(cos θ, sin θ) of a triangular lattice of spacing a, with bonds at θ +
/// 30°, is a Bragg peak in a crystal, whose height S(G)/N tends to a constant, or to a power of N in two dimensions,
/// and 1/N without positional order. For independent Gaussian displacements of standard deviation s along each axis
/// S(G)/N = e^(−G²s²) + (1 − e^(−G²s²))/N. Errors: Error for a box that is not periodic, no points, a square without
/// wave vectors or with more than 10⁸, and points that are not finite. The result does not depend on `threads` (0: one
/// for each core). Cost: 3 ns a point and wave vector. Source: B. E. Warren, X-Ray Diffraction (1969), chapter 3; in
/// two dimensions D. R. Nelson & B. I. Halperin (1979), doi:10.1103/PhysRevB.19.2457.
StructurePeak find_structure_peak(Box const& box, PointsInMemory const& points, Vector centre, double half_width,
                                  std::uint64_t threads = 1);

}  // namespace gridlock
