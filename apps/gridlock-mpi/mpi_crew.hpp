#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

#include "workspace/sweep_crew.hpp"

namespace gridlock::mpi {

/// The ranks of MPI_COMM_WORLD; rank 0 leads. One thread of each rank calls MPI.
class MpiCrew final : public SweepCrew {
 public:
  /// `is_stop_asked` is asked a few hundred times a second; where one rank is asked to stop, all stop.
  explicit MpiCrew(std::function<bool()> is_stop_asked);

  [[nodiscard]] int rank() const { return rank_; }
  /// Runs at a time in each rank, before lead() or help().
  void set_runs_at_a_time(std::size_t count) { runs_at_a_time_ = count; }
  /// Whether other ranks wait for this one.
  [[nodiscard]] bool is_working() const { return is_working_; }
  [[nodiscard]] bool has_met() const { return has_met_; }

  [[nodiscard]] bool leads() const override { return rank_ == 0; }
  [[nodiscard]] std::size_t processes_on_machine() const override { return ranks_here_; }
  void meet(std::uint64_t plan_hash, std::string const& failure) override;
  void part() override { is_working_ = false; }
  void lead(CrewLead const& lead) override;
  void help(MakeRun const& make) override;

 private:
  std::function<bool()> is_stop_asked_;
  int rank_ = 0;
  int ranks_ = 1;
  std::size_t ranks_here_ = 1;
  std::size_t runs_at_a_time_ = 1;
  bool has_met_ = false;
  bool is_working_ = false;
};

}  // namespace gridlock::mpi
