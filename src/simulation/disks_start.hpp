#pragma once

#include <filesystem>
#include <utility>
#include <vector>

#include "core/disks_overview.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/simulation/setup.hpp"

namespace gridlock {

/// The disks that a run of this set-up starts from; where processes share them, those of this one, in the order of the
/// Ids. Notes what is worth telling of them. All processes call it.
/// Errors: Error, in all of them, for a start that cannot be made, and for one from which the run would never end.
State start_of_disks(Setup& setup, SetupOptions const& options);

/// Whether nothing else ends a run.
inline bool ends_with_collisions(RunSettings const& run) { return !run.steps && !run.time; }
/// Refuses disks at rest, where collisions are to end the run.
void require_motion(DisksOverview const& all);

/// Calls `act`; what is wrong with a state from a file is blamed on the file.
template <class Act>
auto blaming_file(std::filesystem::path const& start_file, Act act) {
  try {
    return act();
  } catch (Error const& error) {
    if (start_file.empty()) throw;
    std::vector<Problem> problems = error.problems();
    for (Problem& problem : problems) {
      if (problem.key != "disks") continue;  // the key of what is wrong with the state itself
      problem.what = start_file.string() + ": " + problem.what;
      problem.key = "disks.file";
    }
    throw Error(std::move(problems));
  }
}

}  // namespace gridlock
