#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "gridlock/core/detail/message.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/core/error.hpp"

namespace gridlock {

/// Problems of single disks, without overlaps: the first of each kind, and their number. Processes add up theirs.
class RowProblems {
 public:
  RowProblems() = default;
  /// Checks the disks of `some`, which may be beyond a wall by `beyond_walls`.
  explicit RowProblems(State const& some, double beyond_walls = 0.0);
  explicit RowProblems(MessageReader& message);
  void write(MessageWriter& message) const;

  /// Adds the problems of the rows that follow.
  void add(RowProblems const& next);

  /// Errors: Error with the text of validate() for these problems.
  void require_none(Box const& box) const;

 private:
  static constexpr std::size_t max_named = 3;
  struct Kind {
    std::vector<std::string> first;  ///< at most max_named problems
    std::size_t count = 0;

    void add(std::string text);
    void add(Kind const& next);
    void move_into(std::vector<Problem>& problems, std::string const& hint) const;
  };
  Kind not_finite_;
  Kind not_inside_;
  Kind extreme_;
  double largest_speed_ = 0.0;  ///< largest component of a velocity
};

/// Errors: Error for disks so large that they overlap their own images.
void require_no_own_images(Box const& box, double largest_radius);

/// Returns rounding_of_contact() for a smallest disk of this radius.
double rounding_of_contact(Box const& box, double smallest_radius);

/// Returns the distance between the rims, below 0, of disks that overlap by more than the tolerance; otherwise 0.
double gap_of_overlap(double contact, double squared_distance, double tolerance);

/// Two disks that overlap.
struct OverlappingPair {
  Id one;
  Id other;
  double gap;  ///< distance between the rims, below 0
};
/// Number of overlaps that an error names.
inline constexpr std::size_t max_overlaps_named = 3;
/// Returns the problems that validate() reports for `count` overlaps, of which the first are given.
std::vector<Problem> problems_of_overlaps(std::span<OverlappingPair const> first, std::size_t count);

}  // namespace gridlock
