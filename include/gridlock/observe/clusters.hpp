#pragma once

/// \file
/// Clusters of disks: those that touch one another, or nearly so, directly or through others.
///
/// ```cpp
/// std::vector<double> const x{0.5, 1.5, 4.0}, y{0.5, 0.5, 0.5}, radius{0.5, 0.5, 0.5};
/// Box const box(8.0, 3.0, Edge::periodic);
/// std::vector<std::uint32_t> const cluster = cluster_of_each(box, x, y, radius, 1.1);  // 0, 0, 1
/// ```

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gridlock/core/box.hpp"

namespace gridlock {

/// Returns the number of the cluster of each disk; cluster 0 is the largest, and of two of one size that with the first
/// row comes first.
///
/// Two disks are in one cluster if their centres are nearer than cutoff · (sum of their radii), to the nearest image in
/// a periodic box, or if a chain of such pairs joins them.
/// Contract: the arrays have one length, below 2³², and centres are inside the box; cutoff and radii are finite and not
/// negative.
/// Cost: O(N) for radii of similar size, about 0.5 µs a disk; O(N²) in a periodic box with a side below twice the
/// largest distance of a pair. Source: D. Stauffer & A. Aharony, Introduction to Percolation Theory (1994); union by
/// path halving: R. E. Tarjan & J. van Leeuwen (1984), doi:10.1145/62.2160.
std::vector<std::uint32_t> cluster_of_each(Box const& box, std::span<double const> x, std::span<double const> y,
                                           std::span<double const> radius, double cutoff);

/// Returns the number of the cluster of each of `count` agents, numbered as by cluster_of_each(); agents i[k] and j[k]
/// are in one cluster, for each k. Contract: i and j have one length, and their entries are below count, which is below
/// 2³².
std::vector<std::uint32_t> cluster_of_each(std::size_t count, std::span<std::uint32_t const> i,
                                           std::span<std::uint32_t const> j);

/// Returns the number of disks of each cluster, in the order of their numbers.
std::vector<std::uint64_t> sizes_of_clusters(std::span<std::uint32_t const> cluster_of_each);

}  // namespace gridlock
