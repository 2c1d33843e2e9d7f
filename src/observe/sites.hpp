#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "gridlock/core/agents_view.hpp"
#include "gridlock/core/box.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/core/vector.hpp"

namespace gridlock {

/// Where an agent was: its position, and how many edges of a periodic box it had crossed.
struct Site {
  double x;  ///< with the shifts of the images above that it had come to, in an oblique box
  double y;
  std::int32_t image_x;
  std::int32_t image_y;
};

/// The numbers of edges that agents have crossed; 0 for agents without such a column.
template <class Image>
class EdgeCrossings {
 public:
  explicit EdgeCrossings(AgentsView const& agents) {
    if (agents.has<Image>()) images_ = agents.column<Image>();
  }
  std::int32_t operator[](std::size_t row) const { return images_.empty() ? 0 : images_[row]; }

 private:
  std::span<std::int32_t const> images_;
};

/// The sites of agents now, and how far they have moved. Contract: the agents have x and y, and in a periodic box
/// image_x and image_y.
class Sites {
 public:
  Sites(Box const& box, AgentsView const& agents)
      : box_(box), x_(agents.column<X>()), y_(agents.column<Y>()), image_x_(agents), image_y_(agents) {}

  [[nodiscard]] Site operator[](std::size_t row) const {
    return {
        .x = x_[row] + image_y_[row] * box_.shift(), .y = y_[row], .image_x = image_x_[row], .image_y = image_y_[row]};
  }
  /// Returns the displacement of the agent in a row from an earlier site, around the box as often as it went. The box
  /// may have had another shift then.
  [[nodiscard]] Vector moved(Site const& from, std::size_t row) const {
    Site const now = (*this)[row];
    double const crossed_x = static_cast<double>(now.image_x) - static_cast<double>(from.image_x);
    double const crossed_y = static_cast<double>(now.image_y) - static_cast<double>(from.image_y);
    return {(now.x - from.x) + crossed_x * box_.width(), (now.y - from.y) + crossed_y * box_.height()};
  }

 private:
  Box box_;
  std::span<double const> x_;
  std::span<double const> y_;
  EdgeCrossings<ImageX> image_x_;
  EdgeCrossings<ImageY> image_y_;
};

}  // namespace gridlock
