#pragma once

#include "engine/ranks.hpp"
#include "engine/tiled/share.hpp"
#include "gridlock/engine/engine.hpp"

namespace gridlock::tiled {

/// Moves a state on together with other ranks, of which this one leads: hands out the disks, has all take their steps, and
/// gathers the disks again. The bits, counters included, are those of one process.
/// Errors: RunFailure where a disk has become too fast for its sub-steps.
void advance_on_ranks(Ranks& ranks, TurnRule const& rule, CellLayout const& layout, std::uint64_t threads, State& state,
                      Counters& counters, StopCondition const& stop_condition);

/// What every other rank does: takes part in each advance_on_ranks() of the leader until the leader releases it.
void help(Ranks& ranks);

/// The leader lets all others return from help().
void release_helpers(Ranks& ranks);

}  // namespace gridlock::tiled
