#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>

#include "gridlock/workspace/sweep.hpp"
#include "simulation/memory.hpp"
#include "workspace/sweep_directory.hpp"
#include "workspace/sweep_setup.hpp"
#include "workspace/sweep_tables.hpp"

namespace gridlock {

/// Makes runs of a sweep, one at a time or several from several threads.
class SweepWorker {
 public:
  SweepWorker(SweepPlan const& plan, SweepSettings const& settings, SweepDirectory const& directory,
              MemoryBudget& memory)
      : plan_(plan), settings_(settings), directory_(directory), memory_(memory) {}

  /// Makes a run, or continues what is there of it. `report` is told how far it is and says whether it should go on;
  /// nothing comes back where it says so before the run begins. What breaks the run is in what comes back.
  [[nodiscard]] std::optional<SweepOutcome> make(std::size_t run, Prospect const& prospect,
                                                 std::function<bool(double)> const& report) const;

 private:
  SweepPlan const& plan_;
  SweepSettings const& settings_;
  SweepDirectory const& directory_;
  MemoryBudget& memory_;
};

/// An outcome as one process tells it to another, every bit of its numbers.
std::string encode(SweepOutcome const& outcome);
/// Errors: RunFailure for another text.
SweepOutcome decode_outcome(std::string const& text);

}  // namespace gridlock
