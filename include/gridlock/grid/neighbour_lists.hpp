#pragma once

/// \file
/// All neighbours of many points at once, in arrays.
///
/// ```cpp
/// std::vector<double> const x{0.1, 0.9, 0.5};
/// std::vector<double> const y{0.5, 0.5, 0.5};
/// PointPairs const pairs = find_pairs(Box(1.0, 1.0, Edge::periodic), 0.3, {.x = x.data(), .y = y.data(), .count = 3});
/// std::uint32_t const first_partner = pairs.second()[0];  // 0 and 1 are 0.2 apart, around the edge
/// ```

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gridlock/core/box.hpp"
#include "gridlock/core/detail/large_array.hpp"
#include "gridlock/core/error.hpp"

namespace gridlock {

/// Points in memory: point i is at (x[i · stride], y[i · stride]). The stride is 2 for rows (x, y) of a table.
struct PointsInMemory {
  double const* x = nullptr;
  double const* y = nullptr;
  std::size_t count = 0;
  std::size_t stride = 1;
};

/// Pairs of points nearer than a cutoff, each once: pair k is (first()[k], second()[k]).
struct PointPairs {
  UninitializedArray<std::uint32_t> indices;  ///< the first points of all pairs, then the second points of all pairs

  [[nodiscard]] std::size_t size() const { return indices.size() / 2; }
  [[nodiscard]] std::span<std::uint32_t const> first() const { return std::span(indices).first(size()); }
  [[nodiscard]] std::span<std::uint32_t const> second() const { return std::span(indices).subspan(size()); }
};

/// The neighbours of every point in one list (compressed sparse rows): the neighbours of point i are
/// neighbours[begin[i]] … neighbours[begin[i + 1] − 1]. `begin` has one entry more than there are points.
struct NeighbourLists {
  std::vector<std::uint64_t> begin;
  UninitializedArray<std::uint32_t> neighbours;
};

/// Returns all pairs of points with |separation| < cutoff, for the minimum image in a periodic box.
///
/// Coordinates may be any finite numbers: a point outside a periodic box means its image inside, a point outside walls
/// stays outside. The order of the pairs depends on the points alone, not on `threads` (0: one for each core).
/// Errors: those of NeighbourSearch. Cost: docs/reference/performance.md.
PointPairs find_pairs(Box const& box, double cutoff, PointsInMemory const& points, std::uint64_t threads = 1);

/// Returns the neighbours of every point, without the point itself; see find_pairs() for order, errors and cost.
NeighbourLists find_neighbour_lists(Box const& box, double cutoff, PointsInMemory const& points,
                                    std::uint64_t threads = 1);

/// The condition for a pair of disks: |separation| < factor · (R_i + R_j) + gap.
struct DiskReach {
  double factor = 1.0;
  double gap = 0.0;
};

/// Returns all pairs of disks with |separation| < factor · (R_i + R_j) + gap, for the minimum image in a periodic box.
/// The disk at point i has radius[i].
///
/// Disks of similar size share a grid of cells, and small disks search for large disks in the coarse grid: a few large
/// disks among many small disks cost no more than small disks (hierarchical grids: Krijgsman, Ogarko and Luding 2014,
/// doi:10.1007/s40571-014-0020-9). The order of the pairs depends on the disks alone. Errors: those of find_pairs()
/// with the distance of the two largest disks as its cutoff; Error unless there is one positive radius for each disk
/// and the factor is positive. Cost: that of find_pairs() for equal disks; docs/reference/performance.md.
///
/// ```cpp
/// std::vector<double> const x{0.0, 5.5, 6.3};
/// std::vector<double> const y{0.0, 0.0, 0.0};
/// std::vector<double> const radius{5.0, 0.4, 0.4};
/// PointPairs const pairs = find_pairs_of_disks(Box(30.0, 30.0, Edge::periodic), {.gap = 0.2},
///                                              {.x = x.data(), .y = y.data(), .count = 3}, radius);
/// std::size_t const near = pairs.size();  // 2: disks 0 and 1 are 0.1 apart, disks 1 and 2 touch
/// ```
PointPairs find_pairs_of_disks(Box const& box, DiskReach const& reach, PointsInMemory const& centres,
                               std::span<double const> radius, std::uint64_t threads = 1);

/// Return pairs or neighbours of points in the plane, without a box; see find_pairs() above.
PointPairs find_pairs(double cutoff, PointsInMemory const& points, std::uint64_t threads = 1);
NeighbourLists find_neighbour_lists(double cutoff, PointsInMemory const& points, std::uint64_t threads = 1);

}  // namespace gridlock
