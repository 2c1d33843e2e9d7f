#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "engine/tiled/late_turns.hpp"
#include "engine/tiled/steps.hpp"
#include "gridlock/core/detail/counters_of_step.hpp"
#include "gridlock/core/detail/thread_pool.hpp"
#include "gridlock/grid/detail/tiling.hpp"
#include "gridlock/parallel/communicator.hpp"
#include "gridlock/parallel/detail/domain.hpp"
#include "gridlock/parallel/detail/halo.hpp"

namespace gridlock::tiled {

/// A disk that could have jumped over another.
struct Jump {
  std::uint32_t tile;
  std::uint32_t row_in_state;
  double displacement;
};

/// Two disks that overlap.
struct Overlap {
  std::uint32_t row;  ///< row in the state, of the disk with the lower Id
  std::uint32_t other_row;
  double gap;  ///< distance between the rims, below 0
};

/// The disks of some cells, in a message to another process.
struct CellsMessage {
  struct Cell {
    std::int32_t cell;
    std::uint32_t disks;
  };
  std::vector<Cell> cells;
  std::vector<DiskInTurn> disks;  ///< disks of the first cell, then of the second, …
  std::vector<std::uint8_t> has_turned;

  void clear() {
    cells.clear();
    disks.clear();
    has_turned.clear();
  }
};

/// The part of one process in the steps of `tiled`: the disks of its tiles, and copies of those in the cells around,
/// which other processes own. After each round it sends the changed cells to its neighbours, see Halo. Disks too fast
/// for their tile look at `reach_` cells to each side, the width of the rim.
///
/// All processes construct it and call take_step() together. The bits are those of a run in one process.
class Share {
 public:
  /// `disks` are those in the tiles of this process, with memory for room_for_rim() disks; `step` is the first to take.
  Share(Domain&& domain, TurnRule const& rule, std::uint64_t threads, std::uint64_t step,
        LargeArray<DiskInTurn>&& disks);

  void take_step();

  /// The first disk, by tile, that could have jumped over another in the last step; known to all processes.
  [[nodiscard]] std::optional<Jump> const& jump() const { return jump_; }

  /// The counters of the tiles of this process in each step since the last call.
  [[nodiscard]] std::vector<CountersOfStep> take_counters() { return std::exchange(counters_, {}); }
  /// The tiles of this process, in the order of take_counters().
  [[nodiscard]] std::vector<std::uint32_t> const& tiles() const { return steps_->tiles(); }

  /// Takes the disks of this process out and frees the memory of the steps. No further step can be taken.
  [[nodiscard]] LargeArray<DiskInTurn> take_own_disks();

  /// Returns overlaps of its disks with any disk by more than the tolerance; each pair is found by one process.
  [[nodiscard]] std::vector<Overlap> find_overlaps(double tolerance) const;

  /// Number of disks for which a process that owns `own` disks needs memory, copies of disks of the rim included. The
  /// copies are few relative to a large `own`.
  static std::size_t room_for_rim(std::size_t own) { return own + own / 8 + 256; }

 private:
  /// The tiles whose turns come between two exchanges of messages.
  struct Round {
    Tiling::Round before_sending;  ///< tiles whose turns other processes may see
    Tiling::Round meanwhile;       ///< other tiles, while messages travel
  };
  void place(LargeArray<DiskInTurn>&& own, int reach);
  void place_anew(int reach);
  [[nodiscard]] std::vector<std::uint32_t> own_disks() const;
  void find_rounds();
  [[nodiscard]] std::vector<std::uint8_t> latest_phases(std::vector<Tiling::Round> const& rounds) const;
  void fill_rounds(Tiling::Part const& part, std::vector<std::uint8_t> const& latest, std::size_t parts);
  void take_round(Tiling::Round const& round);
  void exchange(std::size_t round);
  void note_late(std::uint32_t tile);

  void take_late_turns();
  [[nodiscard]] std::vector<LateDisk> late_of_all(int& needed_reach);
  [[nodiscard]] int reach_of(LateGroup const& group) const;
  [[nodiscard]] bool may_jump(LateGroup const& group) const;
  void take_waves(std::vector<LateDisk> const& shared);
  void take_late(LateDisk const& late);
  void show_neighbourhoods(std::vector<LateDisk> const& shared);
  void tell_of_turns(std::vector<LateDisk> const& taken);
  template <class CellsSent, class CellsReceived>
  void exchange_zones(CellsSent cells_sent, CellsReceived cells_received);
  [[nodiscard]] std::vector<int> cells_of_zones(std::vector<LateDisk> const& late, std::size_t process,
                                                CellWindow const& window) const;
  [[nodiscard]] CellWindow zone_of(LateDisk const& late) const;
  [[nodiscard]] bool is_seen_by_others(LateDisk const& late) const;
  void find_jump();
  void count_step();

  void copy_cells(std::span<int const> cells, CellsMessage& to) const;
  void add_changed_cells(CellsMessage const& before, CellsMessage& to) const;
  void send_cells(std::size_t to, std::span<int const> cells);
  void send(std::size_t to, CellsMessage const& cells);
  void receive_cells(std::size_t from);

  Domain domain_;
  Communicator& processes_;
  TurnRule rule_;
  CellLayout layout_;
  Tiling tiling_;
  ThreadPool thread_pool_;
  int reach_ = 0;
  CellWindow window_;  ///< the tiles of this process and `reach_` cells around them
  Halo halo_;
  std::vector<CellsMessage> rings_before_;  ///< cells that each neighbour stores, before the present round
  std::array<Round, Tiling::colours> rounds_;
  std::optional<Steps> steps_;
  std::uint64_t steps_since_sort_ = 0;
  std::uint64_t step_;          ///< the next step
  std::vector<LateDisk> late_;  ///< disks too fast for their tile, in the order of turns
  bool may_jump_ = false;       ///< whether a disk of any process may jump over another
  std::optional<Jump> jump_;
  std::vector<CountersOfStep> counters_;  ///< counters of the steps since take_counters()
  CellsMessage message_;                  ///< scratch buffer of the message being written or read
};

}  // namespace gridlock::tiled
