#pragma once

#include <cstddef>
#include <cstdint>

#include "core/disks_overview.hpp"
#include "engine/heading_columns.hpp"
#include "grid/validate_rows.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/grid/cell_layout.hpp"

namespace gridlock {

/// Throws Error for settings out of bounds, for a state without disks or refused by validate(), for a sub-step in which
/// a disk could jump over another, and for a periodic box in which a disk could hit an image that is not the nearest.
void require_room_for_turns(EngineSettings const& settings, State const& state);

/// Throws Error if `count` is 0.
void require_disks(std::uint64_t count);

/// Returns whether a sub-step is shorter than a contact distance, so that it cannot jump over a disk.
constexpr bool is_short(double squared_displacement, double contact) {
  return squared_displacement < contact * contact;
}

/// As require_room_for_turns(), without overlaps, for a process with `some` of all disks and the problems of all rows.
void require_room_for_turns_of(EngineSettings const& settings, State const& some, DisksOverview const& all,
                               RowProblems const& problems);

/// Throws RunFailure for the disk of row i, which has become so fast that it could jump over another.
[[noreturn]] void throw_long_substep(State const& state, std::size_t i, double displacement);

/// A disk, of any process, that could jump over another.
struct LongSubstep {
  Id id;
  double displacement;
  double contact;  ///< contact distance with the smallest disk
};
[[noreturn]] void throw_long_substep(std::uint64_t step, LongSubstep const& disk);

/// Returns the cells of the engine `stepped`. For lists these are the k × k cells of the settings, or the smallest
/// cells whose 3×3 block is enough at the start; for the packed grid those of packed_layout().
CellLayout stepped_layout(EngineSettings const& settings, State const& state);

EngineRecord stepped_record();

class HotDisks;
struct HeadingStep;

/// The engine `stepped`: disks take turns in the order of their Ids, by the rule of the paper. It runs on the paper's
/// linked lists, the reference for every faster version, or on the packed grid, with the same bits.
///
/// Errors: those of require_room_for_turns(); RunFailure for a disk that becomes too fast for its sub-steps.
class SteppedEngine final : public Engine {
 public:
  SteppedEngine(EngineSettings const& settings, State const& state);

  void advance(State& state, Counters& counters, StopCondition const& stop_condition) override;
  [[nodiscard]] double time_step() const override { return duration_; }
  void give_frame(FrameSource const& of_world, UseFrame const& use) const override {
    give_frame_with_headings(settings_.propulsion, of_world, use);
  }
  void require_valid(State const& state) const override { require_room_for_turns(settings_, state); }

 private:
  void advance_on_lists(State& state, Counters& counters, StopCondition const& stop_condition) const;
  void advance_packed(State& state, Counters& counters, StopCondition const& stop_condition) const;
  /// Sets `of_step` for each step, if disks propel themselves, and turns their headings.
  /// Calls take(i, squared_speed) for each disk in the order of its row, step after step until the stop condition
  /// holds, then writes all disks back.
  /// Errors: RunFailure for a disk that has become so fast that a sub-step could jump over another.
  template <class TakeTurn>
  void take_turns(State& state, HotDisks& disks, Counters& counters, StopCondition const& stop_condition,
                  HeadingStep& of_step, TakeTurn take) const;

  EngineSettings settings_;
  double duration_;
  Box box_;  ///< the box that layout_ was made for
  CellLayout layout_;
};

}  // namespace gridlock
