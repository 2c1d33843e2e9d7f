#pragma once

#include <cstddef>
#include <cstdint>

#include "core/disks_overview.hpp"
#include "grid/validate_rows.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/grid/cell_layout.hpp"

namespace gridlock {

/// Throws Error for settings out of their bounds, no disks, a state that validate() refuses, a start in which a
/// sub-step could jump over a disk, and a periodic box so small that the image a disk runs into need not be the nearest
/// one.
void require_room_for_turns(EngineSettings const& settings, State const& state);

/// Throws Error for no disks.
void require_disks(std::uint64_t count);

/// A disk that covers a contact distance in one sub-step could come out behind the disk it should have met.
inline bool is_short(double squared_displacement, double contact) { return squared_displacement < contact * contact; }

/// The same for some of all disks, but for whether they overlap. The problems are those of the rows of all.
void require_room_for_turns_of(EngineSettings const& settings, State const& some, DisksOverview const& all,
                               RowProblems const& problems);

/// Throws RunFailure: the disk of row i has become so fast that it could jump over another.
[[noreturn]] void throw_long_substep(State const& state, std::size_t i, double displacement);

/// A disk that could jump over another, whoever has it.
struct LongSubstep {
  Id id;
  double displacement;
  double contact;  ///< with the smallest disk
};
[[noreturn]] void throw_long_substep(std::uint64_t step, LongSubstep const& disk);

/// The cells of the engine `stepped`: for lists the k × k asked for, or the finest whose 3×3 block is enough for the
/// start; for the packed grid see packed_layout().
CellLayout stepped_layout(EngineSettings const& settings, State const& state);

EngineRecord stepped_record();

class HotDisks;

/// The paper's rule, disk after disk in the order of their Ids: on the paper's linked lists, the readable reference
/// every faster version is measured against, or on the packed grid, which gives the same bits.
///
/// Errors: those of require_room_for_turns(); RunFailure for a disk that becomes too fast for its sub-steps.
class SteppedEngine final : public Engine {
 public:
  SteppedEngine(EngineSettings const& settings, State const& state);

  void advance(State& state, Counters& counters, StopCondition const& stop_condition) override;
  [[nodiscard]] double time_step() const override { return duration_; }
  void require_valid(State const& state) const override { require_room_for_turns(settings_, state); }

 private:
  void advance_on_lists(State& state, Counters& counters, StopCondition const& stop_condition) const;
  void advance_packed(State& state, Counters& counters, StopCondition const& stop_condition) const;
  /// Calls take(i, squared_speed) for each disk in the order of its row, step after step until the stop condition
  /// holds, and writes all of them back.
  /// Errors: RunFailure for a disk that has become so fast that a sub-step could jump over another.
  template <class TakeTurn>
  void take_turns(State& state, HotDisks& disks, Counters& counters, StopCondition const& stop_condition,
                  TakeTurn take) const;

  EngineSettings settings_;
  double duration_;
  Box box_;  ///< the box layout_ was made for
  CellLayout layout_;
};

}  // namespace gridlock
