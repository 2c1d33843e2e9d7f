#include "tiled.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "engine/hot_disks.hpp"
#include "engine/tiled/fetch_ahead.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/grid/detail/packed_grid.hpp"
#include "gridlock/grid/detail/update_order.hpp"
#include "packed_turns.hpp"
#include "stepped.hpp"
#include "turn.hpp"

namespace gridlock {

namespace {

/// Steps after which the disks are put in the order of their cells again: they drift less than a cell in that time.
constexpr std::uint64_t steps_between_sorts = 100;

/// The rows of the state tile by tile and in a tile cell by cell.
std::vector<std::uint32_t> rows_by_turn(State const& state, CellLayout const& layout, Tiling const& tiling) {
  std::vector<std::uint32_t> turn_of_cell(static_cast<std::size_t>(layout.count()));
  std::uint32_t next = 0;
  for (Tiling::Tile const& tile : tiling.tiles()) {
    for (int row = tile.first_row; row < tile.end_row; ++row) {
      for (int column = tile.first_column; column < tile.end_column; ++column) {
        turn_of_cell[static_cast<std::size_t>(row) * static_cast<std::size_t>(layout.columns()) +
                     static_cast<std::size_t>(column)] = next++;
      }
    }
  }
  std::size_t const disks = state.agents.size();
  auto const turn_of = [&](std::size_t i) {
    return turn_of_cell[static_cast<std::size_t>(layout.cell_of(position(state.agents, i)))];
  };
  std::vector<std::uint32_t> begin(turn_of_cell.size() + 1, 0);
  for (std::size_t i = 0; i < disks; ++i) ++begin[turn_of(i) + 1];
  for (std::size_t cell = 0; cell < turn_of_cell.size(); ++cell) begin[cell + 1] += begin[cell];
  std::vector<std::uint32_t> order(disks);
  for (std::size_t i = 0; i < disks; ++i) order[begin[turn_of(i)]++] = static_cast<std::uint32_t>(i);
  return order;
}

/// What one tile leaves behind in one step; on a cache line of its own, since threads write to it side by side.
struct alignas(64) TileResult {
  Counters counters;
  std::vector<std::uint32_t> too_fast_for_tile;  ///< rows that wait for the end of the step
  std::optional<std::size_t> too_fast;           ///< the first row that could jump over another
};

/// The turns of all disks, step after step.
class Steps {
 public:
  Steps(State const& state, EngineSettings const& settings, double duration, CellLayout const& layout,
        Tiling const& tiling)
      : tiling_(tiling),
        disks_(state, rows_by_turn(state, layout, tiling)),
        view_(disks_.view(state.box, settings, duration)),
        grid_(grid_of<PackedGrid>(layout, disks_)),
        turns_(view_, grid_, radius_range(state.agents), duration),
        smallest_radius_(radius_range(state.agents).smallest),
        group_size_(goes_around_box(layout, tiling) ? 1 : PackedTurns::largest_batch),
        results_(tiling.tiles().size()) {
    id_indices_.reserve(disks_.size());
    for (std::size_t k = 0; k < disks_.size(); ++k) id_indices_.push_back(disks_[k].id_index);
  }

  /// All disks take their turns. `for_each(parts, take)` calls take(part) for each, in any order or at once.
  template <class ForEach>
  void take_step(std::vector<Tiling::Round> const& rounds, Counters& counters, ForEach for_each) {
    marks_of_turned_ ^= all_slots;
    for (Tiling::Round const& round : rounds) {
      for_each(round.size(), [&](std::size_t part) { take_part(round[part]); });
    }
    // One after the other and in a fixed order: sums of floating point numbers depend on it.
    for (TileResult& result : results_) {
      for (std::uint32_t const i : result.too_fast_for_tile) take_late(i, result);
      result.too_fast_for_tile.clear();
      add(counters, result.counters);
      result.counters = {};
    }
  }

  /// Throws RunFailure where a disk has become too fast for its sub-steps.
  void require_no_jumps(State const& state) const {
    for (TileResult const& result : results_) {
      if (!result.too_fast) continue;
      double const displacement = std::sqrt(squared_length(disks_[*result.too_fast].velocity)) * view_.substep;
      throw_long_substep(state, disks_[*result.too_fast].row_in_state, displacement);
    }
  }

  void write_back(State& state) const { disks_.write_back(state); }

 private:
  /// A tile that is its own neighbour around a periodic box: cells three apart may have a common neighbour.
  static bool goes_around_box(CellLayout const& layout, Tiling const& tiling) {
    Tiling::Tile const& tile = tiling.tiles().front();
    return layout.is_periodic() && (tile.end_column == layout.columns() || tile.end_row == layout.rows());
  }

