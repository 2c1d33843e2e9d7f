#pragma once

#include "engine/tiled/share.hpp"
#include "gridlock/core/detail/ranks.hpp"
#include "gridlock/engine/engine.hpp"

namespace gridlock::tiled {

/// Moves a state on together with other ranks, of which this one leads: hands out the disks, has all take their steps, and
/// gathers the disks again. The bits, counters included, are those of one process.
/// Errors: RunFailure where a disk has become too fast for its sub-steps.
void advance_on_ranks(Ranks& ranks, TurnRule const& rule, CellLayout const& layout, std::uint64_t threads, State& state,
                      Counters& counters, StopCondition const& stop_condition);

/// The part of every other rank in it, after TaskOfRanks::steps_of_disks.
void take_part(Ranks& ranks, MessageReader& message);

}  // namespace gridlock::tiled
