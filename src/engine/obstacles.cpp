#include "engine/obstacles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace gridlock {

namespace {

/// Cells for each obstacle, about, as long as disks fit into a cell.
constexpr double cells_per_obstacle = 4.0;

}  // namespace

std::string to_text(Obstacle const& obstacle) {
  Vector const from = obstacle.from;
  Vector const to = obstacle.to;
  if (obstacle.is_disk()) return fmt::format("the fixed disk at ({:.6g}, {:.6g})", from.x, from.y);
  return fmt::format("the wall from ({:.6g}, {:.6g}) to ({:.6g}, {:.6g})", from.x, from.y, to.x, to.y);
}

Obstacles::Obstacles(Box const& box, std::span<Obstacle const> obstacles, double largest_radius) {
  // A factor above 1 covers the rounding of places and paths.
  auto const reach_of = [&](Obstacle const& obstacle) { return (obstacle.radius + largest_radius) * (1.0 + 1e-6); };
  double const last_image_x = box.is_oblique() ? 2.0 : box.is_periodic_x() ? 1.0 : 0.0;
  double const last_image_y = box.is_periodic_y() ? 1.0 : 0.0;
  for (Obstacle const& obstacle : obstacles) {
    double const reach = reach_of(obstacle);
    for (double n = -last_image_x; n <= last_image_x; n += 1.0) {
      for (double m = -last_image_y; m <= last_image_y; m += 1.0) {
        Vector const shift = box.offset_of_image(n, m);
        Obstacle const image{obstacle.from + shift, obstacle.to + shift, obstacle.radius, obstacle.kind};
        bool const is_near =
            std::max(image.from.x, image.to.x) >= -reach && std::min(image.from.x, image.to.x) <= box.width() + reach &&
            std::max(image.from.y, image.to.y) >= -reach && std::min(image.from.y, image.to.y) <= box.height() + reach;
        if (is_near) all_.push_back(image);
      }
    }
  }
  if (all_.empty()) return;
  // A box in which no disk moves has no radius to fit into the cells.
  double const cutoff = std::max(2.0 * largest_radius, std::numeric_limits<double>::min());
  layout_ = layout_for_cutoff(Box(box.width(), box.height(), Edge::wall), cutoff, all_.size(), cells_per_obstacle);
  Vector const cell{layout_.cell_width(), layout_.cell_height()};
  double const half_diagonal = 0.5 * std::sqrt(squared_length(cell));
  std::vector<std::vector<std::uint32_t>> of_cell(static_cast<std::size_t>(layout_.count()));
  for (std::uint32_t k = 0; k < all_.size(); ++k) {
    Obstacle const& obstacle = all_[k];
    double const reach = reach_of(obstacle);
    double const farthest = reach + half_diagonal;
    auto const [left, right] = std::minmax(obstacle.from.x, obstacle.to.x);
    auto const [bottom, top] = std::minmax(obstacle.from.y, obstacle.to.y);
    Vector const lower{left - reach, bottom - reach};
    view().for_each_cell(lower, {right + reach, top + reach}, [&](std::size_t of, int column, int row) {
      Vector const middle{(static_cast<double>(column) + 0.5) * cell.x, (static_cast<double>(row) + 0.5) * cell.y};
      if (squared_length(middle - obstacle.nearest_to(middle)) > farthest * farthest) return;
      of_cell[of].push_back(k);
    });
  }
  begin_of_cell_.push_back(0);
  for (std::vector<std::uint32_t> const& names : of_cell) {
    in_cells_.insert(in_cells_.end(), names.begin(), names.end());
    begin_of_cell_.push_back(in_cells_.size());
  }
}

}  // namespace gridlock
