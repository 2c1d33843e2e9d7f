#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>

#include "gridlock/core/detail/large_array.hpp"
#include "gridlock/core/disks.hpp"

namespace gridlock {

/// All that a row of a state holds.
struct DiskRow {
  Id id;
  double x, y, velocity_x, velocity_y, radius, mass;
  std::int32_t image_x, image_y;
};

inline DiskRow row_of(Disks const& disks, std::size_t i) {
  return {.id = disks.ids()[i],
          .x = disks.column<X>()[i],
          .y = disks.column<Y>()[i],
          .velocity_x = disks.column<VelocityX>()[i],
          .velocity_y = disks.column<VelocityY>()[i],
          .radius = disks.column<Radius>()[i],
          .mass = disks.column<Mass>()[i],
          .image_x = disks.column<ImageX>()[i],
          .image_y = disks.column<ImageY>()[i]};
}

/// Rows that come one after the other, until they are a population.
class ComingRows {
 public:
  explicit ComingRows(std::size_t rows) {
    ids_.resize(rows);
    values_.resize(rows);
  }
  void add(DiskRow const& row) {
    ids_[next_] = row.id;
    values_.put(next_, {row.x, row.y, row.velocity_x, row.velocity_y, row.radius, row.mass, row.image_x, row.image_y});
    ++next_;
  }
  void become(Disks& disks) {
    assert(next_ == ids_.size());
    disks.become(ids_, values_);
  }

 private:
  LargeArray<Id> ids_;
  Disks::AllValues values_;
  std::size_t next_ = 0;
};

}  // namespace gridlock
