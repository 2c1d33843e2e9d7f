#include "engine/exact/slot_grid.hpp"

#include <algorithm>
#include <cassert>

namespace gridlock::exact {

namespace {

/// Number of slots behind the last that wide loads may read.
constexpr std::size_t slack = 32;

double margin_of(int count, double side, double reach) {
  // The second term covers rounding.
  return std::max(0.0, 0.5 * (side / count - reach) - 1e-6 * side / count);
}

std::vector<double> limits(int count, double side, double margin) {
  std::vector<double> limits;
  for (int k = 0; k < count; ++k) {
    limits.push_back(k == 0 ? 0.0 : side * k / count - margin);
    limits.push_back(k + 1 == count ? side : side * (k + 1) / count + margin);
  }
  return limits;
}

}  // namespace

SlotGrid::SlotGrid(CellLayout const& layout, Box const& box, double reach)
    : layout_(layout),
      box_(box),
      has_images_(box.has_images()),
      columns_(layout.columns()),
      rows_(layout.rows()),
      stride_(static_cast<std::size_t>(columns_) + 2),
      slots_(stride_ * (static_cast<std::size_t>(rows_) + 2) * capacity_ + slack, no_disk),
      largest_margin_(std::max(margin_of(columns_, box.width(), reach), margin_of(rows_, box.height(), reach))),
      column_limits_(limits(columns_, box.width(), margin_of(columns_, box.width(), reach))),
      row_limits_(limits(rows_, box.height(), margin_of(rows_, box.height(), reach))) {}

/// Returns the columns of for_each_run() in one row of an oblique box. Beyond the lower and the upper edge they lie xy
/// farther to the right or to the left.
SlotGrid::Range SlotGrid::columns_in_oblique(std::int32_t row, double lower, double upper) const {
  double lean = row < 0 ? box_.shift() : row >= rows_ ? -box_.shift() : 0.0;
  lean -= std::floor((0.5 * (lower + upper) + lean) / box_.width()) * box_.width();
  return range(lower + lean, upper + lean, layout_.columns_per_length(), columns_, true);
}

void SlotGrid::insert(Index disk, std::int32_t column, std::int32_t row) {
  for (;;) {
    Index* const first = slots_.data() + first_slot_of(column, row);
    Index* const empty = std::find(first, first + capacity_, no_disk);
    if (empty != first + capacity_) {
      *empty = disk;
      break;
    }
    double_capacity();
  }
  if (has_images_ && is_at_edge(column, row)) copy_to_ghosts(column, row);
}

void SlotGrid::erase(Index disk, std::int32_t column, std::int32_t row) {
  Index* const first = slots_.data() + first_slot_of(column, row);
  Index* const found = std::find(first, first + capacity_, disk);
  assert(found != first + capacity_);
  // The last disk of the cell moves to the freed slot, so that the used slots stay the first ones.
  Index* const end = std::find(found, first + capacity_, no_disk);
  *found = *(end - 1);
  *(end - 1) = no_disk;
  if (has_images_ && is_at_edge(column, row)) copy_to_ghosts(column, row);
}

void SlotGrid::rename(std::vector<Index> const& new_number) {
  for (Index& slot : slots_) {
    if (slot != no_disk) slot = new_number[slot];
  }
}

void SlotGrid::copy_to_ghosts(std::int32_t column, std::int32_t row) {
  // Writes each image of the cell in the ring of ghosts; in a box one cell wide a cell has images on both sides. Beyond
  // walls there are none.
  Index const* const original = slots_.data() + first_slot_of(column, row);
  std::int32_t const around_x = layout_.is_periodic_x() ? columns_ : 0;
  std::int32_t const around_y = layout_.is_periodic_y() ? rows_ : 0;
  for (std::int32_t const r : {row - around_y, row, row + around_y}) {
    for (std::int32_t const c : {column - around_x, column, column + around_x}) {
      bool const is_ghost = (r != row || c != column) && r >= -1 && r <= rows_ && c >= -1 && c <= columns_;
      if (is_ghost) std::copy_n(original, capacity_, slots_.data() + first_slot_of(c, r));
    }
  }
}

void SlotGrid::double_capacity() {
  std::size_t const old_capacity = capacity_;
  std::size_t const cells = (slots_.size() - slack) / old_capacity;
  LargeArray<Index> wider(cells * old_capacity * 2 + slack, no_disk);
  for (std::size_t cell = 0; cell < cells; ++cell) {
    std::copy_n(slots_.data() + cell * old_capacity, old_capacity, wider.data() + cell * old_capacity * 2);
  }
  slots_ = std::move(wider);
  capacity_ = old_capacity * 2;
}

}  // namespace gridlock::exact
