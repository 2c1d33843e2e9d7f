#pragma once

/// \file
/// The bond orientation order ψ_k of points, over any neighbours and with any weights.
///
/// ```cpp
/// std::vector<double> const x{0.25, 0.75, 0.25, 0.75};
/// std::vector<double> const y{0.2, 0.3, 0.7, 0.8};
/// PointsInMemory const points{.x = x.data(), .y = y.data(), .count = 4};
/// Box const box(1.0, 1.0, Edge::periodic);
/// VoronoiCells const cells = find_voronoi_cells(box, points);
/// auto const psi4 = bond_orientations(box, points, cells.neighbours, cells.edge_lengths, 4);
/// ```

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "gridlock/core/box.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/grid/neighbour_lists.hpp"
#include "gridlock/grid/voronoi.hpp"

namespace gridlock {

/// Returns ψ_k of every point: |ψ6| is 1 where its neighbours form a regular hexagon.
///
///     ψ_k(j) = Σ_l w_jl exp(i k θ_jl) / Σ_l w_jl
///
/// over the neighbours l of point j, θ_jl the direction to the nearest image of l. `weights` has one number w for each
/// entry of the lists; empty: 1 each. With the lengths of Voronoi edges as weights, ψ_k is a Minkowski structure
/// metric: a neighbour that comes or goes has an edge of length 0, so that ψ_k does not jump. 0 without neighbours.
/// Contract: `neighbours` has lists of as many points. Errors: Error for another number of weights than of neighbours,
/// and k = 0. Cost: 10 ns a neighbour. Sources: D. R. Nelson & B. I. Halperin (1979), doi:10.1103/PhysRevB.19.2457; for
/// the weights W. Mickel, S. C. Kapfer, G. E. Schröder-Turk & K. Mecke (2013), doi:10.1063/1.4774084.
std::vector<std::complex<double>> bond_orientations(Box const& box, PointsInMemory const& points,
                                                    NeighbourLists const& neighbours,
                                                    std::span<double const> weights = {}, unsigned k = 6);

}  // namespace gridlock
