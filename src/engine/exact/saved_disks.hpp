#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "engine/exact/moving_disk.hpp"
#include "gridlock/core/archive.hpp"

namespace gridlock::exact {

/// The disks of a dynamics in a checkpoint: one column for each quantity, in the order of id indices.
struct SavedDisks {
  std::vector<double> x, y, velocity_x, velocity_y, event_time, last_hit;
  std::vector<std::uint32_t> partner;  ///< id index of the partner, or a border
  std::vector<std::uint32_t> partner_collision_count, collision_count;
  std::vector<std::int32_t> column, row, image_x, image_y;

  [[nodiscard]] std::size_t size() const { return x.size(); }

  void serialize(Archive& archive) {
    archive.visit("x", x);
    archive.visit("y", y);
    archive.visit("velocity_x", velocity_x);
    archive.visit("velocity_y", velocity_y);
    archive.visit("event_time", event_time);
    archive.visit("last_hit", last_hit);
    archive.visit("partner", partner);
    archive.visit("partner_collision_count", partner_collision_count);
    archive.visit("collision_count", collision_count);
    archive.visit("column", column);
    archive.visit("row", row);
    archive.visit("image_x", image_x);
    archive.visit("image_y", image_y);
  }

  /// Returns whether every column has `disks` entries.
  [[nodiscard]] bool has_size(std::size_t disks) const {
    auto const fits = [disks](auto const&... columns) { return ((columns.size() == disks) && ...); };
    return fits(x, y, velocity_x, velocity_y, event_time, last_hit, partner, partner_collision_count, collision_count,
                column, row, image_x, image_y);
  }
};

}  // namespace gridlock::exact
