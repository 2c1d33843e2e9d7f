#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "gridlock/parallel/detail/all_processes.hpp"
#include "workspace/sweep_setup.hpp"

namespace gridlock {

/// A run for one of the processes of a crew to make.
struct CrewJob {
  std::uint64_t run = 0;  ///< its number in the plan
  Prospect prospect;
};

/// How far a run has come, from 0 to 1; false: it is to stop after its present chunk.
using ReportShare = std::function<bool(double share)>;
/// Makes a run in this process and says how it ended, in the words of encode(); nothing where it was not begun. From
/// any thread.
using MakeRun = std::function<std::string(CrewJob const& job, ReportShare const& report)>;

/// The work of the leader of a crew with runs. All but `make` are called from one thread.
struct CrewLead {
  std::function<std::optional<CrewJob>()> next;  ///< the next run to be made; nothing where there is none left
  MakeRun make;
  std::function<bool(std::uint64_t run, double share)> report;  ///< false: all are to stop
  std::function<void(std::uint64_t run, std::string const& outcome)> finish;
};

/// Processes that carry out one command together, most of all a sweep. One of them leads: it opens the directory, hands
/// out the runs and writes the tables.
class SweepCrew {
 public:
  virtual ~SweepCrew() = default;

  [[nodiscard]] virtual bool leads() const = 0;
  /// How many of the crew share the memory of this machine.
  [[nodiscard]] virtual std::size_t processes_on_machine() const = 0;

  /// How many processes share each run; the last group may have fewer.
  [[nodiscard]] virtual std::size_t processes_of_run() const { return 1; }
  /// Those that share runs with this process, after meet().
  [[nodiscard]] virtual AllProcesses processes() { return {}; }

  /// Every process calls it once, when it is ready for runs of the plan with this hash, or when it cannot take part:
  /// `failure` then says why.
  /// Returns where all are ready for the same plan. Errors: RunFailure for another's failure; Error, in all processes,
  /// for another plan.
  virtual void meet(std::uint64_t plan_hash, std::string const& failure) = 0;
  /// Nobody waits for this process any more.
  virtual void part() = 0;
  /// For the leader: every run is made by some process, and all of them are let go.
  virtual void lead(CrewLead const& lead) = 0;
  /// For the others: makes the runs that the leader hands out, and takes part in those that this process shares, until
  /// there are no more.
  virtual void help(MakeRun const& make) = 0;
};

}  // namespace gridlock
