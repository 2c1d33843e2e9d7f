#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "gridlock/core/agents_view.hpp"
#include "gridlock/core/frame_source.hpp"
#include "gridlock/core/world.hpp"
#include "gridlock/parallel/detail/agent_homes.hpp"
#include "gridlock/parallel/detail/row_division.hpp"

namespace gridlock {

/// The root hands a frame to `use`, and all give it their rows piece by piece, until it returns. `own` are the
/// rows of this process, in the order of the Ids, as `rows` divides them. All call it. Errors: those of `use`, on all.
///
/// Here alone one process asks others for something, so that those who write frames need not know of them.
void give_rows(AllProcesses processes, Frame const& head, AgentsView const& own, RowDivision const& rows,
               UseFrame const& use);

/// Whether all agents are in the order of their Ids, process after process. All call it.
bool are_in_order(AllProcesses processes, std::span<Id const> own);

/// The same for a world of which each process has some agents, in the order of their Ids. All call it. Cost: unless
/// these are blocks of all, each has a copy of such a block for as long.
template <class Model>
void give_frame(AllProcesses processes, World<Model> const& own, UseFrame const& use) {
  using Agents = typename World<Model>::Agents;
  if (processes.count() == 1) {
    use(*frame_source_of(own));
    return;
  }
  // Others belong to one process.
  if constexpr (requires { typename Agents::AllValues; }) {
    auto const ids = own.agents.ids();
    Frame const head = frame_source_of(own)->piece(0, 0);
    if (are_in_order(processes, ids)) {
      give_rows(processes, head, own.agents, division_of(processes, ids.size()), use);
      return;
    }
    std::vector<Id> const first = first_ids_of_blocks(processes, ids);
    AgentRows<Agents> rows = exchanged_agents<Agents>(processes, ids, own.agents.values(), [&](std::size_t row) {
      return static_cast<std::size_t>(std::ranges::upper_bound(first, ids[row]) - first.begin()) - 1;
    });
    sort_agents(rows);
    Agents block;
    block.become(rows.ids, rows.values);
    give_rows(processes, head, std::as_const(block), division_of(processes, block.size()), use);
  }
}

}  // namespace gridlock
