#pragma once

#include <filesystem>
#include <utility>
#include <vector>

#include "core/disks_overview.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/simulation/setup.hpp"

namespace gridlock {

/// Returns the disks at the start of a run, and adds notes on them to `setup`. Each process calls it and gets its own
/// disks in the order of Ids. Errors: Error in all processes if the start cannot be made or the run would never end.
State start_of_disks(Setup& setup, SetupOptions const& options);

/// Returns whether only collisions end a run.
inline bool ends_with_collisions(RunSettings const& run) { return !run.steps && !run.time; }
/// Throws an Error if all disks are at rest, since collisions are to end the run.
void require_motion(DisksOverview const& all);

/// Calls `act`. An Error about the disks as a whole gets the name of their start file.
template <class Act>
auto blaming_file(std::filesystem::path const& start_file, Act act) {
  try {
    return act();
  } catch (Error const& error) {
    if (start_file.empty()) throw;
    std::vector<Problem> problems = error.problems();
    for (Problem& problem : problems) {
      if (problem.key != "disks") continue;  // only this key concerns the disks as a whole
      problem.what = start_file.string() + ": " + problem.what;
      problem.key = "disks.file";
    }
    throw Error(std::move(problems));
  }
}

}  // namespace gridlock
