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

/// Returns whether some agents of a model may move farther than their tile allows.
template <class Model>
consteval bool has_late_turns() {
  return requires(Model const& model, Turn<Model> const& turn) { model.is_local(turn, 0.0); };
}

/// A step of a tiled model: the turns of the agents of each tile, and then those of late agents, which move too far for
/// their tile.
///
/// If several turns fail, the failure in the tile with the lowest number is reported. Later tiles may then be skipped,
/// since earlier tiles do not depend on them. So the reported failure is the same for any order of tiles that keeps the
/// order of colours.
template <class Model>
class TurnsInTiles {
 public:
  /// The result of one tile in one step. Each has its own cache lines, since threads write to several results at the
  /// same time.
  struct alignas(64) TileResult {
    Counters counters;
    std::vector<std::uint32_t> late;  ///< rows of agents that are not local, in the order of their turns
    std::uint64_t turns = 0;
    std::exception_ptr failure;
  };

  /// Begins a step for agents in `rows` rows. Contract: result_of(tile) is read only after take_tile(tile).
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

  /// Takes the turns of the agents of a tile, and lists its late agents. Threads may take tiles of one colour at the
  /// same time.
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

  /// Takes the turns of the late agents of a tile. Contract: no turn has failed, and late agents of lower tiles have
  /// taken theirs.
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
  /// Return the tile of the turn that failed, and the exception that it threw.
  [[nodiscard]] std::uint32_t failed_tile() const { return first_failure_; }
  [[nodiscard]] std::exception_ptr failure() const { return results_[first_failure_].failure; }

  // Processes send each other these flags together with the agents.

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
    // A slot of an empty cell may hold the row of a dead agent.
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
  std::vector<std::uint8_t> has_turned_;                   ///< one flag for each row
  std::atomic<std::uint32_t> first_failure_ = no_failure;  ///< the lowest tile in which a turn failed
};

}  // namespace gridlock
