#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "gridlock/core/detail/message.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/core/error.hpp"

namespace gridlock {

/// The problems of disks by themselves, whether they overlap or not: the first few of each kind, and how many there
/// are. Several processes add up what they find in their rows.
class RowProblems {
 public:
  RowProblems() = default;
  /// A disk may be so far beyond a wall.
  explicit RowProblems(State const& some, double beyond_walls = 0.0);
  explicit RowProblems(MessageReader& message);
  void write(MessageWriter& message) const;

  /// Those of the rows that follow.
  void add(RowProblems const& next);

  /// Errors: Error with what validate() says of these.
  void require_none(Box const& box) const;

 private:
  static constexpr std::size_t max_named = 3;
  struct Kind {
    std::vector<std::string> first;  ///< max_named at most
    std::size_t count = 0;

    void add(std::string text);
    void add(Kind const& next);
    void move_into(std::vector<Problem>& problems, std::string const& hint) const;
  };
  Kind not_finite_;
  Kind not_inside_;
  Kind extreme_;
  double largest_speed_ = 0.0;  ///< the largest component of a velocity
};

/// Errors: Error for disks so large that they overlap their own images.
void require_no_own_images(Box const& box, double largest_radius);

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
inline constexpr std::size_t max_overlaps_named = 3;
/// The problems that validate() reports of `count` overlaps, the first of which are given.
std::vector<Problem> problems_of_overlaps(std::span<OverlappingPair const> first, std::size_t count);

}  // namespace gridlock
