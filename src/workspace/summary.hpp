#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>

namespace gridlock {

/// Name of the file in the directory of a run with its status and results.
inline constexpr char const* summary_name = "summary.json";
/// The fields of the last state, beside final.xyz.
inline constexpr char const* final_fields_name = "final_fields.h5";
/// The networks of the last state, beside final.xyz.
inline constexpr char const* final_networks_name = "final_networks.h5";

/// Returns the JSON of a summary; read_summary() converts it to a RunSummary.
/// Errors: Error if the file is missing, damaged or no summary.
nlohmann::ordered_json read_summary_json(std::filesystem::path const& file);

}  // namespace gridlock
