#include "workspace/summary.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <exception>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

#include "gridlock/core/error.hpp"
#include "gridlock/workspace/run_directory.hpp"
#include "io/file.hpp"

namespace gridlock {

namespace {

using Json = nlohmann::ordered_json;

std::uint64_t hash_in(Json const& json, char const* key) {
  return std::stoull(json.at(key).get<std::string>(), nullptr, 16);
}

RunStatus status_in(Json const& json) {
  for (RunStatus const status : {RunStatus::finished, RunStatus::interrupted, RunStatus::failed}) {
    if (json.at("status") == to_text(status)) return status;
  }
  return RunStatus::failed;
}

Error damaged(std::filesystem::path const& path, std::string_view reason) {
  return Error({.what = fmt::format("{} is damaged: {}", path.string(), reason),
                .hint = "remove it, and gridlock resume writes it again",
                .file = path.string()});
}

}  // namespace

Json read_summary_json(std::filesystem::path const& file) {
  require_regular_file(file);
  Json json = Json::parse(read_file(file), nullptr, false);
  if (json.is_discarded()) throw damaged(file, "it is not JSON");
  if (json.is_object() && json.contains("ending") && !json.contains("status")) {
    throw Error(
        {.what = fmt::format("{} was written by an earlier version of gridlock: it has \"ending\" for \"status\"",
                             file.string()),
         .hint = "use that version, or run again in another directory",
         .file = file.string()});
  }
  if (!json.is_object() || !json.contains("state_hash")) throw damaged(file, "it is not the summary of a run");
  return json;
}

std::optional<RunSummary> read_summary(std::filesystem::path const& directory) {
  std::filesystem::path const path = directory / summary_name;
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return std::nullopt;
  Json const json = read_summary_json(path);
  try {
    RunSummary summary{.status = status_in(json),
                       .failure = json.value("failure", ""),
                       .start_hash = hash_in(json, "start_hash"),
                       .state_hash = hash_in(json, "state_hash"),
                       .seconds = json.at("timing").at("seconds").get<double>(),
                       .results = {}};
    for (auto const& [name, entry] : json.items()) {
      // An array "value" is a list of value names for a column of that name, not a result.
      if (!entry.is_object() || !entry.contains("value") || entry.at("value").is_array()) continue;
      Estimate estimate{.value = entry.at("value").get<double>(), .error = std::nullopt};
      if (!entry.at("error").is_null()) estimate.error = entry.at("error").get<double>();
      summary.results.push_back({name, estimate, entry.value("unit", "")});
    }
    return summary;
  } catch (std::exception const& error) {
    throw damaged(path, error.what());
  }
}

}  // namespace gridlock
