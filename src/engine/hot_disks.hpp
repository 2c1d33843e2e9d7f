#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/turn.hpp"
#include "gridlock/core/detail/large_array.hpp"
#include "gridlock/core/detail/rows_in_order.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/grid/detail/neighbour_grid.hpp"

namespace gridlock {

/// The disks of a state side by side, in an order of the engine's own, while they take their turns.
class HotDisks {
 public:
  /// `order[k]` is the row of the state that comes to row k.
  HotDisks(State const& state, std::span<std::uint32_t const> order) : disks_(order.size()) {
    Disks const& from = state.agents;
    std::vector<std::uint32_t> const by_id = rows_in_order(from.ids());
    std::vector<std::uint32_t> id_index(by_id.size());
    for (std::uint32_t n = 0; n < by_id.size(); ++n) id_index[by_id[n]] = n;
    for (std::size_t k = 0; k < order.size(); ++k) {
      std::uint32_t const row = order[k];
      disks_[k] = {.position = position(from, row),
                   .velocity = velocity(from, row),
                   .radius = from.column<Radius>()[row],
                   .mass = from.column<Mass>()[row],
                   .image_x = from.column<ImageX>()[row],
                   .image_y = from.column<ImageY>()[row],
                   .id_index = id_index[row],
                   .row_in_state = row};
    }
  }

  [[nodiscard]] std::size_t size() const { return disks_.size(); }
  [[nodiscard]] DiskInTurn const& operator[](std::size_t k) const { return disks_[k]; }

  TurnView view(Box const& box, EngineSettings const& settings, double duration) {
    return {.box = box,
            .disks = disks_,
            .substep = duration / static_cast<double>(settings.substeps),
            .substeps = settings.substeps,
            .contact = settings.contact};
  }

  void write_back(State& state) const {
    Disks& to = state.agents;
    auto const x = to.column<X>();
    auto const y = to.column<Y>();
    auto const velocity_x = to.column<VelocityX>();
    auto const velocity_y = to.column<VelocityY>();
    auto const image_x = to.column<ImageX>();
    auto const image_y = to.column<ImageY>();
    for (DiskInTurn const& disk : disks_) {
      std::size_t const row = disk.row_in_state;
      x[row] = disk.position.x;
      y[row] = disk.position.y;
      velocity_x[row] = disk.velocity.x;
      velocity_y[row] = disk.velocity.y;
      image_x[row] = disk.image_x;
      image_y[row] = disk.image_y;
    }
  }

 private:
  LargeArray<DiskInTurn> disks_;
};

/// A grid that holds every disk where it is.
template <NeighbourGrid Grid>
Grid grid_of(CellLayout const& layout, HotDisks const& disks) {
  Grid grid(layout, disks.size());
  for (std::size_t k = 0; k < disks.size(); ++k) grid.insert(k, disks[k].position);
  return grid;
}

}  // namespace gridlock
