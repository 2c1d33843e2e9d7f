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

/// The status of one run of a sweep, as the tables need it.
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

/// sweep.csv: one row a run, in the order of the plan.
Table rows_of(SweepPlan const& plan, std::vector<SweepOutcome> const& outcomes);

/// means.csv: averages over finished runs that differ in the seed alone.
Table means_of(SweepPlan const& plan, std::vector<SweepOutcome> const& outcomes);

/// Both tables, and how many runs did not come to their end.
SweepResult result_of(SweepPlan const& plan, std::vector<SweepOutcome> const& outcomes);

/// Writes both tables into the directory of a sweep.
void write_tables(SweepResult const& result, std::filesystem::path const& directory);

}  // namespace gridlock
