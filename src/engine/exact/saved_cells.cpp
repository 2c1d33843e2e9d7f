#include <cmath>

#include "engine/exact/dynamics.hpp"

namespace gridlock::exact {

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
  lay_cells(CellLayout(box_, cells[0], cells[1]), 0.0);
  double const side = side_of_cells();
  archive.require((cells[0] == 1 || box_.width() / grid_.columns() >= side) &&
                      (cells[1] == 1 || box_.height() / grid_.rows() >= side),
                  "the cells are smaller than the disks");
}

}  // namespace gridlock::exact
