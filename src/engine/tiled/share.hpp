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
#include "gridlock/grid/detail/tile_division.hpp"
#include "gridlock/parallel/communicator.hpp"
#include "gridlock/parallel/detail/thread_pool.hpp"

namespace gridlock::tiled {

/// A disk that could have jumped over another.
struct Jump {
  std::uint32_t tile;
  std::uint32_t row_in_state;
  double displacement;
};

/// Two disks that overlap.
struct Overlap {
  std::uint32_t row;  ///< in the state, of the one whose Id comes first
  std::uint32_t other_row;
  double gap;  ///< between their rims, below 0
};

/// What some cells hold, for another rank.
struct CellsMessage {
  struct Cell {
    std::int32_t cell;
    std::uint32_t disks;
  };
  std::vector<Cell> cells;
  std::vector<DiskInTurn> disks;  ///< cell by cell
  std::vector<std::uint8_t> has_turned;

  void clear() {
    cells.clear();
    disks.clear();
    has_turned.clear();
  }
};

/// The share that one rank has in the steps of `tiled`: the disks of its tiles, and of the cells around them that
/// others own.
///
///     a rank's     ┌ ─ ─ ─ ─ ─ ─ ─ ─ ┐    In a round the tiles of a rank change their own cells and the ring around them. Then
///     window       │ ┌─────────────┐ │    it sends to each other rank what it has changed of what that one's tiles look at. No cell is
///                    │ its tiles   │      changed by two ranks in one round.
///                  │ └─────────────┘ │
///                  └ ─ ─ ─ ─ ─ ─ ─ ─ ┘    Disks too fast for their tile look `reach_` cells far, the width of the rim.
///
/// All ranks construct it and call take_step() together. The bits are those of one process.
class Share {
 public:
  /// `disks` are those in the rectangle of this rank, with room_for_rim() of them.
  Share(Communicator& ranks, TurnRule const& rule, CellLayout const& layout, std::vector<Tiling::Rectangle> division,
        std::uint64_t threads, LargeArray<DiskInTurn>&& disks);

  void take_step();

  /// Of the last step: the first disk that could have jumped over another, in the order of tiles. All ranks know it.
  [[nodiscard]] std::optional<Jump> const& jump() const { return jump_; }

  /// What the tiles of this rank have counted in each step since the last call.
  [[nodiscard]] std::vector<CountersOfStep> take_counters() { return std::exchange(counters_, {}); }
  /// The tiles that it counts for, in the order of its sums.
  [[nodiscard]] std::vector<std::uint32_t> const& tiles() const { return steps_->tiles(); }

  /// Takes the disks of this rank out, and frees what steps need: no further one can be taken.
  [[nodiscard]] LargeArray<DiskInTurn> take_own_disks();

  /// Disks of this rank that overlap others, wherever these are, by more than the tolerance; each pair is found by one
  /// rank.
  [[nodiscard]] std::vector<Overlap> find_overlaps(double tolerance) const;

  /// The number of disks for which a rank that owns `own` needs memory, its copies of disks of the rim included; few
  /// where it owns many.
  static std::size_t room_for_rim(std::size_t own) { return own + own / 8 + 256; }

 private:
  /// What is done between two messages to a neighbour.
  struct Round {
    Tiling::Round before_sending;  ///< what others may see
    Tiling::Round meanwhile;       ///< what they cannot, while messages travel
  };
  /// Cells that another rank sees and that the tiles of a round may change.
  struct CellsOfRound {
    std::vector<int> own;   ///< of these tiles, whose disks all move
    std::vector<int> ring;  ///< around them, where a disk changes only if it is hit or comes in
  };
  struct Neighbour {
    std::size_t rank;
    CellWindow own;     ///< the cells of its tiles
    CellWindow seen;    ///< those and the ring around them, which its tiles look at: kept up to date in every round
    CellWindow window;  ///< all that it stores: brought up to date where a late disk looks at them
    std::array<CellsOfRound, Tiling::colours> changed;
    CellsMessage ring_before;  ///< of the present round
  };

  void place(LargeArray<DiskInTurn>&& own, int reach);
  void place_anew(int reach);
  [[nodiscard]] std::vector<std::uint32_t> own_disks() const;
  void find_neighbours();
  void find_rounds();
  [[nodiscard]] std::vector<std::uint8_t> latest_phases(std::vector<Tiling::Round> const& rounds) const;
  [[nodiscard]] CellsOfRound cells_of_round(Round const& round, CellWindow const& window) const;
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
  [[nodiscard]] std::vector<int> cells_of_zones(std::vector<LateDisk> const& late, std::size_t rank,
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

  Communicator& ranks_;
  TurnRule rule_;
  CellLayout layout_;
  Tiling tiling_;
  std::vector<Tiling::Rectangle> division_;
  Tiling::Rectangle own_;
  CellWindow own_cells_;  ///< of its tiles
  ThreadPool thread_pool_;
  int reach_ = 0;
  CellWindow window_;  ///< `reach_` cells around those of its tiles
  std::vector<Neighbour> neighbours_;
  std::array<Round, Tiling::colours> rounds_;
  std::optional<Steps> steps_;
  std::uint64_t steps_since_sort_ = 0;
  std::vector<LateDisk> late_;  ///< of its own tiles, in the order of their turns
  bool may_jump_ = false;       ///< some late disk of any rank
  std::optional<Jump> jump_;
  std::vector<CountersOfStep> counters_;  ///< of steps that nobody has asked for yet
  CellsMessage message_;                  ///< the one that is written or read
};

}  // namespace gridlock::tiled
