#pragma once

#include "gridlock/core/agents_view.hpp"
#include "gridlock/core/frame_source.hpp"
#include "gridlock/core/world.hpp"
#include "gridlock/parallel/detail/all_processes.hpp"

namespace gridlock {

/// The root hands a frame to `use`, and all give it their rows block by block, until it returns. `own` are the rows of
/// this process, in the order of the Ids. All call it. Errors: those of `use`, on all.
///
/// Here alone one process asks others for something, so that those who write frames need not know of them.
void give_rows(AllProcesses processes, Frame const& head, AgentsView const& own, UseFrame const& use);

/// The same as give_rows() for a world of which each process has some agents, in the order of their Ids.
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
