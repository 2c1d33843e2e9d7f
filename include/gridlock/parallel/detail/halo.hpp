#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "gridlock/grid/detail/cell_window.hpp"
#include "gridlock/grid/detail/tiling.hpp"
#include "gridlock/parallel/detail/domain.hpp"

namespace gridlock {

/// The other processes that see cells near the tiles of this one, and the cells they see that each round of its tiles
/// may change.
///
/// In a round the tiles of a process change their own cells and the ring around them; no cell is changed by two
/// processes in one round. After it each process sends to its neighbours the cells that may have changed.
class Halo {
 public:
  /// Cells that a neighbour sees and that the tiles of a round may change.
  class CellsOfRound {
   public:
    CellsOfRound() = default;
    CellsOfRound(std::vector<int> own, std::vector<int> const& ring);

    [[nodiscard]] std::span<int const> all() const { return cells_; }
    /// The cells of the tiles, whose agents all move.
    [[nodiscard]] std::span<int const> own() const { return all().first(own_); }
    /// The cells around them, where an agent changes only if it is met or comes in.
    [[nodiscard]] std::span<int const> ring() const { return all().subspan(own_); }

   private:
    std::vector<int> cells_;
    std::size_t own_ = 0;
  };
  struct Neighbour {
    std::size_t process;
    CellWindow own;     ///< the cells of its tiles
    CellWindow seen;    ///< those and the ring around them, which its tiles look at: kept up to date in every round
    CellWindow window;  ///< all cells that it stores
    std::array<CellsOfRound, Tiling::colours> changed;
  };

  Halo() = default;
  /// The neighbours of this process where each stores `reach` cells around its tiles.
  Halo(Domain const& domain, int reach);

  [[nodiscard]] std::span<Neighbour const> neighbours() const { return neighbours_; }
  /// Finds the cells that the tiles of a round may change.
  void plan(std::size_t round, Tiling::Round const& tiles, CellLayout const& cells, Tiling const& tiling);

 private:
  std::vector<Neighbour> neighbours_;
};

}  // namespace gridlock
