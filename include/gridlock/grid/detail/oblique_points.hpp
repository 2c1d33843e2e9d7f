#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gridlock/core/box.hpp"

namespace gridlock {

/// The points of an oblique box and their images within a distance of the lower and the upper edge, in a box that is
/// periodic along x alone and has room for them above and below. So every search for rectangles serves oblique boxes.
///
/// Points own() … size() − 1 are images, those above the box first. Contract: the distance is at most half the height.
class ObliquePoints {
 public:
  /// Which images: those above the upper edge, with which each pair is found once, or also those below the lower edge.
  enum class Images { above, around };

  /// Point i is at (x[i · stride], y[i · stride]).
  ObliquePoints(Box const& box, double distance, double const* x, double const* y, std::size_t count,
                std::size_t stride, Images images);
  ObliquePoints(Box const& box, double distance, std::span<double const> x, std::span<double const> y, Images images)
      : ObliquePoints(box, distance, x.data(), y.data(), x.size(), 1, images) {}

  /// Returns the box that contains points and images. Its origin is `distance` below that of the oblique box.
  [[nodiscard]] Box const& frame() const { return frame_; }
  [[nodiscard]] std::vector<double> const& x() const { return x_; }
  [[nodiscard]] std::vector<double> const& y() const { return y_; }
  [[nodiscard]] std::size_t own() const { return own_; }
  [[nodiscard]] std::size_t size() const { return x_.size(); }
  /// Returns the number of the point that point k is, or is an image of.
  [[nodiscard]] std::uint32_t point(std::size_t k) const {
    return k < own_ ? static_cast<std::uint32_t>(k) : point_of_image_[k - own_];
  }
  /// Returns where a point of the oblique box lies in the frame.
  [[nodiscard]] Vector place(Vector p) const;

  /// Returns whether a pair of the frame is the one of all images of this pair that counts.
  [[nodiscard]] bool counts(std::size_t i, std::size_t j) const {
    return std::min(i, j) < own_ && std::max(i, j) < end_of_images_above_;
  }

 private:
  Box box_;
  double distance_;
  Box frame_;
  std::size_t own_;
  std::size_t end_of_images_above_ = 0;
  std::vector<double> x_, y_;
  std::vector<std::uint32_t> point_of_image_;
};

/// Returns a distance slightly larger than a cutoff. Images lie where they do by rounding, so a search finds all that
/// are within this distance, and the nearest image in the box decides which are within the cutoff.
inline double searched_distance(double cutoff) { return cutoff * (1.0 + 1e-9); }

}  // namespace gridlock
