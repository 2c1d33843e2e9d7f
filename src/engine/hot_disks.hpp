#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "engine/turn.hpp"
#include "gridlock/core/detail/large_array.hpp"
#include "gridlock/core/detail/rows_in_order.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/grid/detail/neighbour_grid.hpp"

namespace gridlock {

/// Returns the position of each row in the order of the Ids.
inline std::vector<std::uint32_t> id_indices(Disks const& disks) {
  std::vector<std::uint32_t> const by_id = rows_in_order(disks.ids());
  std::vector<std::uint32_t> id_index(by_id.size());
  for (std::uint32_t n = 0; n < by_id.size(); ++n) id_index[by_id[n]] = n;
  return id_index;
}

inline DiskInTurn disk_in_turn(Disks const& disks, std::uint32_t row, std::span<std::uint32_t const> id_index) {
  return {.position = position(disks, row),
          .velocity = velocity(disks, row),
          .radius = disks.column<Radius>()[row],
          .mass = disks.column<Mass>()[row],
          .image_x = disks.column<ImageX>()[row],
          .image_y = disks.column<ImageY>()[row],
          .id_index = id_index[row],
          .row_in_state = row};
}

/// Writes a disk to the row of the state that it came from.
inline void write_back(DiskInTurn const& disk, Disks& to) {
  std::size_t const row = disk.row_in_state;
  to.column<X>()[row] = disk.position.x;
  to.column<Y>()[row] = disk.position.y;
  to.column<VelocityX>()[row] = disk.velocity.x;
  to.column<VelocityY>()[row] = disk.velocity.y;
  to.column<ImageX>()[row] = disk.image_x;
  to.column<ImageY>()[row] = disk.image_y;
}

/// The disks of a state as records, in an order of the engine's own, while they take their turns.
class HotDisks {
 public:
  /// Copies the disks of the state: row k gets the disk of row `order[k]` of the state.
  HotDisks(State const& state, std::span<std::uint32_t const> order) : disks_(order.size()) {
    std::vector<std::uint32_t> const id_index = id_indices(state.agents);
    for (std::size_t k = 0; k < order.size(); ++k) disks_[k] = disk_in_turn(state.agents, order[k], id_index);
  }

  /// Takes over these disks.
  explicit HotDisks(LargeArray<DiskInTurn>&& disks) : disks_(std::move(disks)) {}

  [[nodiscard]] std::size_t size() const { return disks_.size(); }
  [[nodiscard]] DiskInTurn const& operator[](std::size_t k) const { return disks_[k]; }
  [[nodiscard]] DiskInTurn& operator[](std::size_t k) { return disks_[k]; }
  /// Returns the disks; the range is valid until add() is called.
  [[nodiscard]] std::span<DiskInTurn> all() { return disks_; }
  void add(DiskInTurn const& disk) { disks_.push_back(disk); }
  /// Number of disks for which memory is allocated.
  [[nodiscard]] std::size_t room() const { return disks_.capacity(); }
  [[nodiscard]] LargeArray<DiskInTurn> take() { return std::move(disks_); }

  TurnView view(Box const& box, EngineSettings const& settings, double duration) {
    return {.box = box,
            .disks = disks_,
            .substep = duration / static_cast<double>(settings.substeps),
            .substeps = settings.substeps,
            .contact = settings.contact};
  }
  /// `of_step` is set by the caller for each step, if disks propel themselves.
  TurnView view(Box const& box, EngineSettings const& settings, double duration, HeadingStep const& of_step,
                Obstacles const& walls) {
    TurnView of_all = view(box, settings, duration);
    if (settings.propulsion.is_on()) of_all.heading = &of_step;
    of_all.walls = walls.view();
    return of_all;
  }

  void write_back(State& state) const {
    for (DiskInTurn const& disk : disks_) gridlock::write_back(disk, state.agents);
  }

 private:
  LargeArray<DiskInTurn> disks_;
};

/// Returns a grid with every disk at its position.
template <NeighbourGrid Grid>
Grid grid_of(CellLayout const& layout, HotDisks const& disks) {
  Grid grid(layout, disks.size());
  for (std::size_t k = 0; k < disks.size(); ++k) grid.insert(k, disks[k].position);
  return grid;
}

}  // namespace gridlock
