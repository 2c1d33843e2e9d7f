#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>

#include "engine/exact/prediction.hpp"
#include "engine/exact/slot_grid.hpp"
#include "gridlock/core/detail/look_ahead.hpp"

namespace gridlock::exact {

/// Prefetches the memory of coming events, a little with each event handled, so that memory works while the processor
/// computes.
///
/// Events enter roughly in the order of their times and pass four stations. Memory that one station prefetches has
/// arrived when the event reaches the next station.
///
///     entered → the disk → its partner → the cells around the two → the disks in them
///                 12           8                   4                       0
///
/// Four in ten events are void by the time their disk has arrived; they go no further.
class FetchPipeline {
 public:
  void clear() { entered_ = taken_ = 0; }

  /// Adds an event that will be due soon.
  void enter(Index disk, double time) { waiting_[entered_++ % waiting_.size()] = {time, disk}; }

  /// Moves every event on by one position; grid_of(i) is the grid that holds disk i.
  template <class GridOf>
  void step(PredictionInput const& s, GridOf const& grid_of, std::size_t last_disk) {
    if (taken_ == entered_) return;
    fetch(s, at(0).disk);
    if (taken_ >= 4) fetch_partner(s, at(4));
    if (taken_ >= 8) fetch_cells(s, grid_of, at(8));
    if (taken_ >= 12) fetch_disks(grid_of, s, at(12), last_disk);
    ++taken_;
  }

  /// Number of events that have entered and whose disk has not been prefetched.
  [[nodiscard]] std::uint64_t waiting() const { return entered_ - taken_; }

 private:
  /// An event in the pipeline: its partner, and the cells around disk and partner; a void event has no cells.
  struct Entry {
    double time;
    Index disk;
    Index partner;
    bool looks_at_cells;  ///< false where it looks at lists of neighbours alone
    std::int32_t column;
    std::int32_t row;
    std::int32_t columns;
    std::int32_t rows;
  };

  [[nodiscard]] Entry& at(std::uint64_t places_ago) { return waiting_[(taken_ - places_ago) % waiting_.size()]; }

  /// Prefetches a disk's record and the arrays that belong to it.
  static void fetch(PredictionInput const& s, Index disk) {
    prefetch(&s.disks[disk]);
    prefetch(&s.cells[disk]);
    fetch_radius(s, disk);
    if (s.mass != nullptr) prefetch(&s.mass[disk]);
    if (s.neighbours == nullptr) return;
    prefetch(&s.neighbours[disk]);
    prefetch(&s.places[disk]);
  }
  static void fetch_radius(PredictionInput const& s, std::size_t disk) {
    if (s.radius != nullptr) prefetch(&s.radius[disk]);
  }
  static void fetch_partner(PredictionInput const& s, Entry& entry) {
    MovingDisk const& disk = s.disks[entry.disk];
    entry.rows = 0;
    if (disk.event_time != entry.time) return;
    bool const is_at_border = disk.partner >= vertical_border;
    entry.partner = is_at_border ? entry.disk : disk.partner;
    entry.looks_at_cells = s.neighbours == nullptr || is_at_border;
    entry.rows = 3;
    fetch(s, entry.partner);
  }
  template <class GridOf>
  static void fetch_cells(PredictionInput const& s, GridOf const& grid_of, Entry& entry) {
    if (entry.rows == 0 || !entry.looks_at_cells) return;
    SlotGrid const& grid = grid_of(entry.disk);
    Cell const disk = s.cells[entry.disk];
    Cell const partner = s.cells[entry.partner];
    std::int32_t const columns_apart = partner.column - disk.column;
    std::int32_t const rows_apart = partner.row - disk.row;
    // Cells across the edge of a periodic box are not prefetched.
    std::int32_t const across = std::abs(columns_apart) > 1 ? 0 : columns_apart;
    std::int32_t const up = std::abs(rows_apart) > 1 ? 0 : rows_apart;
    entry.column = disk.column - 1 + std::min(across, 0);
    entry.row = disk.row - 1 + std::min(up, 0);
    entry.columns = 3 + std::abs(across);
    entry.rows = 3 + std::abs(up);
    Index const* run = grid.slots_of(entry.column, entry.row);
    // Wide registers read up to four slots behind the last cell.
    std::size_t const last = static_cast<std::size_t>(entry.columns + 1) * grid.capacity() - 1;
    for (std::int32_t row = 0; row < entry.rows; ++row, run += grid.row_stride()) {
      prefetch(run);
      prefetch(run + last);
    }
  }
  static void fetch_neighbours(PredictionInput const& s, Entry const& entry) {
    for (Index const i : {entry.disk, entry.partner}) {
      // Few lists have more than eight neighbours; unused entries name the spare disk.
      for (std::uint32_t k = 0; k < 8; ++k) {
        Index const disk = s.neighbours[i].disks[k];
        prefetch(&s.disks[disk]);
        fetch_radius(s, disk);
      }
    }
  }
  template <class GridOf>
  static void fetch_disks(GridOf const& grid_of, PredictionInput const& s, Entry const& entry, std::size_t last_disk) {
    if (entry.rows == 0) return;
    if (s.neighbours != nullptr) fetch_neighbours(s, entry);
    if (!entry.looks_at_cells) return;
    SlotGrid const& grid = grid_of(entry.disk);
    Index const* run = grid.slots_of(entry.column, entry.row);
    for (std::int32_t row = 0; row < entry.rows; ++row, run += grid.row_stride()) {
      Index const* cell = run;
      for (std::int32_t column = 0; column < entry.columns; ++column, cell += grid.capacity()) {
        // Few cells hold more than two disks. For an empty slot the spare disk at the end is prefetched, which always
        // exists: that is cheaper than a branch.
        for (std::size_t k = 0; k < 2; ++k) {
          std::size_t const disk = std::min<std::size_t>(cell[k], last_disk);
          if (s.neighbours == nullptr) {
            prefetch(&s.disks[disk]);
            fetch_radius(s, disk);
          } else {
            prefetch(&s.places[disk]);
          }
        }
      }
    }
  }

  std::array<Entry, 128> waiting_{};
  std::uint64_t entered_ = 0;
  std::uint64_t taken_ = 0;
};

}  // namespace gridlock::exact
