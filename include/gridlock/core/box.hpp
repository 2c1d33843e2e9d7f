#pragma once

/// \file
/// The box: a rectangle with walls or periodic edges, and distances in it.
///
/// ```cpp
/// Box const box(2.0, 1.0, Edge::periodic);
/// Vector const separation = box.displacement({1.9, 0.5}, {0.1, 0.5});  // (0.2, 0), to the nearest image
/// int crossed_x = 0, crossed_y = 0;
/// Vector const inside = box.wrap({2.1, 0.5}, crossed_x, crossed_y);  // (0.1, 0.5), and crossed_x is 1
/// ```

#include <cmath>

#include "gridlock/core/vector.hpp"

namespace gridlock {

/// The kind of border that a box has: hard walls, or periodic edges.
enum class Edge { wall, periodic };

/// The rectangle [0, width] × [0, height] that contains all agents, with hard walls or periodic edges on all four
/// sides.
///
/// In a periodic box a point outside is an image of a point inside, at any distance. In a box with walls it is no
/// image.
///
/// In a periodic box every displacement goes to the nearest image. Searches for neighbours need distances below half
/// the shorter side; engines refuse boxes that are too small for their cutoff.
/// Errors: a side that is not finite and positive throws Error.
class Box {
 public:
  Box() = default;
  Box(double width, double height, Edge edge);

  [[nodiscard]] double width() const { return width_; }
  [[nodiscard]] double height() const { return height_; }
  [[nodiscard]] double area() const { return width_ * height_; }
  /// Returns √area: the side of a square box, and the unit of length in which displacements are quoted for a
  /// rectangular box.
  [[nodiscard]] double side() const;
  [[nodiscard]] Edge edge() const { return edge_; }
  [[nodiscard]] bool is_periodic() const { return edge_ == Edge::periodic; }

  /// Returns the vector from `from` to `to`, in a periodic box to the nearest image, for any finite points. It is
  /// antisymmetric to the last bit, so that it does not matter in which order two disks are tested for overlap.
  [[nodiscard]] Vector displacement(Vector from, Vector to) const {
    Vector const d = displacement_inside(from, to);
    if (is_periodic() && !(std::abs(d.x) <= half_width_ && std::abs(d.y) <= half_height_)) [[unlikely]] {
      return displacement_of_images(from, to);
    }
    return d;
  }

  /// Returns the same bits as displacement() with less work, for two points inside the box.
  [[nodiscard]] Vector displacement_inside(Vector from, Vector to) const {
    Vector d = to - from;
    if (is_periodic()) {
      d.x = nearest_image(d.x, width_, half_width_);
      d.y = nearest_image(d.y, height_, half_height_);
    }
    return d;
  }

  /// Moves a point that is less than one side outside a periodic box back into [0, width) × [0, height), and counts the
  /// edges crossed in `crossed_x` and `crossed_y` (+1 for the right or top edge). In a box with walls nothing changes.
  [[nodiscard]] Vector wrap(Vector p, int& crossed_x, int& crossed_y) const {
    if (is_periodic()) {
      p.x = into_range(p.x, width_, crossed_x);
      p.y = into_range(p.y, height_, crossed_y);
    }
    return p;
  }

  friend bool operator==(Box const&, Box const&) = default;

 private:
  [[nodiscard, gnu::cold]] Vector displacement_of_images(Vector from, Vector to) const;
  static double nearest_image(double d, double side, double half) {
    if (d > half) return d - side;
    if (d < -half) return d + side;
    return d;
  }
  static double into_range(double p, double side, int& crossed) {
    if (p >= side) {
      p -= side;
      ++crossed;
    } else if (p < 0.0) {
      p += side;
      --crossed;
      // −ε + side can round to side, which is outside [0, side): the point goes to 0 of the next image instead.
      if (p >= side) {
        p = 0.0;
        ++crossed;
      }
    }
    return p;
  }

  double width_ = 1.0;
  double height_ = 1.0;
  double half_width_ = 0.5;
  double half_height_ = 0.5;
  Edge edge_ = Edge::wall;
};

/// Returns the image in [0, side) of any finite coordinate; exact but for one rounding to the precision of the side.
double image_inside(double p, double side);

}  // namespace gridlock
