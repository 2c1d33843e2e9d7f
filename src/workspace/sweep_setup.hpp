#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/workspace/sweep.hpp"
#include "simulation/memory.hpp"
#include "workspace/sweep_directory.hpp"
#include "workspace/sweep_tables.hpp"

namespace gridlock {

/// An estimate of a run before it begins.
struct Prospect {
  double work = 0.0;  ///< in units of Expectation::work; 0 if it is finished, another shard's, or impossible
  double bytes = 0.0;
  std::uint64_t threads = 0;
  bool takes_threads = false;  ///< whether to use as many threads as are free, since the user set no number
};

/// Sets up every run of a sweep once, to estimate its work and find runs that are impossible, finished, or in conflict
/// with runs in the directory.
class SweepSetup {
 public:
  /// Errors: Error if no run is possible, or a run in the directory has other settings.
  SweepSetup(SweepPlan const& plan, SweepSettings const& settings, SweepDirectory const& directory,
             MemoryBudget& memory);

  [[nodiscard]] std::vector<Prospect> const& prospects() const { return prospects_; }
  /// Returns the outcome of each run before the sweep begins.
  [[nodiscard]] std::vector<SweepOutcome> const& outcomes() const { return outcomes_; }
  [[nodiscard]] std::vector<std::string> notes() const;

 private:
  void set_up_all();
  void look_at(std::size_t run);
  void require_shareable(std::size_t run, Configuration const& configuration) const;
  void note_failure(std::size_t run, std::exception const& error);
  void require_one_good() const;
  void share_out_threads();

  SweepPlan const& plan_;
  SweepSettings const& settings_;
  SweepDirectory const& directory_;
  MemoryBudget& memory_;
  std::vector<SweepOutcome> outcomes_;
  std::vector<std::optional<Error>> errors_;
  std::vector<Prospect> prospects_;
  std::vector<std::optional<std::vector<Event>>> notes_;  ///< notes of the runs that could be set up
  std::mutex mutex_;
  std::optional<Error> is_in_the_way_;
};

/// Returns whether a run has reached its end.
bool is_finished(SweepOutcome const& outcome);
/// Returns why a run failed, for the tables.
std::string reason_of(std::exception const& error);

}  // namespace gridlock
