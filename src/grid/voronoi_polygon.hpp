#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "gridlock/core/vector.hpp"

namespace gridlock {

/// A convex polygon around the origin, cut by half planes; corners are counterclockwise.
class VoronoiPolygon {
 public:
  static constexpr std::uint32_t nobody = std::numeric_limits<std::uint32_t>::max();

  struct Corner {
    Vector at;
    std::uint32_t neighbour;  ///< index of the point whose bisector is the edge that begins here
  };

  /// Begins with the rectangle from `least` to `most`. Its left and right edges belong to `beside`, the others to
  /// `above`.
  void begin(Vector least, Vector most, std::uint32_t beside, std::uint32_t above) {
    corners_ = {{least, above}, {{most.x, least.y}, beside}, {most, above}, {{least.x, most.y}, beside}};
    measure();
  }

  /// Removes the part that is nearer to the point `separation` than to the origin.
  void cut(Vector separation, std::uint32_t neighbour) {
    double const square = squared_length(separation);
    if (square >= 4.0 * squared_radius_) return;
    double farthest = 0.0;
    for (Corner const& corner : corners_) farthest = std::max(farthest, dot(separation, corner.at));
    // A bisector that only touches a corner, up to rounding, does not cut.
    if (farthest <= square * (0.5 + tolerance)) return;
    beyond_.clear();
    for (Corner const& corner : corners_) beyond_.push_back(dot(separation, corner.at) - 0.5 * square);
    replace(tolerance * square, neighbour);
  }

  /// The squared distance of the farthest corner from the origin.
  [[nodiscard]] double squared_radius() const { return squared_radius_; }

  [[nodiscard]] double area() const {
    double twice = 0.0;
    for (std::size_t k = 0; k < corners_.size(); ++k) twice += cross(corners_[k].at, after(k).at);
    return 0.5 * twice;
  }

  /// Calls visit(neighbour, length) for every edge that is at least 10⁻⁹ of the polygon's size long.
  template <class Visit>
  void for_each_neighbour(Visit visit) const {
    for (std::size_t k = 0; k < corners_.size(); ++k) {
      double const square = squared_length(after(k).at - corners_[k].at);
      bool const is_edge = square > 1e-18 * squared_radius_;
      if (is_edge && corners_[k].neighbour != nobody) visit(corners_[k].neighbour, std::sqrt(square));
    }
  }

 private:
  static constexpr double tolerance = 1e-12;

  static double dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y; }
  static double cross(Vector a, Vector b) { return a.x * b.y - a.y * b.x; }
  [[nodiscard]] Corner const& after(std::size_t k) const { return corners_[k + 1 == corners_.size() ? 0 : k + 1]; }

  /// Replaces all corners that are beyond the bisector by more than the tolerance.
  void replace(double limit, std::uint32_t neighbour) {
    kept_.clear();
    for (std::size_t k = 0; k < corners_.size(); ++k) {
      std::size_t const next = k + 1 == corners_.size() ? 0 : k + 1;
      bool const is_inside = beyond_[k] <= limit;
      bool const is_next_inside = beyond_[next] <= limit;
      if (is_inside) kept_.push_back(corners_[k]);
      if (is_inside == is_next_inside) continue;
      // A corner within the tolerance may lie slightly beyond.
      double const share = std::clamp(beyond_[k] / (beyond_[k] - beyond_[next]), 0.0, 1.0);
      Vector const crossing = corners_[k].at + share * (corners_[next].at - corners_[k].at);
      kept_.push_back({crossing, is_inside ? neighbour : corners_[k].neighbour});
    }
    std::swap(corners_, kept_);
    measure();
  }

  void measure() {
    squared_radius_ = 0.0;
    for (Corner const& corner : corners_) squared_radius_ = std::max(squared_radius_, squared_length(corner.at));
  }

  std::vector<Corner> corners_;
  std::vector<Corner> kept_;
  std::vector<double> beyond_;
  double squared_radius_ = 0.0;
};

}  // namespace gridlock
