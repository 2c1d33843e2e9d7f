#pragma once

#include <cstdint>
#include <vector>

#include "gridlock/lattice/start.hpp"

namespace gridlock {

/// The radii of `count` disks in units of their mean, from the smallest to the largest: the quantiles (k + ½)/count of
/// the distribution of the settings, so that every seed has the same sizes. Additions, multiplications, divisions and
/// square roots alone, so that every compiler gives the same bits.
/// Errors: Error for a spread that the distribution cannot have. Cost: up to a microsecond each.
std::vector<double> sizes_in_order(DisksSettings const& settings, std::uint64_t count);

}  // namespace gridlock
