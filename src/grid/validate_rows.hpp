#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/disks_overview.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/core/error.hpp"

namespace gridlock {

/// validate() of some of all disks, but for whether they overlap. Errors: Error.
void validate_rows(State const& some, DisksOverview const& all);

/// rounding_of_contact() of disks of which the smallest has this radius.
double rounding_of_contact(Box const& box, double smallest_radius);

/// The distance between the rims of two disks, below 0, where they overlap by more than the tolerance; otherwise 0.
double gap_of_overlap(double contact, double squared_distance, double tolerance);

/// Two disks that overlap.
struct OverlappingPair {
  Id one;
  Id other;
  double gap;  ///< between their rims, below 0
};
/// How many an error names.
inline constexpr std::size_t most_overlaps_named = 3;
/// What validate() says of so many; the first of them.
std::vector<Problem> problems_of_overlaps(std::span<OverlappingPair const> first, std::size_t count);

}  // namespace gridlock
