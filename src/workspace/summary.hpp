#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>

namespace gridlock {

/// The file in the directory of a run that says how it ended and what came out.
inline constexpr char const* summary_name = "summary.json";

/// The entries of a summary.json; read_summary() says them in types.
/// Errors: Error for a file that is missing, damaged or of something else.
nlohmann::ordered_json read_summary_json(std::filesystem::path const& file);

}  // namespace gridlock
