#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "grid/linked_grid.hpp"
#include "gridlock/core/box.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/core/vector.hpp"

namespace gridlock {

/// The rectangle in which the centre of a disk of some radius may lie.
class AllowedCentres {
 public:
  AllowedCentres(Box const& box, double radius)
      : x_(along(box.is_periodic_x(), box.width(), radius)), y_(along(box.is_periodic_y(), box.height(), radius)) {}

  /// Returns whether the disk is too large for the box.
  [[nodiscard]] bool are_none() const { return x_.length < 0.0 || y_.length < 0.0; }
  /// Returns a point drawn uniformly.
  [[nodiscard]] Vector draw(RandomStream& random) const {
    double const along_x = random.uniform();
    return {x_.first + x_.length * along_x, y_.first + y_.length * random.uniform()};
  }

 private:
  struct Span {
    double first;
    double length;
  };
  static Span along(bool is_periodic, double side, double radius) {
    return is_periodic ? Span{0.0, side} : Span{radius, side - 2.0 * radius};
  }

  Span x_;
  Span y_;
};

/// Returns the random numbers from which the positions of a disk are drawn.
inline RandomStream places_of(std::uint64_t seed, std::uint64_t row) { return {seed, 0, row, Purpose::start_position}; }

/// Number of attempts after which a random insertion of this many disks gives up.
constexpr std::uint64_t max_attempts_for(std::uint64_t disks) { return 1'000'000 + 1000 * disks; }

/// Inserts disks one after the other at uniform points where they overlap no other; large disks go first, because they
/// would find no space later. Memory: 50 bytes for each disk.
class RandomInsertion {
 public:
  /// Contract: `radii` is not empty.
  RandomInsertion(Box const& box, std::vector<double> radii, std::uint64_t seed);

  /// Inserts every disk, or gives up. Returns the number of disks inserted.
  std::size_t place_all();

  /// The packing fraction of the disks inserted so far.
  [[nodiscard]] double packing_fraction() const { return covered_ / box_.area(); }

  [[nodiscard]] std::vector<Vector> take_sites() { return std::move(sites_); }
  [[nodiscard]] std::uint64_t attempts() const { return max_attempts_for(radii_.size()) - attempts_left_; }

 private:
  bool place(std::size_t i);
  [[nodiscard]] bool is_free(std::size_t i, Vector p) const;

  Box box_;
  std::uint64_t seed_;
  std::vector<double> radii_;
  std::vector<Vector> sites_;
  double largest_;
  LinkedGrid grid_;
  std::uint64_t attempts_left_;
  double covered_ = 0.0;  ///< area of the disks inserted so far
};

}  // namespace gridlock
