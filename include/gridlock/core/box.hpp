#pragma once

/// \file
/// The box: a rectangle with walls or periodic edges, also sheared, and distances in it.
///
/// ```cpp
/// Box const box(2.0, 1.0, Edge::periodic);
/// Vector const separation = box.displacement({1.9, 0.5}, {0.1, 0.5});  // (0.2, 0), to the nearest image
/// Box const channel(2.0, 1.0, Edge::periodic, Edge::wall);  // periodic in x, with a floor and a lid
/// int crossed_x = 0, crossed_y = 0;
/// Vector const inside = box.wrap({2.1, 0.5}, crossed_x, crossed_y);  // (0.1, 0.5), and crossed_x is 1
/// Box const oblique = box.tilted(0.25);  // the images above are 0.25 farther to the right
/// ```

#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>

#include "gridlock/core/vector.hpp"

namespace gridlock {

/// The kind of border that a box has on two opposite sides: hard walls, or periodic edges.
enum class Edge : std::int32_t { wall, periodic };

/// The rectangle [0, width] × [0, height] that contains all agents. The edges of x are the left and right sides, the
/// edges of y the bottom and the top; both may be hard walls or periodic.
///
///     x and y walls: a closed box   x periodic, y walls: a channel   both periodic: no border
///
/// Along a periodic axis a point outside is an image of a point inside, at any distance. Beyond a wall it is no image.
///
/// Along a periodic axis every displacement goes to the nearest image. Searches for neighbours need distances below
/// half the shorter periodic side; engines refuse boxes that are too small for their cutoff.
///
/// A periodic box may be oblique, with the tilt t = xy/L_y of a simple shear: the images of a point are at
/// (n L_x + m t L_y, m L_y). Points stay in the rectangle, which is a unit cell of that lattice too: across the upper
/// edge a point comes in at the bottom, t L_y farther to the left. Tilts that differ by L_x/L_y have the same images,
/// so a box keeps the one between −½ L_x/L_y and ½ L_x/L_y, see tilted().
/// Errors: a side that is not finite and positive throws Error.
class Box {
 public:
  Box() = default;
  Box(double width, double height, Edge edge) : Box(width, height, edge, edge) {}
  Box(double width, double height, Edge edge_x, Edge edge_y);

  [[nodiscard]] constexpr double width() const { return width_; }
  [[nodiscard]] constexpr double height() const { return height_; }
  [[nodiscard]] double area() const { return width_ * height_; }
  /// Returns the tilt xy/L_y; 0 for a rectangle.
  [[nodiscard]] double tilt() const { return shift_ / height_; }
  /// Returns xy, by which the images above are farther to the right.
  [[nodiscard]] constexpr double shift() const { return shift_; }
  [[nodiscard]] constexpr bool is_oblique() const { return shift_ != 0.0; }
  /// Returns this box with a tilt, which is brought between −½ L_x/L_y and ½ L_x/L_y by whole boxes.
  /// Errors: Error for a tilt that is not finite, and for a tilt other than 0 of a box that has walls.
  [[nodiscard]] Box tilted(double tilt) const { return shifted(tilt * height_); }
  /// Returns this box with a shift xy, which is brought between −½ L_x and ½ L_x. Errors: those of tilted().
  [[nodiscard]] Box shifted(double shift) const;
  /// Returns the number of widths by which shifted() reduces a shift. A disk that has crossed m edges of y has crossed
  /// m times as many edges of x more in the box that shifted() returns.
  [[nodiscard]] double widths_in(double shift) const { return std::round(shift / width_); }
  /// Returns √area: the side of a square box, and the unit of length in which displacements are quoted for a
  /// rectangular box.
  [[nodiscard]] double side() const;
  [[nodiscard]] Edge edge_x() const { return edge_x_; }
  [[nodiscard]] Edge edge_y() const { return edge_y_; }
  [[nodiscard]] constexpr bool is_periodic_x() const { return edge_x_ == Edge::periodic; }
  [[nodiscard]] constexpr bool is_periodic_y() const { return edge_y_ == Edge::periodic; }
  /// Returns whether the box is periodic along x and along y.
  [[nodiscard]] constexpr bool is_periodic() const { return is_periodic_x() && is_periodic_y(); }
  /// Returns whether points have images: the box is periodic along x, along y, or along both.
  [[nodiscard]] constexpr bool has_images() const { return is_periodic_x() || is_periodic_y(); }
  [[nodiscard]] bool has_walls() const { return !is_periodic(); }
  /// Return the distance between the images of a point; infinite between walls.
  [[nodiscard]] double period_x() const { return 2.0 * half_period_x_; }
  [[nodiscard]] double period_y() const { return 2.0 * half_period_y_; }
  /// Returns the shortest distance between the images of a point; infinite where a point has none.
  [[nodiscard]] double shortest_period() const { return 2.0 * std::fmin(half_period_x_, half_period_y_); }

