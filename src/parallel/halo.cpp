#include "gridlock/parallel/detail/halo.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "core/sorted.hpp"

namespace gridlock {

Halo::CellsOfRound::CellsOfRound(std::vector<int> own, std::vector<int> const& ring)
    : cells_(std::move(own)), own_(cells_.size()) {
  cells_.insert(cells_.end(), ring.begin(), ring.end());
}

Halo::Halo(Domain const& domain, int reach) {
  std::size_t const self = domain.processes().rank();
  CellWindow const window = domain.window(self, reach);
  for (std::size_t process = 0; process < domain.processes().count(); ++process) {
    CellWindow const its = domain.window(process, reach);
    if (process == self || !overlap(domain.cells(), window, its)) continue;
    neighbours_.push_back({.process = process,
                           .own = domain.window(process, 0),
                           .seen = domain.window(process, 1),
                           .window = its,
                           .changed = {}});
  }
}

void Halo::plan(std::size_t round, Tiling::Round const& tiles, CellLayout const& cells, Tiling const& tiling) {
  for (Neighbour& neighbour : neighbours_) {
    std::vector<int> own;
    std::vector<int> all;
    for (Tiling::Part const& part : tiles) {
      for (std::uint32_t const number : part) {
        Tiling::Tile const& tile = tiling.tiles()[number];
        std::ranges::copy(common_cells(cells, window_around(cells, tile, 0), neighbour.seen), std::back_inserter(own));
        std::ranges::copy(common_cells(cells, window_around(cells, tile, 1), neighbour.seen), std::back_inserter(all));
      }
    }
    sort_and_drop_repeats(own);
    sort_and_drop_repeats(all);
    std::vector<int> ring;
    std::ranges::set_difference(all, own, std::back_inserter(ring));
    neighbour.changed[round] = {std::move(own), ring};
  }
}

}  // namespace gridlock
