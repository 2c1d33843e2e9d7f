#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "gridlock/grid/detail/class_order.hpp"
#include "gridlock/grid/detail/tiling.hpp"
#include "gridlock/model/turn.hpp"

namespace gridlock {

/// Whether some agents of a model may be too fast for their tile.
template <class Model>
consteval bool has_late_turns() {
  return requires(Model const& model, Turn<Model> const& turn) { model.is_local(turn, 0.0); };
}

/// A step of a tiled model: the turns of the agents of each tile, and those of agents that are late.
///
/// Of turns that fail the first one counts: that of the tile with the lowest number. Tiles behind it need not be taken,
/// since what comes before does not depend on them. So it is the same for any order of tiles that keeps the order of
/// colours.
template <class Model>
class TurnsInTiles {
 public:
  /// What happened in one tile in one step; on cache lines of its own, since threads write to it side by side.
  struct alignas(64) TileResult {
    Counters counters;
    std::vector<std::uint32_t> late;  ///< rows of agents that are not local, in the order of their turns
    std::uint64_t turns = 0;
    std::exception_ptr failure;
  };

  /// `rows` are those of the agents. Contract: every tile is taken, or nothing is asked about it.
  void begin_step(CellLayout const& layout, std::size_t rows) {
    if (results_.empty() || layout != layout_) {
      layout_ = layout;
      tiling_ = Tiling(layout);
      results_ = std::vector<TileResult>(tiling_.tiles().size());
    }
    has_turned_.assign(rows, 0);
    first_failure_ = no_failure;
  }

  [[nodiscard]] Tiling const& tiling() const { return tiling_; }
  [[nodiscard]] TileResult const& result_of(std::uint32_t tile) const { return results_[tile]; }

  /// Has the agents of a tile take their turns, save for those that are late. Tiles that Tiling allows may be taken at
  /// once.
  void take_tile(Model const& model, Neighbourhood<Model> around, std::uint32_t tile) {
    TileResult& result = results_[tile];
    result = {.counters = {}, .late = std::move(result.late), .turns = 0, .failure = {}};
    result.late.clear();
    if (tile > first_failure_) return;
    around.is_confined = true;
    around.counters = &result.counters;
    try {
      take_turns(model, around, tile, result);
    } catch (...) {
      note_failure(tile);
    }
  }

  /// Has the late agents of a tile take their turns. Contract: no turn has failed, and those of lower tiles have been
  /// taken.
  void take_late(Model const& model, Neighbourhood<Model> around, std::uint32_t tile) {
    TileResult& result = results_[tile];
    around.counters = &result.counters;
    try {
      for (std::uint32_t const row : result.late) take_turn(model, around, row, result);
    } catch (...) {
      note_failure(tile);
    }
  }

  [[nodiscard]] bool has_failed() const { return first_failure_ != no_failure; }
  /// The tile of the turn that failed, and what it threw.
  [[nodiscard]] std::uint32_t failed_tile() const { return first_failure_; }
  [[nodiscard]] std::exception_ptr failure() const { return results_[first_failure_].failure; }

  // The state of an agent that processes tell each other.

  [[nodiscard]] std::vector<std::uint8_t> const& has_turned() const { return has_turned_; }
  void set_turned(std::size_t row, std::uint8_t has_turned) {
    if (row >= has_turned_.size()) has_turned_.resize(row + 1);
    has_turned_[row] = has_turned;
  }

 private:
  static constexpr std::uint32_t no_failure = std::numeric_limits<std::uint32_t>::max();

  void note_failure(std::uint32_t tile) {
    results_[tile].failure = std::current_exception();
    std::uint32_t first = first_failure_;
    while (tile < first && !first_failure_.compare_exchange_weak(first, tile)) {
    }
  }

  void take_turns(Model const& model, Neighbourhood<Model>& around, std::uint32_t tile, TileResult& result) {
    static thread_local ClassOrder order;
    auto const take_waiting = [&](PackedGrid::Block const& block) {
      unsigned waiting = block.marks & ~WaitingInBlock::all_slots;
      for (unsigned s = 0; s < block.count; ++s) waiting |= (has_turned_[block.agent[s]] == 0 ? 1U : 0U) << s;
      return waiting;
    };
    // An empty cell may name an agent that has died.
    auto const ids = around.world.agents.ids();
    auto const id_of = [&](std::uint32_t row) { return row < ids.size() ? ids[row] : Id{0}; };
    for (std::size_t of_class = 0; of_class < ClassOrder::classes; ++of_class) {
      order.find(*around.grid, tiling_, std::span(&tile, 1), of_class, id_of, take_waiting);
      for (std::uint32_t const row : std::span(order.rows(), order.size())) {
        has_turned_[row] = 1;
        if (is_local(model, around, row)) {
          take_turn(model, around, row, result);
        } else {
          result.late.push_back(row);
        }
      }
    }
  }

  void take_turn(Model const& model, Neighbourhood<Model>& around, std::uint32_t row, TileResult& result) {
    Turn<Model> turn(around, row);
    model.turn(turn);
    ++result.turns;
  }

  [[nodiscard]] bool is_local(Model const& model, Neighbourhood<Model>& around, std::uint32_t row) const {
    if constexpr (has_late_turns<Model>()) {
      return model.is_local(Turn<Model>(around, row), std::min(layout_.cell_width(), layout_.cell_height()));
    } else {
      return true;
    }
  }

  CellLayout layout_;
  Tiling tiling_;
  std::vector<TileResult> results_;
  std::vector<std::uint8_t> has_turned_;                   ///< by row
  std::atomic<std::uint32_t> first_failure_ = no_failure;  ///< the lowest tile in which a turn failed
};

}  // namespace gridlock
