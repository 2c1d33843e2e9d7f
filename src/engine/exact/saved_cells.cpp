#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/exact/dynamics.hpp"
#include "engine/exact/saved_disks.hpp"

namespace gridlock::exact {

/// Serializes the places of lists, or the grid of cells. Lists and cells are computed again from them. They are saved
/// because the times at which disks leave places or cells show in the number of events.
void Dynamics::serialize_lists(Archive& archive) {
  std::vector<Index> const disks = disks_by_id_index();
  std::vector<std::uint64_t> cells{1, 1};
  std::vector<double> x;
  std::vector<double> y;
  if (has_lists()) {
    for (Index const i : disks) {
      x.push_back(lists_.places[i].x);
      y.push_back(lists_.places[i].y);
    }
  } else {
    SlotGrid const& grid = size_classes_.front().grid;
    cells = {static_cast<std::uint64_t>(grid.columns()), static_cast<std::uint64_t>(grid.rows())};
  }
  archive.visit("cells", cells);
  archive.visit("place_x", x);
  archive.visit("place_y", y);
  archive.visit("room", lists_.room);
  archive.visit("most_scale", lists_.max_scale);
  if (!archive.is_restoring()) return;
  archive.require(!x.empty() || !box_.is_oblique() || size_ == 0, "the disks of an oblique box have no places");
  archive.require(x.size() == y.size() && (x.size() == size_ || (x.empty() && lists_.room == 0.0)),
                  "the engine has other disks than the state");
  archive.require(lists_.room >= 0.0 && std::isfinite(lists_.room), "the room of a disk cannot be");
  lists_.places.resize(x.size());
  for (std::size_t id_index = 0; id_index < x.size(); ++id_index) {
    lists_.places[disks[id_index]] = {x[id_index], y[id_index]};
  }
  if (!has_lists()) restore_grid(archive, cells);
}

/// Restores the grid of disks without lists.
void Dynamics::restore_grid(Archive const& archive, std::vector<std::uint64_t> const& cells) {
  constexpr std::uint64_t most = 46340;
  archive.require(cells.size() == 2 && cells[0] >= 1 && cells[1] >= 1 && cells[0] <= most && cells[1] <= most,
                  "these cells cannot be");
  SlotGrid grid(CellLayout(box_, cells[0], cells[1]), box_, reach_in_cells());
  double const side = 2.0 * largest_radius_ * growth_.scale.at(epoch_length_);
  archive.require((grid.columns() == 1 || box_.width() / grid.columns() >= side) &&
                      (grid.rows() == 1 || box_.height() / grid.rows() >= side),
                  "the cells are smaller than the disks");
  size_classes_.clear();
  size_classes_.push_back({largest_radius_, std::move(grid)});
}

/// Restores the cell of each disk. Contract: the disks have been restored.
void Dynamics::restore_cells(Archive const& archive, SavedDisks const& saved) {
  if (has_lists()) {
    for (Index i = 0; i < size_; ++i) {
      Vector const away = position_at(i, now_) - Vector{lists_.places[i].x, lists_.places[i].y};
      archive.require(std::max(std::abs(away.x), std::abs(away.y)) <= 1.001 * lists_.room,
                      "a disk is not at its place");
    }
    lay_cells_by_size();
    find_all_neighbours();
    return;
  }
  SlotGrid& grid = size_classes_.front().grid;
  cells_.resize(size_);
  for (Index i = 0; i < size_; ++i) {
    Cell const cell{saved.column[disks_[i].id_index], saved.row[disks_[i].id_index]};
    archive.require(cell.column >= 0 && cell.column < grid.columns() && cell.row >= 0 && cell.row < grid.rows(),
                    "a disk is in a cell that cannot be");
    cells_[i] = cell;
    grid.insert(i, cell.column, cell.row);
  }
}

}  // namespace gridlock::exact
