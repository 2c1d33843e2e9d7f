#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "gridlock/workspace/sweep.hpp"

namespace gridlock {

inline constexpr char const* sweep_plan_name = "plan.json";

/// The name of a run: "packing_fraction=0.7_start=square", safe as the name of a directory on every file system.
///
/// Depends on the keys and the values alone, and two runs of a plan have the same name only if they have the same
/// values: a name that is too long or cannot hold a value as it is ends with a mark, a hash of all values.
std::string sweep_run_name(std::vector<std::string> const& keys, std::vector<std::string> const& values);

/// Where a run of a sweep in a directory is.
std::filesystem::path directory_of(std::filesystem::path const& sweep, SweepRun const& run);

/// Writes keys, base settings, names and values of a plan into a directory as plan.json.
void write_plan(SweepPlan const& plan, std::filesystem::path const& directory);

/// The same for plans with the same runs.
std::uint64_t hash_of(SweepPlan const& plan);

/// Reads what write_plan() wrote; the runs have no settings to run them with. A plan may come from a stranger: every
/// name is the one that sweep_run_name() gives, so that no path made of it leads out of the directory.
/// Errors: Error for a directory without a plan, and for a plan that is damaged.
SweepPlan read_plan(std::filesystem::path const& directory);

}  // namespace gridlock
