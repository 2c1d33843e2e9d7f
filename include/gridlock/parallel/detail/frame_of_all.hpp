#pragma once

#include "gridlock/core/agents_view.hpp"
#include "gridlock/core/frame_source.hpp"
#include "gridlock/core/world.hpp"
#include "gridlock/parallel/detail/all_processes.hpp"

namespace gridlock {

/// Calls `use` on the root with a frame of the rows of all processes, which send their rows block by block until `use`
/// returns. `own` has the rows of this process, in the order of the Ids. All processes call it. Errors: those of `use`,
/// on all.
///
/// Only here does the root request data from other processes, so that code that writes frames needs no messages.
void give_rows(AllProcesses processes, Frame const& head, AgentsView const& own, UseFrame const& use);

/// Calls `use` on the root with a frame of a world whose agents processes share. Each has agents in the order of the
/// Ids.
template <class Model>
void give_frame(AllProcesses processes, World<Model> const& own, UseFrame const& use) {
  auto const of_this_process = frame_source_of(own);
  if (processes.count() == 1) {
    use(*of_this_process);
  } else {
    give_rows(processes, of_this_process->piece(0, 0), own.agents, use);
  }
}

}  // namespace gridlock
