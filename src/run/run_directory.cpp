#include "gridlock/run/run_directory.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <utility>

#include "gridlock/core/error.hpp"
#include "gridlock/io/file.hpp"
#include "gridlock/io/settings_file.hpp"
#include "gridlock/io/xyz.hpp"

namespace gridlock {

namespace {

using Json = nlohmann::ordered_json;

Json counts_json(std::vector<Count> const& counts) {
  Json json = Json::object();
  for (auto const& [name, value] : counts) json[name] = value;
  return json;
}

Table to_table(Distribution const& distribution) {
  Table table;
  for (std::size_t k = 0; k < distribution.columns.size(); ++k) {
    table.add_column(distribution.columns[k].name, distribution.columns_of_values[k]);
  }
  return table;
}

/// The configuration as a user can run it again from this directory.
Configuration rerunnable(Setup const& setup) {
  Configuration configuration = setup.configuration;
  if (!setup.start_file.empty()) configuration.disks.file = "start.xyz";
  return configuration;
}

}  // namespace

char const* version() { return GRIDLOCK_VERSION; }

void open_run_directory(std::filesystem::path const& directory, bool overwrites) {
  std::error_code ignored;
  bool const is_used = std::filesystem::exists(directory / "summary.json", ignored) ||
                       std::filesystem::exists(directory / "sweep.csv", ignored) ||
                       std::filesystem::exists(directory / "report.html", ignored);
  if (is_used && !overwrites) {
    throw Error({.what = fmt::format("{} holds results already", directory.string()),
                 .hint = "name another directory with -o, or add --overwrite",
                 .key = "-o"});
  }
  make_output_directory(directory);
}

std::string summary_json(Setup const& setup, RunResult const& result) {
  State const& state = result.state;
  Json json;
  json["gridlock"] = version();
  json["ending"] = to_text(result.ending);
  if (!result.failure.empty()) json["failure"] = result.failure;
  json["state_hash"] = fmt::format("{:016x}", hash(state));
  json["seed"] = state.seed;
  json["engine"] = setup.configuration.engine.kind;
  json["disks"] = state.disks.size();
  json["packing_fraction"] = covered_area(state.disks) / state.box.area();
  json["steps"] = result.steps;
  json["step"] = state.clock.step;
  json["time"] = state.clock.time;
  json["time_step"] = result.time_step;
  json["timing"] = {{"seconds", result.seconds}, {"agent_steps_per_second", result.agent_steps_per_second()}};
  json["tally"] = counts_json(result.counts);
  for (auto const& [name, estimate, unit] : result.results) {
    Json& entry = json[name];
    entry["value"] = estimate.value;
    entry["error"] = estimate.error ? Json(*estimate.error) : Json();
    if (!unit.empty()) entry["unit"] = unit;
  }
  return json.dump(2) + '\n';
}

void write_run(Setup const& setup, RunResult const& result, std::filesystem::path const& directory) {
  Configuration configuration = rerunnable(setup);
  // Last to come and first to go, so that a directory with a summary is a complete one.
  std::error_code ignored;
  std::filesystem::remove(directory / "summary.json", ignored);
  write_file(directory / "config.resolved.toml", to_toml(describing(configuration)));
  if (!setup.start_file.empty()) write_xyz(setup.state, directory / "start.xyz");
  write_csv(result.series, directory / "series.csv");
  for (Distribution const& distribution : result.distributions) {
    write_csv(to_table(distribution), directory / (distribution.name + ".csv"));
  }
  write_xyz(result.state, directory / "final.xyz");
  write_file(directory / "summary.json", summary_json(setup, result));
}

}  // namespace gridlock
