#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "engine/exact/flight.hpp"

namespace gridlock::exact {

namespace {

/// Cell side in contact distances. Wide cells have fewer borders to cross; cells narrower than √2 diameters hold at
/// most four equal disks. They are used while nine hold so few disks that one batch of candidates is usually enough.
constexpr double side_of_wide_cells = 1.41;
constexpr double max_candidates_in_wide_cells = 8.0;

}  // namespace

/// Lays new cells where disks have no lists and the cells have become too narrow: a cell must be at least as wide as
/// the largest diameter at the end of the epoch.
void Flight::make_room_in_cells(double time) {
  if (has_lists()) return;
  if (size_ == 0) {
    if (size_classes_.empty()) lay_cells(CellLayout(box_, 1, 1), time);
    return;
  }
  double side = 2.0 * largest_radius_ * growth_.scale.at(epoch_length_) * size_of_cells_;
  if (!is_growing() && disks_in_nine_cells(side_of_wide_cells * side) <= max_candidates_in_wide_cells) {
    side *= side_of_wide_cells;
  }
  CellLayout const layout = layout_for(side);
  if (!size_classes_.empty()) {
    SlotGrid const& grid = size_classes_.front().grid;
    bool const has_room = box_.width() / grid.columns() >= side && box_.height() / grid.rows() >= side;
    if (has_room || (layout.columns() == grid.columns() && layout.rows() == grid.rows())) return;
  }
  lay_cells(layout, time);
}

/// Mean number of disks in nine cells of this side.
double Flight::disks_in_nine_cells(double side) const {
  return 9.0 * side * side * static_cast<double>(disks_in_box_) / box_.area();
}

CellLayout Flight::layout_for(double side) const { return layout_for_cutoff(box_, side, disks_in_box_); }

/// Lays cells for disks of all sizes, without lists. Contract: all events are predicted anew.
void Flight::lay_cells(CellLayout const& layout, double time) {
  size_classes_.clear();
  size_classes_.push_back({largest_radius_, SlotGrid(layout, box_, reach_in_cells())});
  cells_.resize(size_);
  for (Index i = 0; i < size_; ++i) {
    cells_[i] = cell_of(i, time);
    size_classes_.front().grid.insert(i, cells_[i].column, cells_[i].row);
  }
}

/// Lays a grid of cells for each size class, for the places of disks with lists: a large disk finds its many small
/// neighbours in few cells, a small disk in small cells. In a class the largest disk is at most twice the smallest.
void Flight::lay_cells_by_size() {
  std::array<double, 64> largest{};
  auto const by_halves = [&](double radius) {
    return std::min(static_cast<std::size_t>(std::ilogb(largest_radius_ / radius)), largest.size() - 1);
  };
  if (radius_.empty()) largest[0] = largest_radius_;
  for (double const radius : radii()) {
    double& of_class = largest[by_halves(radius)];
    of_class = std::max(of_class, radius);
  }
  size_classes_.clear();
  for (double const radius : largest) {
    if (radius == 0.0) continue;
    double const side = 2.0 * radius * lists_.max_scale + 3.0 * lists_.room;
    size_classes_.push_back({radius, SlotGrid(layout_for(side * size_of_cells_), box_)});
  }
  cells_.resize(size_);
  for (Index i = 0; i < size_; ++i) {
    cells_[i] = cell_of(i, 0.0);
    grid_of(i).insert(i, cells_[i].column, cells_[i].row);
  }
}

std::size_t Flight::class_of(Index i) const {
  std::size_t k = 0;
  double const radius = radius_of(i);
  while (k + 1 < size_classes_.size() && radius <= size_classes_[k + 1].largest_radius) ++k;
  return k;
}

/// Returns the cell of a disk's place, or of its position at this time where there are no places.
Cell Flight::cell_of(Index i, double time) const {
  SlotGrid const& grid = size_classes_[class_of(i)].grid;
  if (has_lists()) return grid.cell_of_image({lists_.places[i].x, lists_.places[i].y});
  auto const [x, y] = position_at(i, time);
  return {grid.column_of(x), grid.row_of(y)};
}

/// The distance within which two disks without lists touch; infinite for growing disks, whose cells have no margins.
double Flight::reach_in_cells() const {
  return is_growing() ? std::numeric_limits<double>::infinity() : 2.0 * largest_radius_;
}

void Flight::move_to_cell(Index i, Cell const& cell, double time) {
  if (cell == cells_[i]) return;
  SlotGrid& grid = grid_of(i);
  // The disk is erased first: else two guests, each in the other's cell, would send each other home without end.
  grid.erase(i, cells_[i].column, cells_[i].row);
  if (grid.largest_margin() > 0.0 && grid.is_full(cell.column, cell.row)) send_guests_home(cell, time);
  cells_[i] = cell;
  grid.insert(i, cell.column, cell.row);
  if (prediction_input_.slots != size_classes_.front().grid.slots()) refresh_prediction_input();
}

/// Moves guests of a full cell, which have left it but still belong to it, to their own cells; the other disks always
/// find slots if all disks are equal. A guest's next event was the end of its stay, so it is predicted anew.
void Flight::send_guests_home(Cell const& cell, double time) {
  SlotGrid const& grid = size_classes_.front().grid;
  Index const* const slots = grid.slots_of(cell.column, cell.row);
  std::vector<Index> const disks(slots, slots + grid.capacity());
  for (Index const guest : disks) {
    Cell const home = cell_of(guest, time);
    if (home == cell || cells_[guest] != cell) continue;
    move_to_cell(guest, home, time);
    bool const is_lost = disks_[guest].event_time == -std::numeric_limits<double>::infinity();
    if (!is_lost) schedule(guest, predictor_.one(prediction_input_, guest, time));
  }
}

}  // namespace gridlock::exact
