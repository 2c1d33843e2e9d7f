#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "core/disks_overview.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/parallel/detail/all_processes.hpp"

namespace gridlock {

/// All that a row of a state holds.
struct DiskRow {
  Id id;
  double x, y, velocity_x, velocity_y, radius, mass;
  std::int32_t image_x, image_y;
};

/// Disks of these rows.
Disks disks_of(std::span<DiskRow const> rows);

/// The overview of the disks of all processes, which call it together.
DisksOverview overview_of_all(Disks const& own, AllProcesses processes);

/// The root has `count` disks, row_of(k) in the order of the Ids, and gives each process as many of them, piece by
/// piece. Returns those of this process. All call it.
Disks deal_out(AllProcesses processes, std::uint64_t count, std::function<DiskRow(std::uint64_t k)> const& row_of);

/// Whether all agents are in the order of their Ids, process after process. All call it.
bool are_in_order(AllProcesses processes, std::span<Id const> own);

/// Puts the disks of all processes in the order of their Ids: process 0 gets the first ones, and each as many. All call
/// it. Cost: nothing where they are in order, else a copy of the rows of each.
void sort_by_ids(AllProcesses processes, Disks& own);

/// The same as deal_out() for a state that the root has, in any order.
State deal_out(AllProcesses processes, State whole);

}  // namespace gridlock
