#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "gridlock/core/box.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/core/vector.hpp"
#include "gridlock/engine/grains.hpp"

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
  [[nodiscard]] Vector nearest_to(Vector p) const;
};

/// Overlap of a disk and a wall that counts as rounding, in radii.
inline constexpr double rounding_at_walls = 1e-11;

/// Returns the walls of valid settings.
std::vector<Obstacle> obstacles_of(std::span<WallSettings const> walls);

/// Returns "the wall from (0, 0) to (1, 1)" or "the fixed disk at (0.5, 0.5)".
std::string to_text(Obstacle const& obstacle);

/// The obstacles of a box, in a grid that finds those around a disk. In a periodic box the images that reach into the
/// box are obstacles of their own.
class Obstacles {
 public:
  Obstacles() = default;
  /// Disks that move have at most this radius.
  Obstacles(Box const& box, std::span<Obstacle const> obstacles, double largest_radius);

  [[nodiscard]] bool empty() const { return all_.empty(); }
  [[nodiscard]] std::size_t size() const { return all_.size(); }
  [[nodiscard]] Obstacle const& operator[](std::size_t k) const { return all_[k]; }

  /// Calls visit(k) for every obstacle that a disk with its centre in this rectangle may touch, for some more, and for
  /// some of them twice. Contract: the obstacles are not empty.
  template <class Visit>
  void for_each_near(Vector lower, Vector upper, Visit visit) const {
    std::size_t const last_column = column_of(upper.x);
    std::size_t const last_row = row_of(upper.y);
    for (std::size_t row = row_of(lower.y); row <= last_row; ++row) {
      for (std::size_t column = column_of(lower.x); column <= last_column; ++column) {
        std::size_t const cell = row * columns_ + column;
        for (std::size_t k = begin_of_cell_[cell]; k < begin_of_cell_[cell + 1]; ++k) visit(in_cells_[k]);
      }
    }
  }

 private:
  [[nodiscard]] std::size_t column_of(double x) const { return index_of(x, columns_per_length_, columns_); }
  [[nodiscard]] std::size_t row_of(double y) const { return index_of(y, rows_per_length_, rows_); }
  static std::size_t index_of(double coordinate, double per_length, std::size_t count) {
    double const index = coordinate * per_length;
    if (!(index > 0.0)) return 0;
    return index < static_cast<double>(count) ? static_cast<std::size_t>(index) : count - 1;
  }

  std::vector<Obstacle> all_;
  std::size_t columns_ = 1;
  std::size_t rows_ = 1;
  double columns_per_length_ = 0.0;
  double rows_per_length_ = 0.0;
  std::vector<std::size_t> begin_of_cell_;
  std::vector<std::uint32_t> in_cells_;
};

}  // namespace gridlock
