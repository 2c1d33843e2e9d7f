#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "engine/exact/moving_disk.hpp"
#include "engine/exact/slot_cells.hpp"

namespace gridlock::exact {

/// Asks for the memory of events to come, a little with each event handled, so that memory is busy while the processor
/// computes.
///
/// Disks enter in about the order in which their events are due, and pass four stations on the way: what one station
/// asked for has arrived when the disk reaches the next.
///
///     entered → the disk → its cells, its partner → the disks around it, the partner's cells → the disks around the partner
///                 12           8                                 4                                        0
class FetchPipeline {
 public:
  void clear() { entered_ = taken_ = 0; }

  /// Takes in a disk whose event is due in a while.
  void enter(Index disk) { waiting_[entered_++ % waiting_.size()] = disk; }

  /// Moves every disk on by one place.
  void step(MovingDisk const* disks, SlotCells const& cells, std::size_t last_disk) {
    if (taken_ == entered_) return;
    __builtin_prefetch(&disks[waiting_[taken_ % waiting_.size()]], 1);
    if (taken_ >= 4) fetch_cells_and_partner(disks, cells, at(4));
    if (taken_ >= 8) {
      fetch_neighbours(disks, cells, at(8), last_disk);
      if (Index const partner = disks[at(8)].partner; partner < vertical_border) fetch_cells(disks, cells, partner);
    }
    if (taken_ >= 12) {
      if (Index const partner = disks[at(12)].partner; partner < vertical_border) {
        fetch_neighbours(disks, cells, partner, last_disk);
      }
    }
    ++taken_;
  }

  /// Disks that have entered and have not been asked for.
  [[nodiscard]] std::uint64_t waiting() const { return entered_ - taken_; }

 private:
  [[nodiscard]] Index at(std::uint64_t places_ago) const { return waiting_[(taken_ - places_ago) % waiting_.size()]; }

  static void fetch_cells(MovingDisk const* disks, SlotCells const& cells, Index i) {
    Index const* run = cells.cell(disks[i].column - 1, disks[i].row - 1);
    for (int row = 0; row < 3; ++row, run += cells.row_stride()) __builtin_prefetch(run);
  }
  static void fetch_cells_and_partner(MovingDisk const* disks, SlotCells const& cells, Index i) {
    fetch_cells(disks, cells, i);
    if (Index const partner = disks[i].partner; partner < vertical_border) __builtin_prefetch(&disks[partner], 1);
  }
  static void fetch_neighbours(MovingDisk const* disks, SlotCells const& cells, Index i, std::size_t last_disk) {
    Index const* run = cells.cell(disks[i].column - 1, disks[i].row - 1);
    for (int row = 0; row < 3; ++row, run += cells.row_stride()) {
      for (std::size_t k = 0; k < 3 * cells.capacity(); ++k) {
        // An empty slot asks for the spare disk at the end, which is always there: cheaper than a branch.
        __builtin_prefetch(&disks[std::min<std::size_t>(run[k], last_disk)]);
      }
    }
  }

  std::array<Index, 256> waiting_{};
  std::uint64_t entered_ = 0;
  std::uint64_t taken_ = 0;
};

}  // namespace gridlock::exact
