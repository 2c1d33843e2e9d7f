#include "gridlock/grid/tiling.hpp"

#include <algorithm>
#include <cassert>
#include <cstdint>

namespace gridlock {

namespace {

/// Where the tiles along one side begin; the last entry is the end.
std::vector<int> cuts(int cells, int cells_of_tile, bool is_periodic) {
  int count = std::max(1, cells / cells_of_tile);
  if (is_periodic && count > 1) count -= count % 2;
  std::vector<int> at;
  for (int tile = 0; tile <= count; ++tile) {
    at.push_back(static_cast<int>(std::int64_t{cells} * tile / count));
  }
  return at;
}

}  // namespace

Tiling::Tiling(CellLayout const& layout, int cells_of_tile) {
  assert(cells_of_tile >= 2);
  std::vector<int> const columns = cuts(layout.columns(), cells_of_tile, layout.is_periodic());
  std::vector<int> const rows = cuts(layout.rows(), cells_of_tile, layout.is_periodic());
  for (std::size_t colour = 0; colour < colours; ++colour) {
    first_of_[colour] = tiles_.size();
    for (std::size_t r = colour / 2; r + 1 < rows.size(); r += 2) {
      for (std::size_t c = colour % 2; c + 1 < columns.size(); c += 2) {
        tiles_.push_back(
            {.first_column = columns[c], .end_column = columns[c + 1], .first_row = rows[r], .end_row = rows[r + 1]});
      }
    }
  }
  first_of_[colours] = tiles_.size();
}

}  // namespace gridlock
