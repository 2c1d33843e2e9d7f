#include "workspace/study_record.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstddef>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/core/target.hpp"
#include "gridlock/core/version.hpp"
#include "gridlock/io/table.hpp"
#include "gridlock/simulation/setup.hpp"

namespace gridlock {

namespace {

using Json = nlohmann::ordered_json;

constexpr char const* runs_name = "runs.csv";

/// A run of a study as its table tells it.
struct RunOfStudy {
  std::size_t row = 0;  ///< of the table, from 1
  std::string settings;
  std::string state_hash;
};

/// Returns a value of JSON as TOML.
std::string toml_of(Json const& value) {
  std::vector<std::string> parts;
  if (value.is_array()) {
    for (Json const& entry : value) parts.push_back(toml_of(entry));
    return fmt::format("[{}]", fmt::join(parts, ", "));
  }
  if (!value.is_object()) return value.dump();
  for (auto const& [key, entry] : value.items()) {
    if (!entry.is_null()) parts.push_back(fmt::format("{} = {}", key, toml_of(entry)));
  }
  return fmt::format("{{ {} }}", fmt::join(parts, ", "));
}

SettingsFile settings_of(RunOfStudy const& run) {
  Json const json = Json::parse(run.settings, nullptr, false);
  if (!json.is_object()) {
    throw Error(Problem{.what = "its settings are no object of JSON", .hint = "put back a copy of the file"});
  }
  std::string text;
  for (auto const& [key, value] : json.items()) {
    if (!value.is_null()) text += fmt::format("{} = {}\n", key, toml_of(value));
  }
  return SettingsFile::from_text(text, fmt::format("{}, row {}", runs_name, run.row));
}

std::vector<std::string> const* words_of(Table const& table, char const* name) {
  return table.contains(name) ? std::get_if<std::vector<std::string>>(&table.column(name)) : nullptr;
}

/// Sets the run of a row up again. Errors: Error for a row that cannot be read, or whose run cannot be made.
Setup setup_of(RunOfStudy const& run, VerifyOptions const& options) {
  constexpr std::size_t digits = 16;
  if (run.state_hash.size() != digits || run.state_hash.find_first_not_of("0123456789abcdef") != std::string::npos) {
    throw Error(
        {.what = fmt::format("\"{}\" is no state hash", run.state_hash), .hint = "put back a copy of the file"});
  }
  return set_up(settings_of(run), {.threads = options.threads});
}

/// Returns the difference between a run and its record, in words; nothing if there is none.
std::string difference_of(RunOfStudy const& run, Setup const& setup) {
  Simulation& simulation = *setup.simulation;
  StopCondition const end = stop_condition_of(setup);
  simulation.prepare([] { return true; });
  if (!end.is_reached(simulation.clock(), simulation.pair_collisions())) simulation.advance(end);
  std::string const hash = fmt::format("{:016x}", simulation.state_hash());
  if (hash == run.state_hash) return "";
  return fmt::format("the last state hash is {}, and the study recorded {}", hash, run.state_hash);
}

/// Chooses so many at random, in the order of the table; 0: all.
std::vector<RunOfStudy> chosen(std::vector<RunOfStudy> runs, VerifyOptions const& options) {
  if (options.windows == 0 || options.windows >= runs.size()) return runs;
  RandomStream random(options.seed, 0, 0, purpose_of_turn(0));
  for (std::size_t k = 0; k < options.windows; ++k) std::swap(runs[k], runs[k + random.below(runs.size() - k)]);
  runs.resize(options.windows);
  std::ranges::sort(runs, {}, &RunOfStudy::row);
  return runs;
}

}  // namespace

bool has_study_record(std::filesystem::path const& directory) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(directory / runs_name, ignored)) return false;
  Table const table = read_csv(directory / runs_name);
  return words_of(table, "settings") != nullptr && words_of(table, "state_hash") != nullptr;
}

VerifiedRuns verify_study(std::filesystem::path const& directory, VerifyOptions const& options,
                          std::function<void(std::string const&)> const& on_line) {
  Table const table = read_csv(directory / runs_name);
  std::vector<RunOfStudy> all;
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    // The study itself has placed the disks of a run without settings.
    if ((*words_of(table, "settings"))[row].empty()) continue;
    all.push_back({row + 1, (*words_of(table, "settings"))[row], (*words_of(table, "state_hash"))[row]});
  }
  std::vector<RunOfStudy> const runs = chosen(all, options);
  Verification found{.directory = directory, .version = version(), .target = to_text(target())};
  VerifiedRuns result;
  for (std::size_t k = 0; k < runs.size(); ++k) {
    auto const say = [&](char const* verdict, std::string const& why) {
      on_line(fmt::format("{}: {}: row {} of {}: {}", verdict, directory.string(), runs[k].row, runs_name, why));
    };
    try {
      std::string const difference = difference_of(runs[k], setup_of(runs[k], options));
      ++(difference.empty() ? result.verified : result.different);
      if (!difference.empty()) say("differs", difference);
      if (found.difference.empty()) found.difference = difference;
    } catch (RunFailure const& failure) {
      ++result.different;
      say("differs", failure.what());
      if (found.difference.empty()) found.difference = failure.what();
    } catch (Error const& error) {
      ++result.refused;
      say("cannot be verified", error.problems().front().what);
    }
    if (options.on_progress) options.on_progress(static_cast<double>(k + 1) / static_cast<double>(runs.size()));
  }
  found.hashes = result.verified;
  std::size_t const left_out = table.row_count() - all.size();
  on_line(fmt::format(
      "{}: {}: {} of the {} runs in {} were made again{}{}: {} agree in their last state hash, with {} by gridlock {}",
      result.different > 0 ? "differs"
      : result.refused > 0 ? "cannot be verified"
                           : "verified",
      directory.string(), runs.size() - result.refused, table.row_count(), runs_name,
      result.refused == 0 ? "" : fmt::format(", {} cannot be", result.refused),
      left_out == 0 ? "" : fmt::format(", {} of which start from disks that the study has placed", left_out),
      result.verified, found.target, found.version));
  result.runs.push_back(std::move(found));
  return result;
}

}  // namespace gridlock
