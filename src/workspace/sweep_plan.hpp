#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "gridlock/workspace/sweep.hpp"

namespace gridlock {

inline constexpr char const* sweep_plan_name = "plan.json";

/// Returns the name of a run, as "packing_fraction=0.7_start=square"; a valid directory name on every file system.
///
/// The name depends only on keys and values, and runs of a plan with different values have different names: a name that
/// is too long, or omits characters of a value, ends with a hash of all values.
std::string sweep_run_name(std::vector<std::string> const& keys, std::vector<std::string> const& values);

/// Returns the directory of a run in the directory of its sweep.
std::filesystem::path directory_of(std::filesystem::path const& sweep, SweepRun const& run);

/// Writes keys, base settings, names and values of a plan into a directory as plan.json.
void write_plan(SweepPlan const& plan, std::filesystem::path const& directory);

/// Returns a hash of a plan, equal for plans with the same keys, base settings, names and values.
std::uint64_t hash_of(SweepPlan const& plan);

/// Reads the plan.json of write_plan(); the runs have no settings. A plan may be hostile, so every name must be that of
/// sweep_run_name(), and no path leads out of the directory. Errors: Error if the directory has no plan or the plan is
/// damaged.
SweepPlan read_plan(std::filesystem::path const& directory);

}  // namespace gridlock
