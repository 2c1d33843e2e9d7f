#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "core/disks_overview.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/parallel/detail/all_processes.hpp"

namespace gridlock {

/// All values in a row of a state of disks.
struct DiskRow {
  Id id;
  double x, y, velocity_x, velocity_y, radius, mass;
  std::int32_t image_x, image_y;
};

/// Returns disks with these rows.
Disks disks_of(std::span<DiskRow const> rows);

/// Returns the overview of the disks of all processes. All processes call it.
DisksOverview overview_of_all(Disks const& own, AllProcesses processes);

/// Distributes `count` disks evenly, which the root makes by row_of(k) in the order of the Ids, message by message.
/// Returns the disks of this process. All processes call it.
Disks deal_out(AllProcesses processes, std::uint64_t count, std::function<DiskRow(std::uint64_t k)> const& row_of);

/// Returns whether all agents are in the order of their Ids, process after process. All processes call it.
bool are_in_order(AllProcesses processes, std::span<Id const> own);

/// Sorts the disks of all processes by Id and gives each process as many: process 0 gets the lowest Ids. All processes
/// call it. Cost: nothing for sorted disks, else a copy of each process's rows.
void sort_by_ids(AllProcesses processes, Disks& own);

/// Distributes the disks of a state that the root has, in any order, as deal_out() above.
State deal_out(AllProcesses processes, State whole);

}  // namespace gridlock
