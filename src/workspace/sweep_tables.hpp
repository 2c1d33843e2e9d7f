#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "gridlock/simulation/run.hpp"
#include "gridlock/workspace/run_directory.hpp"
#include "gridlock/workspace/sweep.hpp"

namespace gridlock {

/// The outcome of one run of a sweep, for the tables.
struct SweepOutcome {
  bool has_begun = false;
  RunStatus status = RunStatus::interrupted;
  std::string message;
  std::uint64_t state_hash = 0;
  double seconds = 0.0;
  std::vector<NamedEstimate> results;

  [[nodiscard]] std::optional<Estimate> find(std::string const& name) const {
    auto const found = std::ranges::find(results, name, &NamedEstimate::name);
    return found == results.end() ? std::nullopt : std::optional(found->estimate);
  }
};

SweepOutcome outcome_of(RunSummary const& summary);

/// Returns the table sweep.csv: a row for each run, in the order of the plan.
Table rows_of(SweepPlan const& plan, std::vector<SweepOutcome> const& outcomes);

/// Returns the table means.csv: means over finished runs that differ only in the seed.
Table means_of(SweepPlan const& plan, std::vector<SweepOutcome> const& outcomes);

/// Returns both tables, and the numbers of failed and interrupted runs.
SweepResult result_of(SweepPlan const& plan, std::vector<SweepOutcome> const& outcomes);

/// Writes sweep.csv and means.csv into the directory of a sweep.
void write_tables(SweepResult const& result, std::filesystem::path const& directory);

}  // namespace gridlock
