#pragma once

#include <cstdint>
#include <vector>

#include "gridlock/lattice/start.hpp"

namespace gridlock {

/// Returns the radii of `count` disks in units of their mean, in ascending order: the quantiles (k + ½)/count of the
/// distribution of the settings, so that every seed has the same sizes. It uses only + − · / and square roots, so that
/// every compiler gives the same bits.
/// Errors: Error for a spread that the distribution cannot have. Cost: up to a microsecond for each disk.
std::vector<double> sizes_in_order(DisksSettings const& settings, std::uint64_t count);

}  // namespace gridlock
