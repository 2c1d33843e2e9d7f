#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>

namespace gridlock {

/// The file in the directory of a run that says how it ended and what came out.
inline constexpr char const* summary_name = "summary.json";

/// What a summary.json says, entry by entry; read_summary() says it in types.
/// Errors: Error for a file that is missing, damaged or of something else.
nlohmann::ordered_json read_summary_json(std::filesystem::path const& file);

}  // namespace gridlock
