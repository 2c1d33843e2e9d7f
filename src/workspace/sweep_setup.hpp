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

/// The facts that are known of a run before it begins.
struct Prospect {
  double work = 0.0;  ///< 0: there is nothing to do, it is finished, another's, or cannot be made
  double bytes = 0.0;
  std::uint64_t threads = 0;
  bool takes_threads = false;  ///< as many as it is given: the user has set no number
};

/// Sets up every run of a sweep once, to know what it takes and which cannot be made, are finished already, or hinder
/// the others.
class SweepSetup {
 public:
  /// Errors: Error where not one run can be made, and for a run in the directory with other settings.
  SweepSetup(SweepPlan const& plan, SweepSettings const& settings, SweepDirectory const& directory,
             MemoryBudget& memory);

  [[nodiscard]] std::vector<Prospect> const& prospects() const { return prospects_; }
  /// The status of each run before any of them begins.
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
  std::vector<std::optional<std::vector<Event>>> notes_;  ///< of the runs that can be set up
  std::mutex mutex_;
  std::optional<Error> is_in_the_way_;
};

/// Whether the run has come to its end.
bool is_finished(SweepOutcome const& outcome);
/// The reason why a run failed, as the tables say it.
std::string reason_of(std::exception const& error);

}  // namespace gridlock
