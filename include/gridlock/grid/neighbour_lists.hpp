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

/// Points in memory: point i is at (x[i · stride], y[i · stride]). Rows of a table of two columns have stride 2.
struct PointsInMemory {
  double const* x = nullptr;
  double const* y = nullptr;
  std::size_t count = 0;
  std::size_t stride = 1;
};

/// Pairs of points nearer than a cutoff, each once: pair k is (first()[k], second()[k]).
struct PointPairs {
  UninitializedArray<std::uint32_t> indices;  ///< all first ones, and behind them all second ones

  [[nodiscard]] std::size_t size() const { return indices.size() / 2; }
  [[nodiscard]] std::span<std::uint32_t const> first() const { return std::span(indices).first(size()); }
  [[nodiscard]] std::span<std::uint32_t const> second() const { return std::span(indices).subspan(size()); }
};

/// The neighbours of every point in one list (compressed sparse rows): those of point i are
/// neighbours[begin[i]] … neighbours[begin[i + 1] − 1]. `begin` has one entry more than there are points.
struct NeighbourLists {
  std::vector<std::uint64_t> begin;
  UninitializedArray<std::uint32_t> neighbours;
};

/// All pairs of points with |separation| < cutoff, the minimum image in a periodic box.
///
/// Coordinates may be any finite numbers: outside a periodic box they stand for the image inside, outside walls for
/// themselves. The order of the pairs is a function of the points alone, not of `threads` (0: all cores).
/// Errors: those of NeighbourSearch. Cost: docs/reference/performance.md.
PointPairs find_pairs(Box const& box, double cutoff, PointsInMemory const& points, std::uint64_t threads = 1);

/// The neighbours of every point, itself left out; see find_pairs().
NeighbourLists find_neighbour_lists(Box const& box, double cutoff, PointsInMemory const& points,
                                    std::uint64_t threads = 1);

/// How near two disks must be: |separation| < factor · (R_i + R_j) + gap.
struct DiskReach {
  double factor = 1.0;
  double gap = 0.0;
};

/// All pairs of disks that are so near, the minimum image in a periodic box; radius[i] is that of the disk at point i.
///
/// Disks of like size share a grid of cells, and a small disk looks for large ones in theirs, so that few large disks
/// among many small ones cost what as many small ones do (hierarchical grids: Krijgsman, Ogarko and Luding 2014,
/// doi:10.1007/s40571-014-0020-9). The order of the pairs is a function of the disks alone.
/// Errors: those of find_pairs() with the reach of the two largest; Error for other than one radius a disk, radii that
/// are not positive, and a factor that is not.
/// Cost: that of find_pairs() for equal disks; docs/reference/performance.md.
///
/// ```cpp
/// std::vector<double> const x{0.0, 5.5, 6.3};
/// std::vector<double> const y{0.0, 0.0, 0.0};
/// std::vector<double> const radius{5.0, 0.4, 0.4};
/// PointPairs const pairs = find_pairs_of_disks(Box(30.0, 30.0, Edge::periodic), {.gap = 0.2}, {.x = x.data(), .y = y.data(), .count = 3}, radius);
/// std::size_t const near = pairs.size();  // 2: the large disk and the first small one are 0.1 apart, the two small ones touch
/// ```
PointPairs find_pairs_of_disks(Box const& box, DiskReach const& reach, PointsInMemory const& centres,
                               std::span<double const> radius, std::uint64_t threads = 1);

/// The same for points without a box, wherever they are.
PointPairs find_pairs(double cutoff, PointsInMemory const& points, std::uint64_t threads = 1);
NeighbourLists find_neighbour_lists(double cutoff, PointsInMemory const& points, std::uint64_t threads = 1);

}  // namespace gridlock
