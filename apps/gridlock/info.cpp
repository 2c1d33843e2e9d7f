#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <memory>

#include "gridlock/core/error.hpp"
#include "gridlock/io/file.hpp"
#include "gridlock/io/table.hpp"
#include "gridlock/io/xyz.hpp"
#include "gridlock/run/run_directory.hpp"
#include "verbs.hpp"

namespace {

namespace fs = std::filesystem;

nlohmann::ordered_json read_summary(fs::path const& path) {
  auto summary = nlohmann::ordered_json::parse(gridlock::read_file(path), nullptr, false);
  if (!summary.is_object() || !summary.contains("state_hash")) {
    throw gridlock::Error({.what = summary.is_discarded() ? "this is no JSON" : "this is no summary of a run",
                           .hint = "the file was changed or cut off; run again",
                           .file = path.string()});
  }
  return summary;
}

bool is_there(fs::path const& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

void print_run(fs::path const& file) {
  auto const summary = read_summary(file);
  fmt::print("a run of gridlock in {}\n", file.has_parent_path() ? file.parent_path().string() : ".");
  for (auto const& [key, entry] : summary.items()) {
    if (entry.is_object() && entry.contains("value") && entry["value"].is_number()) {
      auto const error = entry.value("error", nlohmann::ordered_json());
      std::string const unit = entry.value("unit", "");
      fmt::print("  {:<32} {:.8g}{}{}\n", key, entry["value"].get<double>(),
                 error.is_number() ? fmt::format(" ± {:.2g}", error.get<double>()) : "",
                 unit.empty() ? "" : "  " + unit);
    } else if (entry.is_object()) {
      for (auto const& [name, value] : entry.items()) {
        fmt::print("  {:<32} {}\n", fmt::format("{}.{}", key, name), value.dump());
      }
    } else {
      fmt::print("  {:<32} {}\n", key, entry.is_string() ? entry.get<std::string>() : entry.dump());
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

void print_frame(fs::path const& path) {
  gridlock::XyzFrame const frame = gridlock::read_xyz(path);
  gridlock::State const& state = frame.state;
  fmt::print(
      "{} disks in {}\n  {} box {} × {}, packing fraction {:.8g}\n  step {}, time {}, seed {}\n  {} velocities\n",
      state.disks.size(), path.string(), state.box.is_periodic() ? "periodic" : "walled", state.box.width(),
      state.box.height(), gridlock::covered_area(state.disks) / state.box.area(), state.clock.step, state.clock.time,
      state.seed, frame.has_velocities ? "with" : "without");
  fmt::print("  state_hash {:016x}\n", gridlock::hash(state));
}

ExitCode info(fs::path const& path) {
  if (is_there(path / "summary.json")) {
    print_run(path / "summary.json");
  } else if (is_there(path / "sweep.csv")) {
    print_sweep(path);
  } else if (path.filename() == "summary.json") {
    print_run(path);
  } else if (path.extension() == ".csv") {
    print_table(path);
  } else if (path.extension() == ".xyz") {
    print_frame(path);
  } else {
    throw gridlock::Error({.what = is_there(path) ? fmt::format("{} is nothing that gridlock writes", path.string())
                                                  : fmt::format("there is no {}", path.string()),
                           .hint = "name the directory of a run or sweep, an .xyz or a .csv file"});
  }
  return ExitCode::good;
}

}  // namespace

void add_info(CLI::App& app, ExitCode& exit_code) {
  CLI::App* const verb = app.add_subcommand("info", "Say what a result is: a run, a sweep, a table, a state");
  auto const path = std::make_shared<std::string>();
  verb->add_option("PATH", *path, "Directory of a run or sweep, .xyz or .csv file")->required();
  verb->callback([path, &exit_code] { exit_code = info(*path); });
}
