#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "gridlock/parallel/detail/all_processes.hpp"
#include "workspace/sweep_setup.hpp"

namespace gridlock {

/// A run that the leader of a crew assigns to a process.
struct CrewJob {
  std::uint64_t run = 0;  ///< index in the plan
  Prospect prospect;
};

/// Takes the fraction of a run that is done, 0 to 1. Returns false if the run must stop after its current chunk.
using ReportShare = std::function<bool(double share)>;
/// Carries out a run in this process and returns its outcome by encode(); an empty text if it was not begun. Any thread
/// may call it.
using MakeRun = std::function<std::string(CrewJob const& job, ReportShare const& report)>;

/// The functions by which the leader of a crew assigns runs. All but `make` are called from one thread.
struct CrewLead {
  std::function<std::optional<CrewJob>()> next;  ///< returns the next run; nothing at the end
  MakeRun make;
  std::function<bool(std::uint64_t run, double share)> report;  ///< false: stop all runs
  std::function<void(std::uint64_t run, std::string const& outcome)> finish;
};

/// Processes that carry out a sweep or another command together. The leader opens the directory, assigns the runs and
/// writes the tables.
class SweepCrew {
 public:
  virtual ~SweepCrew() = default;

  [[nodiscard]] virtual bool leads() const = 0;
  /// Returns how many processes of the crew share the memory of this machine.
  [[nodiscard]] virtual std::size_t processes_on_machine() const = 0;

  /// Returns how many processes share each run; the last group may have fewer.
  [[nodiscard]] virtual std::size_t processes_of_run() const { return 1; }
  /// Returns the processes that share runs with this process. Requires meet().
  [[nodiscard]] virtual AllProcesses processes() { return {}; }

  /// Waits until all processes have called it. A process passes the hash of its plan, or the reason why it cannot take
  /// part as `failure`. Returns if all processes have the same plan. Errors: RunFailure if another process has a
  /// failure; Error in all processes if plans differ.
  virtual void meet(std::uint64_t plan_hash, std::string const& failure) = 0;
  /// Leaves the crew, so that no other process waits for this one.
  virtual void part() = 0;
  /// Assigns all runs to processes, then releases the processes. Only the leader calls it.
  virtual void lead(CrewLead const& lead) = 0;
  /// Carries out the runs that the leader assigns to this process or its group, until none are left. All processes but
  /// the leader call it.
  virtual void help(MakeRun const& make) = 0;
};

}  // namespace gridlock
