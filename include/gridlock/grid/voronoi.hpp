#pragma once

/// \file
/// The Voronoi cells of points, their areas, neighbours and edges.
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
  /// The Voronoi neighbours of each point, counterclockwise; one entry for each edge of the cell.
  NeighbourLists neighbours;
  std::vector<double> areas;
  std::vector<double> edge_lengths;  ///< of the edge with each entry of `neighbours`
};

/// Returns the Voronoi cell of every point: the part of the box that is nearer to it than to any other point or image.
///
/// Walls cut cells, and two points are neighbours if their cells share an edge inside the box. In a periodic box of few
/// points a point can be a neighbour of another twice, or of itself, through the edges of the box. Edges shorter than
/// 10⁻⁹ of the cell do not count: on a square lattice, where four cells meet at a corner, every point has four
/// neighbours. Neighbours are always mutual. Method: half planes cut a cell, for points in growing rings of grid cells,
/// until all other points are farther away than twice its farthest corner. Errors: Error for points that are not
/// finite, at the same position, or outside walls. A point outside a periodic box means its image inside. The result
/// does not depend on `threads` (0: one for each core). Cost: 1 µs a point for points that are spread evenly; up to 40
/// ns · N a point if nearly all are on a line or in a small part of the box. Source: G. Voronoi (1908),
/// doi:10.1515/crll.1908.134.198; cutting cell by cell: C. H. Rycroft (2009), doi:10.1063/1.3215722.
VoronoiCells find_voronoi_cells(Box const& box, PointsInMemory const& points, std::uint64_t threads = 1);

}  // namespace gridlock
