#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "mpi_ranks.hpp"
#include "workspace/sweep_crew.hpp"

namespace gridlock::mpi {

/// The ranks of MPI_COMM_WORLD; rank 0 is the leader. Groups of ranks may share runs: the leader assigns a run to the
/// first rank of a group, and all its ranks carry out the run together.
///
///     ranks of a run: 3      0 1 2 │ 3 4 5 │ 6 7       0, 3 and 6 are first ranks
///
/// One thread of each rank exchanges messages with the leader; other threads call MPI only for runs on several ranks.
class MpiCrew final : public SweepCrew {
 public:
  /// `hooks.is_stop_asked` is called a few hundred times a second; a request to stop on one rank stops all ranks.
  explicit MpiCrew(RanksHooks hooks);

  /// Sets the number of simultaneous runs in each rank. Must precede lead() or help().
  void set_runs_at_a_time(std::size_t count) { runs_at_a_time_ = count; }
  /// Sets the number of ranks of a run. Must precede meet().
  void set_processes_of_run(std::size_t count);
  /// Returns whether other ranks wait for this rank.
  [[nodiscard]] bool is_working() const { return is_working_; }
  [[nodiscard]] bool has_met() const { return has_met_; }

  [[nodiscard]] bool leads() const override { return rank_ == 0; }
  [[nodiscard]] std::size_t processes_on_machine() const override { return ranks_here_; }
  [[nodiscard]] std::size_t processes_of_run() const override { return static_cast<std::size_t>(ranks_of_run_); }
  [[nodiscard]] AllProcesses processes() override { return group_ ? AllProcesses(*group_) : AllProcesses(); }
  void meet(std::uint64_t plan_hash, std::string const& failure) override;
  void part() override;
  void lead(CrewLead const& lead) override;
  void help(MakeRun const& make) override;

 private:
  void form_groups();
  [[nodiscard]] MakeRun with_group(MakeRun const& make);
  void follow_group(MakeRun const& make);
  void release_group();

  RanksHooks hooks_;
  int rank_ = 0;
  int ranks_ = 1;
  std::size_t ranks_here_ = 1;
  std::size_t runs_at_a_time_ = 1;
  int ranks_of_run_ = 1;
  std::optional<MpiRanks> group_;
  bool has_met_ = false;
  bool is_working_ = false;
};

}  // namespace gridlock::mpi
