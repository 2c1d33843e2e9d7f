#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/io/h5md.hpp"
#include "gridlock/io/table.hpp"
#include "gridlock/io/xyz.hpp"
#include "gridlock/workspace/run_directory.hpp"
#include "io/file.hpp"
#include "io/file_format.hpp"
#include "io/utf8.hpp"
#include "terminal.hpp"
#include "verbs.hpp"
#include "workspace/summary.hpp"

namespace gridlock::cli {

namespace {

namespace fs = std::filesystem;

bool is_there(fs::path const& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

/// Returns a value of a summary for a terminal: a text on one line, without control characters.
std::string shown(nlohmann::ordered_json const& value) {
  return value.is_string() ? one_line(value.get<std::string>()) : value.dump();
}

void print_run(fs::path const& file) {
  auto const summary = gridlock::read_summary_json(file);
  bool const is_of_run = summary.contains("status");
  fmt::print("{} in {}\n", is_of_run ? "a run of gridlock" : "the contacts of a packing",
             file.has_parent_path() ? file.parent_path().string() : ".");
  for (auto const& [name, entry] : summary.items()) {
    std::string const key = one_line(name);
    if (entry.is_object() && entry.contains("value") && entry["value"].is_number()) {
      auto const error = entry.value("error", nlohmann::ordered_json());
      std::string const unit = entry.contains("unit") ? shown(entry["unit"]) : "";
      fmt::print("  {:<32} {:.8g}{}{}\n", key, entry["value"].get<double>(),
                 error.is_number() ? fmt::format(" ± {:.2g}", error.get<double>()) : "",
                 unit.empty() ? "" : "  " + unit);
    } else if (entry.is_object()) {
      for (auto const& [part, value] : entry.items()) {
        fmt::print("  {:<32} {}\n", fmt::format("{}.{}", key, one_line(part)), value.dump());
      }
    } else {
      fmt::print("  {:<32} {}\n", key, shown(entry));
    }
  }
}

void print_table(fs::path const& path) {
  gridlock::Table const table = gridlock::read_csv(path);
  fmt::print("a table of {} rows in {}\n  columns: {}\n", table.row_count(), path.string(),
             fmt::join(table.names(), ", "));
}

void print_sweep(fs::path const& directory) {
  gridlock::Table const rows = gridlock::read_csv(directory / "sweep.csv");
  fmt::print("a sweep of {} runs in {}\n", rows.row_count(), directory.string());
  print_table(directory / "means.csv");
}

/// Prints a frame of a file of extended XYZ: the chosen frame, or else the last.
void print_frame(fs::path const& path, std::optional<std::int64_t> chosen) {
  std::uint64_t const frames = gridlock::count_xyz_frames(path);
  gridlock::XyzFrame const frame = gridlock::read_xyz(path, frames > 1 ? chosen.value_or(-1) : chosen, "--frame");
  gridlock::State const& state = frame.state;
  fmt::print("{} disks in {}\n", state.agents.size(), path.string());
  if (frames > 1) {
    std::int64_t const shown = chosen.value_or(-1);
    fmt::print("  {} frames; this is frame {}\n", frames,
               shown < 0 ? static_cast<std::int64_t>(frames) + shown : shown);
  }
  fmt::print("  {}, packing fraction {:.8g}\n  step {}, time {}, seed {}\n  {} velocities\n",
             text_of(state.box, frame.given_tilt), gridlock::covered_area(state.agents) / state.box.area(),
             state.clock.step, state.clock.time, state.seed, frame.has_velocities ? "with" : "without");
  if (!frame.unused_columns.empty()) fmt::print("  columns not used: {}\n", fmt::join(frame.unused_columns, ", "));
  if (!frame.unused_entries.empty()) {
    fmt::print("  of another kind than here, and not used: {}\n", fmt::join(frame.unused_entries, ", "));
  }
  fmt::print("  state_hash {:016x}\n", gridlock::hash(state));
}

void print_trajectory(fs::path const& path) {
  gridlock::H5mdReader const reader(path);
  gridlock::H5mdSettings const& settings = reader.settings();
  fmt::print("a trajectory of {} frames of {} in {}\n", reader.frame_count(), settings.agents, path.string());
  if (reader.frame_count() > 0) {
    gridlock::H5mdFrame const first = reader.frame(0);
    gridlock::H5mdFrame const last = reader.frame(reader.frame_count() - 1);
    gridlock::Box const& box = last.frame.box;
    std::vector<std::string> columns;
    for (gridlock::FrameColumn const& column : last.frame.columns) columns.push_back(column.name);
    fmt::print("  {}, {} agents first, {} last\n", text_of(box, last.given_tilt), first.frame.size(),
               last.frame.size());
    fmt::print("  steps {} to {}, time {} to {}\n", first.frame.clock.step, last.frame.clock.step,
               first.frame.clock.time, last.frame.clock.time);
    fmt::print("  columns: {}\n", fmt::join(columns, ", "));
    std::vector<std::string> fields;
    for (gridlock::Field const& field : last.frame.fields) {
      fields.push_back(fmt::format("{} of {} × {} cells", field.name(), field.columns(), field.rows()));
    }
    if (!fields.empty()) fmt::print("  fields: {}\n", fmt::join(fields, ", "));
    std::vector<std::string> networks;
    for (gridlock::Network const& network : last.frame.networks) {
      networks.push_back(fmt::format("{} of {} edges", network.name(), network.size()));
    }
    if (!networks.empty()) fmt::print("  networks: {}\n", fmt::join(networks, ", "));
    // Trajectories of other programs have no state hash.
    if (settings.creator == gridlock::H5mdSettings{}.creator)
      fmt::print("  last state_hash {:016x}\n", last.state_hash);
  }
  std::vector<std::string> observables;
  for (gridlock::H5mdObservable const& observable : settings.observables) observables.push_back(observable.name);
  fmt::print("  observables: {}\n", fmt::join(observables, ", "));
  if (!settings.left_out.empty()) fmt::print("  not read: {}\n", fmt::join(settings.left_out, ", "));
  fmt::print("  written by {} {}\n", settings.creator.empty() ? "an unnamed program" : settings.creator,
             settings.version);
}

/// Prints the state of a run in progress or an interrupted run, which has a log but no summary.
void print_unfinished_run(fs::path const& directory) {
  std::string const log = gridlock::read_file(directory / "run.log");
  std::size_t const end = log.find_last_not_of('\n');
  std::size_t const start = end == std::string::npos ? 0 : log.rfind('\n', end) + 1;
  fmt::print("a run of gridlock in {} without results yet; the last line of its log is\n  {}\n", directory.string(),
             log.substr(start, end + 1 - start));
  fmt::print("continue with: {} resume {}, unless a process is working on it\n", program_name(), directory.string());
}

ExitCode info(fs::path const& path, std::optional<std::int64_t> frame) {
  if (is_there(path / "summary.json")) {
    print_run(path / "summary.json");
  } else if (is_there(path / "sweep.csv")) {
    print_sweep(path);
  } else if (is_there(path / "run.log")) {
    print_unfinished_run(path);
  } else if (auto const format = recognize_format(path)) {
    if (format->id != "hdf5") throw wrong_format(*format, path.string(), "a run, sweep, table, state or trajectory");
    print_trajectory(path);
  } else if (path.filename() == "summary.json") {
    print_run(path);
  } else if (path.extension() == ".csv") {
    print_table(path);
  } else if (gridlock::has_xyz_ending(path)) {
    print_frame(path, frame);
  } else {
    std::error_code error;
    bool const is_empty = fs::is_regular_file(path, error) && fs::file_size(path, error) == 0;
    throw gridlock::Error(
        {.what = is_empty         ? fmt::format("{} is empty", path.string())
                 : is_there(path) ? fmt::format("{} is not a file that Gridlock wrote", path.string())
                                  : fmt::format("there is no {}", path.string()),
         .hint = "name the directory of a run or sweep, a table (.csv), a state (.xyz, .extxyz, .exyz) or a "
                 "trajectory (.h5, .h5md)"});
  }
  return ExitCode::good;
}

}  // namespace

void add_info(CLI::App& app, ExitCode& exit_code) {
  CLI::App* const verb =
      app.add_subcommand("info", "Describe a result: a run, a sweep, a table, a state, a trajectory");
  auto const path = std::make_shared<std::string>();
  verb->add_option("PATH", *path,
                   "Directory of a run or sweep, or a file: table (.csv), state (.xyz) or trajectory (.h5, .h5md)")
      ->required();
  auto const frame = std::make_shared<std::optional<std::int64_t>>();
  verb->add_option("--frame", *frame, "Of an .xyz file with several: from 0, or from -1 for the last");
  verb->callback([path, frame, &exit_code] { exit_code = info(*path, *frame); });
}

}  // namespace gridlock::cli
