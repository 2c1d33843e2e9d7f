#include "workspace/run_results.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstddef>
#include <numbers>
#include <optional>
#include <system_error>

#include "gridlock/core/disks.hpp"
#include "gridlock/core/target.hpp"
#include "gridlock/io/xyz.hpp"
#include "io/field_file.hpp"
#include "io/file.hpp"
#include "io/network_file.hpp"
#include "simulation/expected_work.hpp"
#include "workspace/result_files.hpp"
#include "workspace/summary.hpp"

namespace gridlock {

namespace {

using Json = nlohmann::ordered_json;

Json to_json(std::vector<Count> const& counts) {
  Json json = Json::object();
  for (auto const& [name, value] : counts) json[name] = value;
  return json;
}

Table to_table(Distribution const& distribution) {
  Table table;
  for (std::size_t k = 0; k < distribution.columns.size(); ++k) {
    std::vector<double> const& values = distribution.columns_of_values[k];
    if (distribution.columns[k].is_count) {
      table.add_column(distribution.columns[k].name, std::vector<std::uint64_t>(values.begin(), values.end()));
    } else {
      table.add_column(distribution.columns[k].name, values);
    }
    if (k == 0 && !distribution.names.empty()) table.add_column("name", distribution.names);
  }
  return table;
}

/// Returns the packing fraction of agents with a radius; nothing for agents without radii.
std::optional<double> packing_fraction_of(FrameSource const& frame) {
  std::optional<std::size_t> const place = frame.find(Radius::name);
  if (!place) return std::nullopt;
  constexpr std::size_t rows_in_memory = 100'000;
  double area = 0.0;
  for_each_piece(frame.size(), rows_in_memory, [&](std::size_t first, std::size_t count) {
    FrameValues const radii = frame.values(*place, first, count);
    for (double const r : std::get<std::vector<double>>(radii)) area += std::numbers::pi * r * r;
  });
  return area / frame.box().area();
}

/// Returns the messages, bytes and waiting time of each process.
Json to_json(std::vector<Traffic> const& processes) {
  Json json = Json::array();
  for (Traffic const& of_process : processes) {
    json.push_back({{"messages_sent", of_process.messages},
                    {"bytes_sent", of_process.bytes},
                    {"seconds_waiting", of_process.seconds_waiting}});
  }
  return json;
}

}  // namespace

std::vector<std::pair<std::string, Table>> result_tables(RunRecord const& record) {
  std::vector<std::pair<std::string, Table>> tables{{"series.csv", record.series}};
  for (Distribution const& distribution : record.distributions) {
    tables.emplace_back(distribution.name + ".csv", to_table(distribution));
  }
  return tables;
}

std::string summary_text(std::string const& versions, Configuration const& configuration, std::uint64_t start_hash,
                         RunRecord const& record, FrameSource const& frame, std::vector<Traffic> const& traffic) {
  Json json;
  json["gridlock"] = versions;
  json["status"] = to_text(record.status);
  if (!record.failure.empty()) json["failure"] = record.failure;
  json["start_hash"] = fmt::format("{:016x}", start_hash);
  json["state_hash"] = fmt::format("{:016x}", record.state_hash);
  json["seed"] = frame.seed();
  json["model"] = configuration.model.kind;
  for (auto const& [name, choice] : configuration.kind().choices(configuration)) json[name] = choice;
  if (uses_device(configuration)) {
    if (std::optional<DeviceInfo> const device = find_device()) json["device"] = device->name;
  }
  // The key is not "agents", since that is an average if the number of agents changes.
  json["agents_at_end"] = record.agents;
  for (FrameColumn const& column : frame.columns()) {
    auto const names = configuration.kind().value_names(column.name);
    if (!names.empty()) json["value_names"][column.name] = names;
  }
  if (auto const packing_fraction = packing_fraction_of(frame)) json["packing_fraction"] = *packing_fraction;
  json["steps"] = record.steps;
  json["step"] = record.clock.step;
  json["time"] = record.clock.time;
  if (takes_steps(configuration)) json["time_step"] = record.time_step;
  json["timing"] = {{"seconds", record.seconds},
                    {"agent_steps_per_second", record.agent_steps_per_second()},
                    {"target", to_text(target())}};
  if (!traffic.empty()) json["timing"]["ranks"] = to_json(traffic);
  json["counters"] = to_json(record.counts);
  for (auto const& [name, estimate, unit] : record.results) {
    // A model may name an observable "time" or "seed", which are keys already.
    Json& entry = json[json.contains(name) ? "mean_" + name : name];
    entry["value"] = estimate.value;
    entry["error"] = estimate.error ? Json(*estimate.error) : Json();
    if (!unit.empty()) entry["unit"] = unit;
  }
  for (Event const& note : record.notes) json["notes"].push_back(to_text(note));
  return json.dump(2) + '\n';
}

void write_run_results(std::filesystem::path const& directory, std::string const& versions,
                       Configuration const& configuration, std::uint64_t start_hash, RunRecord const& record,
                       FrameSource const& frame, std::vector<Traffic> const& traffic) {
  // The summary is removed first and written last, so that only complete results have a summary.
  std::error_code ignored;
  std::filesystem::remove(directory / summary_name, ignored);
  record_result(directory / summary_name);
  for (auto const& [name, table] : result_tables(record)) {
    record_result(directory / name);
    write_csv(table, directory / name);
  }
  if (configuration.run.final_state) {
    record_result(directory / "final.xyz");
    write_xyz(frame, directory / "final.xyz");
    if (!frame.fields().empty()) {
      record_result(directory / final_fields_name);
      write_fields(frame.fields(), directory / final_fields_name);
    }
    if (!frame.networks().empty()) {
      record_result(directory / final_networks_name);
      write_networks(frame.networks(), directory / final_networks_name);
    }
  }
  write_file(directory / summary_name, summary_text(versions, configuration, start_hash, record, frame, traffic));
}

}  // namespace gridlock
