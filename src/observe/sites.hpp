#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/unwrapped.hpp"
#include "gridlock/core/agents_view.hpp"
#include "gridlock/core/box.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/core/vector.hpp"

namespace gridlock {

/// Where an agent was: its position, and how many edges of a periodic box it had crossed.
struct Site {
  double x;
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
  explicit Sites(AgentsView const& agents)
      : x_(agents.column<X>()), y_(agents.column<Y>()), image_x_(agents), image_y_(agents) {}

  [[nodiscard]] Site operator[](std::size_t row) const {
    return {.x = x_[row], .y = y_[row], .image_x = image_x_[row], .image_y = image_y_[row]};
  }
  /// Returns the displacement of the agent in a row from an earlier site, around the box as often as it went.
  [[nodiscard]] Vector moved(Box const& box, Site const& from, std::size_t row) const {
    double const crossed_x = static_cast<double>(image_x_[row]) - static_cast<double>(from.image_x);
    double const crossed_y = static_cast<double>(image_y_[row]) - static_cast<double>(from.image_y);
    return unwrapped_displacement(box, {from.x, from.y}, {x_[row], y_[row]}, {crossed_x, crossed_y});
  }

 private:
  std::span<double const> x_;
  std::span<double const> y_;
  EdgeCrossings<ImageX> image_x_;
  EdgeCrossings<ImageY> image_y_;
};

}  // namespace gridlock