  void take_part(Tiling::Part const& part) {
    static thread_local UpdateOrder update_order;
    FetchAhead ahead(grid_, view_, id_indices_);
    auto const tile = [&](std::size_t k) { return k < part.size() ? &tiling_.tiles()[part[k]] : nullptr; };
    for (std::size_t k = 0; k < part.size(); ++k) {
      update_order.find(grid_, *tile(k), id_indices_, [marks = marks_of_turned_](PackedGrid::Block& block) {
        unsigned const taken = (1U << block.count) - 1U;
        unsigned const pending = (block.marks ^ marks) & taken;
        block.marks = static_cast<std::uint16_t>(marks & taken);
        return pending;
      });
      ahead.aim(tile(k + 1), tile(k + 2), update_order.size());
      TileResult& result = results_[part[k]];
      update_order.for_each_group([&](std::span<std::uint32_t const> rows) {
        for (std::size_t first = 0; first < rows.size(); first += group_size_) {
          take_group(rows.subspan(first, std::min(group_size_, rows.size() - first)), result, ahead);
        }
      });
    }
  }

  /// The turns of disks without a common neighbour.
  void take_group(std::span<std::uint32_t const> rows, TileResult& result, FetchAhead& ahead) {
    // A local disk is short of a contact distance in the whole step, so in each sub-step too.
    turns_.take_batch(rows, result.counters, result.too_fast_for_tile);
    ahead.advance(rows.size());
  }

  void take_late(std::uint32_t i, TileResult& result) {
    double const squared_speed = squared_length(disks_[i].velocity);
    if (is_short(squared_speed * view_.substep * view_.substep, disks_[i].radius + smallest_radius_)) {
      turns_.take_any(i, result.counters);
    } else if (!result.too_fast) {
      result.too_fast = i;
    }
  }

  Tiling const& tiling_;
  HotDisks disks_;
  TurnView view_;
  PackedGrid grid_;
  PackedTurns turns_;
  double smallest_radius_;
  std::size_t group_size_;
  /// A disk has the mark of its last turn, from when its tile begins; what a mark says turns around with every step.
  static constexpr unsigned all_slots = (1U << PackedGrid::slots) - 1U;
  unsigned marks_of_turned_ = 0;           ///< what the marks are of those that have had their turn
  std::vector<std::uint32_t> id_indices_;  ///< of DiskInTurn, side by side
  std::vector<TileResult> results_;
};

}  // namespace

EngineRecord tiled_record() {
  return {.name = "tiled",
          .documentation = "the same moves in an order that all cores can share",
          .uses_threads = true,
          .bytes_per_disk = 232.0,
          .bytes_per_disk_of_checkpoint = 19.0,
          .unused_because_of =
              [](EngineSettings const& /*settings*/, std::string_view setting) {
                bool const is_unused = setting == "audit_every" || setting == "grid" || setting == "cells";
                return std::string_view(is_unused ? "kind" : "");
              },
          .cost_of_move = [](EngineSettings const& /*settings*/, State const& /*state*/) { return 1.0; },
          .make = [](EngineSettings const& settings, State const& state) -> std::unique_ptr<Engine> {
            return std::make_unique<TiledEngine>(settings, state);
          }};
}

TiledEngine::TiledEngine(EngineSettings const& settings, State const& state)
    : settings_(settings), duration_(step_duration(settings, state)), box_(state.box), thread_pool_(settings.threads) {
  require_room_for_turns(settings, state);
  lay_out(state);
}

void TiledEngine::require_valid(State const& state) const { require_room_for_turns(settings_, state); }

void TiledEngine::lay_out(State const& state) {
  // Room for disks of twice the speed that the time step refers to, whatever the disks do now: the cells must be the
  // same for a run and for its continuation from a file, since the order of the turns depends on them.
  double const displacement_at_speed = settings_.time_step * 2.0 * radius_range(state.agents).smallest;
  layout_ = packed_layout(state.box, state.agents, 2.0 * displacement_at_speed);
  tiling_ = Tiling(layout_);
  rounds_ = tiling_.rounds(thread_pool_.size());
}

void TiledEngine::advance(State& state, Counters& counters, StopCondition const& stop_condition) {
  if (state.box != box_) {
    box_ = state.box;
    lay_out(state);
  }
  auto const is_before_stop = [&] { return !stop_condition.is_reached(state.clock, counters.pair_collisions); };
  bool is_stopped = false;
  while (is_before_stop() && !is_stopped) {
    Steps steps(state, settings_, duration_, layout_, tiling_);
    for (std::uint64_t n = 0; n < steps_between_sorts && is_before_stop() && !is_stopped; ++n) {
      steps.take_step(rounds_, counters, [&](std::size_t parts, auto take) { thread_pool_.for_each(parts, take); });
      try {
        steps.require_no_jumps(state);
      } catch (RunFailure const&) {
        steps.write_back(state);
        throw;
      }
      ++state.clock.step;
      state.clock.time += duration_;
      is_stopped = stop_condition.stops_here();
    }
    steps.write_back(state);
  }
}

}  // namespace gridlock
