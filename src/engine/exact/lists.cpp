#include <algorithm>
#include <cmath>

#include "engine/exact/dynamics.hpp"

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

}  // namespace

/// A cell must be as wide as the largest diameter at the end of the epoch, and hold the neighbours of a list in its block.
double Dynamics::side_of_cells() const {
  double const scale = lists_.room > 0.0 ? lists_.most_scale : growth_.scale.at(epoch_length_);
  return 2.0 * largest_radius_ * scale + rooms_in_cell * lists_.room;
}

void Dynamics::make_room_in_cells() {
  if (size_ == 0) {
    if (grid_.columns() == 0) lay_cells(CellLayout(box_, 1, 1));
    return;
  }
  double const side = side_of_cells() * size_of_cells_;
  bool const has_room =
      grid_.columns() > 0 && box_.width() / grid_.columns() >= side && box_.height() / grid_.rows() >= side;
  if (has_room) return;
  CellLayout const layout = layout_for_cutoff(box_, side, size_);
  if (layout.columns() != grid_.columns() || layout.rows() != grid_.rows()) lay_cells(layout);
}

bool Dynamics::wants_lists() const {
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
double Dynamics::room_for_lists() const {
  if (is_growing()) return room_of_growing * 2.0 * smallest_radius_ * growth_.scale.at_zero;
  return (0.2 + std::max(0.0, 0.8 - packing_fraction_)) * 2.0 * mean_radius_;
}

/// Begins, renews or ends the use of lists, as the length of the epoch tells how dense growing disks are.
/// Contract: the zero of time is now, and all events are predicted anew.
void Dynamics::renew_lists() {
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
  lay_cells(layout_for_cutoff(box_, side_of_cells() * size_of_cells_, size_));
  if (lists_.room == 0.0) return;
  lists_.places.resize(size_);
  for (Index i = 0; i < size_; ++i) lists_.places[i] = {disks_[i].x, disks_[i].y};
  find_all_neighbours();
}

void Dynamics::find_all_neighbours() {
  lists_.neighbours.resize(size_);
  for (Index i = 0; i < size_; ++i) find_neighbours(i, false);
}

/// Those who may touch i before one of the two leaves the room around its place; `tells_them` puts i into their lists.
void Dynamics::find_neighbours(Index i, bool tells_them) {
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
void Dynamics::take_new_place(Index i) {
  MovingDisk const& disk = disks_[i];
  Place& place = lists_.places[i];
  place = {disk.x + disk.velocity_x * now_, disk.y + disk.velocity_y * now_};
  Cell const cell{grid_.column_of(std::clamp(place.x, 0.0, box_.width())),
                  grid_.row_of(std::clamp(place.y, 0.0, box_.height()))};
  if (cell.column != cells_[i].column || cell.row != cells_[i].row) {
    grid_.erase(i, cells_[i].column, cells_[i].row);
    cells_[i] = cell;
    grid_.insert(i, cell.column, cell.row);
    if (prediction_input_.capacity != grid_.capacity()) refresh_prediction_input();
  }
  find_neighbours(i, true);
}

/// Contract: the zero of time is now, and all events are predicted anew.
void Dynamics::lay_cells(CellLayout const& layout) {
  grid_ = SlotGrid(layout, box_);
  cells_.resize(size_);
  auto const index_of = [](double place, double cells_per_length, std::int32_t count) {
    // A disk beyond the edge of a periodic box by rounding has not crossed it yet: it belongs to the last cell before.
    return static_cast<std::int32_t>(std::clamp(place * cells_per_length, 0.0, static_cast<double>(count - 1)));
  };
  for (Index i = 0; i < size_; ++i) {
    cells_[i] = {index_of(disks_[i].x, layout.columns_per_length(), layout.columns()),
                 index_of(disks_[i].y, layout.rows_per_length(), layout.rows())};
    grid_.insert(i, cells_[i].column, cells_[i].row);
  }
}

/// The lists are found again; when disks leave their places is seen in the number of events.
void Dynamics::serialize_lists(Archive& archive) {
  std::vector<Index> const disks = disks_by_id_index();
  std::vector<std::uint64_t> cells{static_cast<std::uint64_t>(grid_.columns()),
                                   static_cast<std::uint64_t>(grid_.rows())};
  std::vector<double> x;
  std::vector<double> y;
  if (!lists_.places.empty()) {
    for (Index const i : disks) {
      x.push_back(lists_.places[i].x);
      y.push_back(lists_.places[i].y);
    }
  }
  archive.visit("cells", cells);
  archive.visit("place_x", x);
  archive.visit("place_y", y);
  archive.visit("room", lists_.room);
  archive.visit("most_scale", lists_.most_scale);
  if (!archive.is_restoring()) return;
  archive.require(x.size() == y.size() && (x.size() == size_ || (x.empty() && lists_.room == 0.0)),
                  "the engine has other disks than the state");
  archive.require(lists_.room >= 0.0 && std::isfinite(lists_.room), "the room of a disk cannot be");
  lists_.neighbours.clear();
  lists_.places.resize(x.size());
  for (std::size_t id_index = 0; id_index < x.size(); ++id_index) {
    lists_.places[disks[id_index]] = {x[id_index], y[id_index]};
  }
  restore_cells(archive, cells);
}

/// The cells that the saved disks are in.
void Dynamics::restore_cells(Archive const& archive, std::vector<std::uint64_t> const& cells) {
  constexpr std::uint64_t most = 46340;
  archive.require(cells.size() == 2 && cells[0] >= 1 && cells[1] >= 1 && cells[0] <= most && cells[1] <= most,
                  "these cells cannot be");
  lay_cells(CellLayout(box_, cells[0], cells[1]));
  double const side = side_of_cells();
  archive.require((cells[0] == 1 || box_.width() / grid_.columns() >= side) &&
                      (cells[1] == 1 || box_.height() / grid_.rows() >= side),
                  "the cells are smaller than the disks");
}

}  // namespace gridlock::exact
