#pragma once

/// \file
/// Voronoi cells: which part of the box is nearest to which point, and whose cells share an edge.
///
/// ```cpp
/// std::vector<double> const x{0.25, 0.75, 0.25, 0.75};
/// std::vector<double> const y{0.2, 0.3, 0.7, 0.8};
/// VoronoiCells const cells = find_voronoi_cells(Box(1.0, 1.0, Edge::periodic), {.x = x.data(), .y = y.data(), .count = 4});
/// double const area = cells.areas[0];  // all areas together are that of the box
/// ```

#include <cstdint>
#include <vector>

#include "gridlock/core/box.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/grid/neighbour_lists.hpp"

namespace gridlock {

struct VoronoiCells {
  /// Whose cells share an edge with that of a point, counterclockwise; one entry for each edge.
  NeighbourLists neighbours;
  std::vector<double> areas;
};

/// The Voronoi cell of every point: all places of the box that are nearer to it than to any other point or image of
/// one.
///
/// Walls cut cells, and two points are neighbours where their cells share an edge inside the box. In a periodic box of
/// few points a point can be a neighbour twice, and its own, through the edges. Edges shorter than 10⁻⁹ of the cell do
/// not count, so that on a square lattice, where four cells meet, every point has four neighbours. Neighbours are
/// always mutual. A cell is cut by half planes, ring of grid cells by ring, until all points are farther than twice its
/// farthest corner.
/// Errors: Error for points that are not finite, at the same place, or outside walls. Coordinates outside a periodic
/// box are those of the image inside. The result does not depend on `threads` (0: all cores).
/// Cost: 1 µs a point where they are even; up to 40 ns · N a point where nearly all are on a line or in a small part of
/// the box.
/// Source: G. Voronoi (1908), doi:10.1515/crll.1908.134.198; cutting cell by cell: C. H. Rycroft (2009),
/// doi:10.1063/1.3215722.
VoronoiCells find_voronoi_cells(Box const& box, PointsInMemory const& points, std::uint64_t threads = 1);

/// |ψ6| of every point: how nearly the directions to its Voronoi neighbours are those of a regular hexagon, 1 for all at once.
///
///     ψ6(j) = (1/n_j) Σ_k exp(6 i θ_jk)
///
/// over the n_j points k whose cells share an edge with that of j, θ_jk the direction to the nearest image of k. 0
/// without neighbours.
/// Contract: `neighbours` are those that find_voronoi_cells() has found for the points.
/// Source: D. R. Nelson & B. I. Halperin (1979), doi:10.1103/PhysRevB.19.2457.
std::vector<double> local_bond_orientation_orders(Box const& box, PointsInMemory const& points,
                                                  NeighbourLists const& neighbours);

}  // namespace gridlock
