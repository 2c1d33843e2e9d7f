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

/// Where the centre of a disk of some radius may be.
class AllowedCentres {
 public:
  AllowedCentres(Box const& box, double radius)
      : x_(along(box, box.width(), radius)), y_(along(box, box.height(), radius)) {}

  /// Whether the disk is too large for the box.
  [[nodiscard]] bool are_none() const { return x_.length < 0.0 || y_.length < 0.0; }
  /// A uniform point.
  [[nodiscard]] Vector draw(RandomStream& random) const {
    double const along_x = random.uniform();
    return {x_.first + x_.length * along_x, y_.first + y_.length * random.uniform()};
  }

 private:
  struct Span {
    double first;
    double length;
  };
  static Span along(Box const& box, double side, double radius) {
    return box.is_periodic() ? Span{0.0, side} : Span{radius, side - 2.0 * radius};
  }

  Span x_;
  Span y_;
};

/// The random numbers of a disk, which its places are drawn from.
inline RandomStream places_of(std::uint64_t seed, std::uint64_t row) { return {seed, 0, row, Purpose::start_position}; }

/// A random insertion of so many disks is given up after that many places that were not free.
constexpr std::uint64_t max_attempts_for(std::uint64_t disks) { return 1'000'000 + 1000 * disks; }

/// Puts disks down one after the other, each where a uniform point is free; the largest go first, since they would find
/// no room later. Memory: 50 bytes a disk.
class RandomInsertion {
 public:
  /// Contract: one radius or more.
  RandomInsertion(Box const& box, std::vector<double> radii, std::uint64_t seed);

  /// Places every disk, or gives up; says how many have a place.
  std::size_t place_all();

  /// The packing fraction of the disks that have a place.
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
  double covered_ = 0.0;  ///< area of the disks that have a place
};

}  // namespace gridlock
