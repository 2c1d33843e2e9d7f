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

/// Carries out runs of a sweep; several threads may use it at once.
class SweepWorker {
 public:
  SweepWorker(SweepPlan const& plan, SweepSettings const& settings, SweepDirectory const& directory,
              MemoryBudget& memory)
      : plan_(plan), settings_(settings), directory_(directory), memory_(memory) {}

  /// Carries out a run, or continues it if its directory has one. report(fraction) returns whether to continue; if it
  /// returns false before the run begins, the result is nothing. An exception becomes a failed outcome.
  [[nodiscard]] std::optional<SweepOutcome> make(std::size_t run, Prospect const& prospect,
                                                 std::function<bool(double)> const& report) const;

 private:
  SweepPlan const& plan_;
  SweepSettings const& settings_;
  SweepDirectory const& directory_;
  MemoryBudget& memory_;
};

/// Returns an outcome as text for another process, with all bits of its numbers.
std::string encode(SweepOutcome const& outcome);
/// Reads the text of encode(). Errors: RunFailure if the text is not valid.
SweepOutcome decode_outcome(std::string const& text);

}  // namespace gridlock
