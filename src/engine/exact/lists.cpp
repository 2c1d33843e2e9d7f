#include <algorithm>
#include <cmath>

#include "engine/exact/flight.hpp"

namespace gridlock::exact {

namespace {

/// Lists of neighbours pay where disks of constant size are packed as densely as the first; where the largest are so much larger
/// than the smallest that more than four of those fit into a cell, as densely as the second.
constexpr double dense_enough = 0.75;
constexpr double dense_enough_for_unequal = 0.45;
constexpr double unequal = 1.9;
/// They pay for growing disks where epochs are shorter than the longest by this factor: where disks are hit often on a short path.
constexpr double shortening_for_lists = 16.0;
/// The room around the place of a growing disk, in diameters of the smallest.
constexpr double room_of_growing = 0.02;
/// By how much the disks may grow before the lists are renewed.
constexpr double growth_of_lists = 1.001;
/// A disk and its neighbour are at contact, the neighbour anywhere in its room and the disk, with its new place, in the middle of its
/// own, while the two places are up to two rooms apart in addition; and a hair for rounding.
constexpr double rooms_in_cell = 3.001;

Place place_of(MovingDisk const& disk, double time) {
  return {disk.x + disk.velocity_x * time, disk.y + disk.velocity_y * time};
}

}  // namespace

/// A cell must be as wide as the largest diameter at the end of the epoch, and hold the neighbours of a list in its block.
double Flight::side_of_cells() const {
  double const scale = lists_.room > 0.0 ? lists_.most_scale : growth_.scale.at(epoch_length_);
  return 2.0 * largest_radius_ * scale + rooms_in_cell * lists_.room;
}

void Flight::make_room_in_cells(double time) {
  if (size_ == 0) {
    if (grid_.columns() == 0) lay_cells(CellLayout(box_, 1, 1), time);
    return;
  }
  double const side = side_of_cells() * size_of_cells_;
  bool const has_room =
      grid_.columns() > 0 && box_.width() / grid_.columns() >= side && box_.height() / grid_.rows() >= side;
  if (has_room) return;
  CellLayout const layout = layout_for_cutoff(box_, side, disks_in_box_);
  if (layout.columns() != grid_.columns() || layout.rows() != grid_.rows()) lay_cells(layout, time);
}

bool Flight::wants_lists() const {
  if (lists_.wish != Lists::where_they_pay) return lists_.wish == Lists::always;
  if (is_growing()) {
    double const factor = lists_.neighbours.empty() ? shortening_for_lists : 0.5 * shortening_for_lists;
    return epoch_length_ * factor <= longest_epoch_;
  }
  bool const are_unequal = largest_radius_ >= unequal * smallest_radius_;
  return packing_fraction_ >= (are_unequal ? dense_enough_for_unequal : dense_enough);
}

/// Around the places: a small one is left often, a large one makes long lists. Of disks of constant size a measured compromise, in mean
/// diameters.
double Flight::room_for_lists() const {
  if (is_growing()) return room_of_growing * 2.0 * smallest_radius_ * growth_.scale.at_zero;
  return (0.2 + std::max(0.0, 0.8 - packing_fraction_)) * 2.0 * mean_radius_;
}

/// Begins, renews or ends the use of lists, as the length of the epoch tells how dense growing disks are.
/// Contract: all events are predicted anew.
void Flight::renew_lists(double time) {
  // Kernels read the names of sixteen disks.
  bool const wants = wants_lists() && size_ >= 16;
  double const scale = growth_.scale.at(epoch_length_);
  if (wants && !lists_.neighbours.empty() && scale <= lists_.most_scale) return;
  bool const has_lists = !lists_.neighbours.empty();
  if (!wants && !has_lists) return;
  lists_.neighbours.clear();
  lists_.places.clear();
  lists_.room = 0.0;
  if (wants) {
    lists_.room = room_for_lists();
    lists_.most_scale = is_growing() ? growth_of_lists * scale : 1.0;
    double const side = side_of_cells();
    // In fewer cells a side the nearest image of a disk may not be the one in the neighbouring cell.
    if (box_.is_periodic() && (box_.width() < 5.0 * side || box_.height() < 5.0 * side)) lists_.room = 0.0;
  }
  // The cells that lists need are larger than those that do without.
  lay_cells(layout_for_cutoff(box_, side_of_cells() * size_of_cells_, disks_in_box_), time);
  if (lists_.room == 0.0) return;
  lists_.places.resize(size_);
  for (Index i = 0; i < size_; ++i) lists_.places[i] = place_of(disks_[i], time);
  find_all_neighbours();
}

void Flight::find_all_neighbours() {
  lists_.neighbours.resize(size_);
  for (Index i = 0; i < size_; ++i) find_neighbours(i, false);
}

/// Those who may touch i before one of the two leaves the room around its place; `tells_them` puts i into their lists.
void Flight::find_neighbours(Index i, bool tells_them) {
  auto const nobody = static_cast<Index>(size_);
  Neighbours& list = lists_.neighbours[i];
  list.clear(nobody);
  Cell const cell = cells_[i];
  std::vector<Index>& around = lists_.around;
  around.resize(9 * grid_.capacity() + 1);
  std::size_t count = 0;
  for (std::int32_t row = cell.row - 1; row <= cell.row + 1; ++row) {
    Index const* const slots = grid_.slots_of(cell.column - 1, row);
    // Which slots are empty no processor guesses: without a branch.
    for (std::size_t k = 0; k < 3 * grid_.capacity(); ++k) {
      around[count] = slots[k];
      count += static_cast<std::size_t>((slots[k] != no_disk) & (slots[k] != i));
    }
  }
  Place const place = lists_.places[i];
  double const radius = radius_of(i);
  double const rooms = 2.0 * lists_.room;
  bool const is_periodic = box_.is_periodic();
  // A hair more than contact, for places and paths are rounded.
  double const scale = lists_.most_scale * (1.0 + 1e-9);
  std::size_t near = 0;
  for (std::size_t k = 0; k < count; ++k) {
    Index const j = around[k];
    double d_x = std::abs(lists_.places[j].x - place.x);
    double d_y = std::abs(lists_.places[j].y - place.y);
    if (is_periodic) {
      d_x = std::min(d_x, std::abs(box_.width() - d_x));
      d_y = std::min(d_y, std::abs(box_.height() - d_y));
    }
    double const gap_x = std::max(0.0, d_x - rooms);
    double const gap_y = std::max(0.0, d_y - rooms);
    double const contact = (radius + radius_of(j)) * scale;
    around[near] = j;
    near += static_cast<std::size_t>(gap_x * gap_x + gap_y * gap_y <= contact * contact);
  }
  std::copy_n(around.data(), std::min<std::size_t>(near, Neighbours::most), list.disks);
  list.count = static_cast<std::uint32_t>(std::min<std::size_t>(near, Neighbours::most + 1));
  if (!tells_them) return;
  lists_.to_tell.assign(around.begin(), around.begin() + static_cast<std::ptrdiff_t>(near));
  for (Index const j : lists_.to_tell) {
    Neighbours& other = lists_.neighbours[j];
    if (!other.has_all() || other.has(i)) continue;
    other.add(i);
    // Some in it may long be gone.
    if (!other.has_all()) find_neighbours(j, false);
  }
}

/// A disk that has left the room around its place has other neighbours, and is one of theirs.
void Flight::take_new_place(Index i, double time) {
  lists_.places[i] = place_of(disks_[i], time);
  move_to_cell(i, cell_of(i, time));
  find_neighbours(i, true);
}

void Flight::move_to_cell(Index i, Cell const& cell) {
  if (cell.column == cells_[i].column && cell.row == cells_[i].row) return;
  grid_.erase(i, cells_[i].column, cells_[i].row);
  cells_[i] = cell;
  grid_.insert(i, cell.column, cell.row);
  if (prediction_input_.capacity != grid_.capacity()) refresh_prediction_input();
}

Cell Flight::cell_of(Index i, double time) const {
  Place const place = place_of(disks_[i], time);
  return {grid_.column_of(place.x), grid_.row_of(place.y)};
}

/// Contract: all events are predicted anew.
void Flight::lay_cells(CellLayout const& layout, double time) {
  grid_ = SlotGrid(layout, box_);
  cells_.resize(size_);
  for (Index i = 0; i < size_; ++i) {
    cells_[i] = cell_of(i, time);
    grid_.insert(i, cells_[i].column, cells_[i].row);
  }
}

}  // namespace gridlock::exact
