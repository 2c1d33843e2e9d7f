#pragma once

/// \file
/// The defects of a triangular crystal: cells of Voronoi without six sides, and the clusters that they form.
///
/// ```cpp
/// std::vector<double> const x{0.25, 0.75, 0.25, 0.75};
/// std::vector<double> const y{0.2, 0.3, 0.7, 0.8};
/// PointsInMemory const points{.x = x.data(), .y = y.data(), .count = 4};
/// Box const box(1.0, 1.0, Edge::periodic);
/// Defects const found = find_defects(box, points, find_voronoi_cells(box, points).neighbours);
/// double const share = static_cast<double>(found.points) / 4.0;
/// ```

#include <cstddef>
#include <cstdint>
#include <vector>

#include "gridlock/core/box.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/core/vector.hpp"
#include "gridlock/grid/neighbour_lists.hpp"
#include "gridlock/grid/voronoi.hpp"

namespace gridlock {

/// A cluster of defects by its charges: 6 − n of a cell with n sides.
///
///     disclination        one cell of charge ±1: a free 5 or 7
///     dislocation         a 5 and a 7 side by side
///     dislocation_pair    charges +2 and −2 in all: 5-7-5-7, 5-8-5, 4-7-7 or 4-8, such as two bound dislocations, a
///                         vacancy, or an interstitial
///     other               anything else: grain boundaries, pieces of liquid
enum class DefectKind : std::uint8_t { disclination, dislocation, dislocation_pair, other };
inline constexpr std::size_t defect_kinds = 4;

/// Defects whose cells share edges, directly or through other defects.
struct DefectCluster {
  DefectKind kind = DefectKind::other;
  std::uint32_t points = 0;  ///< number of points
  std::int32_t charge = 0;   ///< Σ (6 − n)
  /// Σ (6 − n)(r − r_first), from the first point of the cluster, in lengths. Of a dislocation it is the vector from
  /// the 7 to the 5, to which the Burgers vector, of the length of the lattice spacing, is perpendicular.
  Vector moment;
};

struct Defects {
  static constexpr std::uint32_t none = 0xFFFFFFFF;

  std::size_t points = 0;               ///< number of points without six neighbours
  std::vector<std::uint32_t> cluster;   ///< the cluster of each point, `none` of a point with six neighbours
  std::vector<DefectCluster> clusters;  ///< the largest first

  /// Returns the number of points in clusters of a kind.
  [[nodiscard]] std::size_t points_in(DefectKind kind) const;
};

/// Returns the defects of points with such Voronoi neighbours.
///
/// In a periodic box Σ (6 − n) = 0 over all points, where no four cells meet in a corner, as on a square lattice.
/// Between walls the cells at the walls have fewer sides, and count as defects.
/// Contract: `neighbours` is from find_voronoi_cells() of the points.
/// Cost: O(N), 10 ns a point. Source: D. R. Nelson & B. I. Halperin (1979), doi:10.1103/PhysRevB.19.2457; the clusters:
/// Y. Lansac, M. A. Glaser & N. A. Clark (2006), doi:10.1103/PhysRevE.73.041501.
Defects find_defects(Box const& box, PointsInMemory const& points, NeighbourLists const& neighbours);

}  // namespace gridlock
