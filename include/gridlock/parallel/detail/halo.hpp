#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "gridlock/grid/detail/cell_window.hpp"
#include "gridlock/grid/detail/tiling.hpp"
#include "gridlock/parallel/detail/domain.hpp"

namespace gridlock {

/// The processes that need cells near the tiles of this process, and the cells to send to them after each round.
///
/// In a round the tiles of a process change their own cells and the ring of cells around them; no cell is changed by
/// two processes in one round. After the round each process sends its neighbours the cells that may have changed.
class Halo {
 public:
  /// Cells that a neighbour sees and that the tiles of a round may change.
  class CellsOfRound {
   public:
    CellsOfRound() = default;
    CellsOfRound(std::vector<int> own, std::vector<int> const& ring);

    [[nodiscard]] std::span<int const> all() const { return cells_; }
    /// Returns the cells of the tiles, in which all agents move.
    [[nodiscard]] std::span<int const> own() const { return all().first(own_); }
    /// Returns the cells around the tiles, in which an agent changes only if an agent of a tile hits it or enters.
    [[nodiscard]] std::span<int const> ring() const { return all().subspan(own_); }

   private:
    std::vector<int> cells_;
    std::size_t own_ = 0;
  };
  struct Neighbour {
    std::size_t process;
    CellWindow own;     ///< the cells of the tiles of the neighbour
    CellWindow seen;    ///< `own` and the ring around it, which its tiles read: updated after every round
    CellWindow window;  ///< all cells that the neighbour stores
    std::array<CellsOfRound, Tiling::colours> changed;
  };

  Halo() = default;
  /// Finds the neighbours of this process, if each process stores `reach` cells around its tiles.
  Halo(Domain const& domain, int reach);

  [[nodiscard]] std::span<Neighbour const> neighbours() const { return neighbours_; }
  /// Finds the cells that the tiles of a round may change.
  void plan(std::size_t round, Tiling::Round const& tiles, CellLayout const& cells, Tiling const& tiling);

 private:
  std::vector<Neighbour> neighbours_;
};

}  // namespace gridlock
