#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "gridlock/core/box.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/core/vector.hpp"
#include "gridlock/engine/grains.hpp"
#include "gridlock/grid/cell_layout.hpp"

namespace gridlock {

/// A thing that never moves: all points within `radius` of the line between two points. A wall inside the box has the
/// radius 0; of a fixed disk the two points are one.
struct Obstacle {
  Vector from;
  Vector to;
  double radius = 0.0;
  std::uint8_t kind = 0;  ///< kind of a fixed disk, where collisions tell kinds apart

  [[nodiscard]] bool is_disk() const { return radius > 0.0; }
  /// Returns the point of the line that is nearest to p.
  [[nodiscard]] constexpr Vector nearest_to(Vector p) const {
    Vector const along = to - from;
    double const squared = squared_length(along);
    if (!(squared > 0.0)) return from;
    double const part = std::clamp(dot(p - from, along) / squared, 0.0, 1.0);
    return part == 1.0 ? to : from + part * along;
  }
};

/// Overlap of a disk and a wall that counts as rounding, in radii.
inline constexpr double rounding_at_walls = 1e-11;

/// Returns the walls of valid settings.
std::vector<Obstacle> obstacles_of(std::span<WallSettings const> walls);

/// Returns "the wall from (0, 0) to (1, 1)" or "the fixed disk at (0.5, 0.5)".
std::string to_text(Obstacle const& obstacle);

/// The obstacles of a box, in a grid that finds those around a disk; the arrays belong to somebody else.
struct ObstaclesView {
  std::span<Obstacle const> all;
  CellLayout layout;  ///< of a box between walls, since images are obstacles of their own
  std::span<std::size_t const> begin_of_cell;
  std::span<std::uint32_t const> in_cells;

  [[nodiscard]] constexpr bool empty() const { return all.empty(); }
  [[nodiscard]] constexpr Obstacle const& operator[](std::size_t k) const { return all[k]; }

  /// Returns whether a disk may touch an obstacle on its way between two points.
  [[nodiscard]] constexpr bool may_be_met(Vector from, Vector to) const {
    bool is_any_near = false;
    for_each_near({std::min(from.x, to.x), std::min(from.y, to.y)}, {std::max(from.x, to.x), std::max(from.y, to.y)},
                  [&](std::uint32_t /*k*/) { is_any_near = true; });
    return is_any_near;
  }

  /// Calls visit(k) for every obstacle that a disk with its centre in this rectangle may touch, for some more, and for
  /// some of them twice. Contract: the obstacles are not empty.
  template <class Visit>
  constexpr void for_each_near(Vector lower, Vector upper, Visit visit) const {
    for_each_cell(lower, upper, [&](std::size_t cell, int /*column*/, int /*row*/) {
      for (std::size_t k = begin_of_cell[cell]; k < begin_of_cell[cell + 1]; ++k) visit(in_cells[k]);
    });
  }

  /// Calls visit(cell, column, row) for the cells of a rectangle.
  template <class Visit>
  constexpr void for_each_cell(Vector lower, Vector upper, Visit visit) const {
    int const last_column = layout.column_of(upper.x);
    int const last_row = layout.row_of(upper.y);
    for (int row = layout.row_of(lower.y); row <= last_row; ++row) {
      for (int column = layout.column_of(lower.x); column <= last_column; ++column) {
        std::size_t const first = static_cast<std::size_t>(row) * static_cast<std::size_t>(layout.columns());
        visit(first + static_cast<std::size_t>(column), column, row);
      }
    }
  }
};

/// The obstacles of a box. In a periodic box the images that reach into the box are obstacles of their own.
class Obstacles {
 public:
  Obstacles() = default;
  /// Disks that move have at most this radius.
  Obstacles(Box const& box, std::span<Obstacle const> obstacles, double largest_radius);

  [[nodiscard]] bool empty() const { return all_.empty(); }
  [[nodiscard]] std::size_t size() const { return all_.size(); }
  [[nodiscard]] Obstacle const& operator[](std::size_t k) const { return all_[k]; }
  /// Returns the obstacles, valid as long as this object.
  [[nodiscard]] ObstaclesView view() const { return {all_, layout_, begin_of_cell_, in_cells_}; }

 private:
  std::vector<Obstacle> all_;
  CellLayout layout_;
  std::vector<std::size_t> begin_of_cell_;
  std::vector<std::uint32_t> in_cells_;
};

/// Returns the walls of valid settings for disks of at most this radius.
Obstacles walls_of(std::span<WallSettings const> walls, Box const& box, double largest_radius);

}  // namespace gridlock
