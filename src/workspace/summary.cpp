#include "workspace/summary.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "gridlock/core/error.hpp"
#include "gridlock/workspace/run_directory.hpp"
#include "io/file.hpp"

namespace gridlock {

namespace {

using Json = nlohmann::ordered_json;

Error damaged(std::filesystem::path const& path, std::string_view reason) {
  return Error({.what = fmt::format("{} is damaged: {}", path.string(), reason),
                .hint = "remove it, and gridlock resume writes it again",
                .file = path.string()});
}

/// The entries of an object in a summary. Errors: Error, by name, for an entry that is missing or of another type.
class Entries {
 public:
  Entries(std::filesystem::path const& path, Json const& object, std::string of = "")
      : path_(path), object_(object), of_(std::move(of)) {}

  template <class Value>
  [[nodiscard]] Value at(char const* name) const {
    if (!object_.contains(name)) throw damaged(path_, fmt::format("it has no {}{}", of_, name));
    return read<Value>(name);
  }
  /// Returns nothing for an entry that is missing or null.
  template <class Value>
  [[nodiscard]] std::optional<Value> find(char const* name) const {
    if (!object_.contains(name) || object_.at(name).is_null()) return std::nullopt;
    return read<Value>(name);
  }
  [[nodiscard]] std::uint64_t hash_at(char const* name) const {
    auto const text = at<std::string>(name);
    std::uint64_t hash = 0;
    auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), hash, 16);
    if (error != std::errc() || end != text.data() + text.size()) throw strange(name);
    return hash;
  }
  [[nodiscard]] Entries below(char const* name) const {
    if (!object_.contains(name) || !object_.at(name).is_object())
      throw damaged(path_, fmt::format("it has no {}", name));
    return {path_, object_.at(name), fmt::format("{}.", name)};
  }

 private:
  template <class Value>
  [[nodiscard]] Value read(char const* name) const {
    try {
      return object_.at(name).get<Value>();
    } catch (Json::exception const&) {
      throw strange(name);
    }
  }
  [[nodiscard]] Error strange(char const* name) const {
    return damaged(path_, fmt::format("{}{} = {} is not what a run writes", of_, name, object_.at(name).dump()));
  }

  std::filesystem::path const& path_;
  Json const& object_;
  std::string of_;
};

RunStatus status_of(std::string const& text) {
  for (RunStatus const status : {RunStatus::finished, RunStatus::interrupted, RunStatus::failed}) {
    if (text == to_text(status)) return status;
  }
  return RunStatus::failed;
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
  Entries const entries(path, json);
  Entries const timing = entries.below("timing");
  RunSummary summary{.status = status_of(entries.at<std::string>("status")),
                     .failure = entries.find<std::string>("failure").value_or(""),
                     .start_hash = entries.hash_at("start_hash"),
                     .state_hash = entries.hash_at("state_hash"),
                     .seconds = timing.at<double>("seconds"),
                     .results = {},
                     .version = entries.find<std::string>("gridlock").value_or(""),
                     .target = timing.find<std::string>("target").value_or("")};
  for (auto const& [name, entry] : json.items()) {
    // An array "value" is a list of value names for a column of that name, not a result.
    if (!entry.is_object() || !entry.contains("value") || entry.at("value").is_array()) continue;
    Entries const result = entries.below(name.c_str());
    summary.results.push_back({name,
                               {.value = result.at<double>("value"), .error = result.find<double>("error")},
                               result.find<std::string>("unit").value_or("")});
  }
  return summary;
}

}  // namespace gridlock