  /// Returns the vector from `from` to `to`, along periodic axes to the nearest image, for any finite points. It is
  /// antisymmetric to the last bit, so that it does not matter in which order two disks are tested for overlap.
  [[nodiscard]] Vector displacement(Vector from, Vector to) const {
    Vector const d = displacement_inside(from, to);
    if (has_images() && !(std::abs(d.x) <= half_period_x_ && std::abs(d.y) <= half_period_y_)) [[unlikely]] {
      return displacement_of_images(from, to);
    }
    return d;
  }

  /// Returns the same bits as displacement() with less work, for two points inside the box.
  [[nodiscard]] constexpr Vector displacement_inside(Vector from, Vector to) const {
    Vector d = to - from;
    if (has_images()) {
      // In a rectangle the shift is 0, which changes no bit of x.
      if (d.y > half_period_y_) {
        d = {d.x - shift_, d.y - height_};
      } else if (d.y < -half_period_y_) {
        d = {d.x + shift_, d.y + height_};
      }
      d.x = nearest_image(d.x, width_, half_period_x_);
    }
    return d;
  }

  /// Moves a point that is less than half a side beyond a periodic edge back into [0, width) or [0, height), and counts
  /// the edges crossed in `crossed_x` and `crossed_y` (+1 for the right or top edge). Between walls nothing changes.
  [[nodiscard]] constexpr Vector wrap(Vector p, int& crossed_x, int& crossed_y) const {
    if (is_periodic_y()) {
      if (p.y >= height_) {
        p = {p.x - shift_, p.y - height_};
        ++crossed_y;
      } else if (p.y < 0.0) {
        int const before = crossed_y;
        p.y = into_range(p.y, height_, crossed_y);
        if (crossed_y != before) p.x += shift_;
      }
    }
    if (is_periodic_x()) p.x = into_range(p.x, width_, crossed_x);
    return p;
  }

  /// Returns the image in the box of any finite point; between walls its coordinate.
  [[nodiscard]] Vector inside(Vector p) const;

  /// Returns how far the image of a point is from the point, for the edges that lie between them, as wrap() counts
  /// them.
  [[nodiscard]] Vector offset_of_image(double crossed_x, double crossed_y) const {
    return {crossed_x * width_ + crossed_y * shift_, crossed_y * height_};
  }

  friend bool operator==(Box const&, Box const&) = default;

 private:
  [[nodiscard, gnu::cold]] Vector displacement_of_images(Vector from, Vector to) const;
  static constexpr double nearest_image(double d, double side, double half) {
    if (d > half) return d - side;
    if (d < -half) return d + side;
    return d;
  }
  static constexpr double into_range(double p, double side, int& crossed) {
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
  double shift_ = 0.0;
  // Half of infinity between walls, where the nearest image is then always the point itself.
  double half_period_x_ = std::numeric_limits<double>::infinity();
  double half_period_y_ = std::numeric_limits<double>::infinity();
  Edge edge_x_ = Edge::wall;
  Edge edge_y_ = Edge::wall;
};

/// Throws Error, with the key "box.tilt", for an oblique box; `what` begins the sentence, as "the engine \"exact\"".
void require_rectangle(Box const& box, std::string_view what);

/// Returns the edges as a number, for hashes and messages: 0 for walls, 1 for a periodic box, 2 for one periodic along
/// x only, 3 for one periodic along y only.
std::uint64_t number_of_edges(Box const& box);
/// Returns a box with the edges of this number. Errors: Error for a number of no edges.
Box box_with_edges(double width, double height, std::uint64_t number);
/// Returns "periodic", "walled", or the like for texts: "a … box".
std::string_view edges_in_words(Box const& box);

/// Returns the image in [0, side) of any finite coordinate; exact but for one rounding to the precision of the side.
constexpr double image_inside(double p, double side) {
  if (p >= 0.0 && p < side) return p;
  double image = std::fmod(p, side);
  if (image < 0.0) image += side;
  // −ε + side can round to side, which is the lower edge of the next image.
  return image < side ? image : image - side;
}

}  // namespace gridlock
