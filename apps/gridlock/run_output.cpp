#include "run_output.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "gridlock/observe/observable.hpp"
#include "pictures.hpp"

namespace gridlock::cli {

namespace {

using Json = nlohmann::ordered_json;

/// Minimum wall-clock time between two lines of JSON, in seconds.
constexpr double seconds_between_lines = 0.2;

/// The observables that are printed at the end of a run; summary.json has all of them.
constexpr std::string_view headlines[] = {"mean_displacement", "mean_squared_displacement",
                                          "kinetic_energy",    "compressibility_factor",
                                          "wall_pressure",     "collision_rate",
                                          "halted_fraction"};

void print_line(Json const& json) {
  fmt::print("{}\n", json.dump());
  std::fflush(stdout);
}

/// Returns a text such as "stage 2 of 3, decompress".
std::string stage_text(gridlock::Preparation const& preparation) {
  return fmt::format("stage {} of {}, {}", preparation.finished + 1, preparation.stages, preparation.what);
}

Json to_json(gridlock::Progress const& progress) {
  if (!progress.preparation.what.empty()) {
    return {{"event", "progress"},
            {"stage", progress.preparation.what},
            {"stages_finished", progress.preparation.finished},
            {"stages", progress.preparation.stages},
            {"fraction", progress.fraction},
            {"seconds", progress.seconds}};
  }
  Json observables = Json::object();
  for (std::size_t k = 2; k < progress.last_sample.size(); ++k) {
    double const value = progress.last_sample[k];
    observables[progress.columns[k].name] = std::isfinite(value) ? Json(value) : Json();
  }
  return {{"event", "progress"},
          {"step", progress.clock.step},
          {"time", progress.clock.time},
          {"fraction", progress.fraction},
          {"seconds", progress.seconds},
          {"seconds_left", progress.seconds_left()},
          {"agent_steps_per_second", progress.agent_steps_per_second},
          {"observables", observables}};
}

Json to_json(gridlock::Event const& event) {
  Json values = Json::object();
  for (auto const& named : event.values) {
    std::visit([&](auto const& value) { values[named.first] = value; }, named.second);
  }
  return {{"event", gridlock::to_text(event.kind)},
          {"severity", gridlock::to_text(event.severity)},
          {"step", event.step},
          {"key", event.key},
          {"values", values},
          {"text", gridlock::to_text(event)}};
}

/// Returns the first two observables of the last sample that have a value, for the progress line.
std::string sample_text(gridlock::Progress const& progress) {
  constexpr int most = 2;
  std::string text;
  int shown = 0;
  for (std::size_t k = 2; k < progress.last_sample.size() && shown < most; ++k) {
    if (!std::isfinite(progress.last_sample[k])) continue;
    text += fmt::format("  {} {:.4g}", progress.columns[k].name, progress.last_sample[k]);
    ++shown;
  }
  return text;
}

void print_estimate(gridlock::NamedEstimate const& result) {
  auto const& [value, error] = result.estimate;
  fmt::print("  {:<26} {:.6g}{}{}\n", result.name, value, error ? fmt::format(" ± {:.2g}", *error) : "",
             result.unit.empty() ? "" : "  " + result.unit);
}

bool has_last_state(std::filesystem::path const& directory) {
  std::error_code ignored;
  return std::filesystem::exists(directory / "final.xyz", ignored);
}

/// Returns whether a column belongs to a model, and is not an observable that all models may have.
bool is_of_model(std::string_view name) {
  static std::vector<gridlock::ColumnInfo> const observed = gridlock::observed_columns();
  return std::ranges::find(observed, name, &gridlock::ColumnInfo::name) == observed.end();
}

bool is_headline(gridlock::NamedEstimate const& result) {
  return std::ranges::find(headlines, result.name) != std::end(headlines);
}

/// Prints the means of the model's own columns, and the headlines among the other results.
void print_results(gridlock::RunRecord const& record) {
  for (gridlock::NamedEstimate const& result : record.results) {
    if (is_of_model(result.name) || is_headline(result)) print_estimate(result);
  }
}

/// Returns the completed work: "2000 steps", "2 stages", "1 of 2 stages" or "2 stages and 2000 steps".
std::string work_text(gridlock::RunRecord const& record) {
  gridlock::Preparation const& preparation = record.preparation;
  std::string steps = fmt::format("{} steps", record.steps);
  if (preparation.stages == 0) return steps;
  std::string const plural = preparation.stages == 1 ? "" : "s";
  if (preparation.finished < preparation.stages)
    return fmt::format("{} of {} stage{}", preparation.finished, preparation.stages, plural);
  std::string const stages = fmt::format("{} stage{}", preparation.stages, plural);
  return record.steps == 0 ? stages : fmt::format("{} and {}", stages, steps);
}

/// Returns the rate of steps; empty after a protocol, since the time includes its stages.
std::string rate_text(gridlock::RunRecord const& record) {
  if (record.preparation.stages > 0) return "";
  return fmt::format(" ({}agent-steps/s)", count_text(record.agent_steps_per_second()));
}

/// Returns how to continue the run. A failed stage would fail again, and files of the run may have been removed.
std::string resume_text(gridlock::RunRecord const& record, std::filesystem::path const& directory) {
  std::error_code ignored;
  if (!std::filesystem::exists(directory / "config.resolved.toml", ignored)) {
    return ", but the run itself is gone: somebody has removed its files";
  }
  bool const has_failed_stage = record.status == gridlock::RunStatus::failed && !record.preparation.what.empty();
  if (has_failed_stage) {
    return fmt::format(
        "\n  hint: change the settings of stage {}, \"{}\", in the run file and run it anew; resumed, it fails again",
        record.preparation.finished + 1, record.preparation.what);
  }
  return fmt::format("; continue with: {} resume {}", program_name(), directory.string());
}

}  // namespace

void RunOutput::add_to(CLI::App& verb) {
  verb.add_flag("--pictures,!--no-pictures", draws_,
                "Draw the pictures of the run at its end, as gridlock plot DIR does");
  auto* const quiet = verb.add_flag("-q,--quiet", is_quiet_, "Print errors only");
  verb.add_flag("-v,--verbose", is_verbose_, "Print every line of run.log as well")->excludes(quiet);
  verb.add_flag("--json", writes_json_, "Print progress and end as lines of JSON, for other programs")->excludes(quiet);
}

gridlock::RunHooks RunOutput::hooks() {
  signals_.emplace();
  line_.emplace();
  gridlock::RunHooks hooks;
  hooks.on_progress = [this](gridlock::Progress const& progress) {
    print_progress(progress);
    return !StopSignals::is_stop_asked();
  };
  hooks.on_event = [this](gridlock::Event const& event) {
    if (writes_json_) {
      print_line(to_json(event));
      return;
    }
    bool const is_warning = event.severity == gridlock::Severity::warning;
    bool const is_note = event.severity == gridlock::Severity::note && !is_quiet_;
    if (!is_verbose_ && !is_warning && !is_note) return;
    fmt::print(stderr, "{}{}\n", is_warning ? "warning: " : is_note ? "note: " : "", gridlock::to_text(event));
  };
  return hooks;
}

void RunOutput::print_progress(gridlock::Progress const& progress) {
  if (writes_json_) {
    if (progress.seconds - last_json_ < seconds_between_lines && progress.fraction < 1.0) return;
    last_json_ = progress.seconds;
    print_line(to_json(progress));
  } else if (is_quiet_) {
    return;
  } else if (!progress.preparation.what.empty()) {
    // The duration of a stage is unknown, so no remaining time is shown.
    line_->show(progress.fraction, stage_text(progress.preparation) + "  " + duration_text(progress.seconds));
  } else {
    line_->show(progress.fraction, progress.seconds,
                fmt::format("step {}  {}agent-steps/s{}", progress.clock.step,
                            count_text(progress.agent_steps_per_second), sample_text(progress)));
  }
}

void RunOutput::print_end(gridlock::RunRecord const& record, std::filesystem::path const& directory) const {
  if (writes_json_) {
    print_line({{"event", "end"},
                {"status", gridlock::to_text(record.status)},
                {"step", record.clock.step},
                {"time", record.clock.time},
                {"seconds", record.seconds},
                {"state_hash", fmt::format("{:016x}", record.state_hash)},
                {"directory", directory.string()}});
    return;
  }
  fmt::print("{} {} of {} agents in {}{}\n", gridlock::to_text(record.status), work_text(record), record.agents,
             duration_text(record.seconds), rate_text(record));
  print_results(record);
  fmt::print("  {:<26} {:016x}\nresults in {}\n", "state_hash", record.state_hash, directory.string());
  if (!draws_ && record.status == gridlock::RunStatus::finished && has_last_state(directory)) {
    fmt::print("pictures: {} plot {}\n", name_with_all_commands(), directory.string());
  }
}

ExitCode RunOutput::finish(gridlock::RunRecord const& record, std::filesystem::path const& directory) {
  line_.reset();
  signals_.reset();
  if (draws_ && !has_last_state(directory)) {
    fmt::print(stderr, "note: no pictures without the last state, which run.final_state = false leaves out\n");
  } else if (draws_) {
    draw_pictures(directory);
  }
  if (!is_quiet_) print_end(record, directory);
  if (record.status == gridlock::RunStatus::finished) return ExitCode::good;
  if (record.status == gridlock::RunStatus::failed) fmt::print(stderr, "error: {}\n", record.failure);
  fmt::print(stderr, "{} after {}; partial results are in {}{}\n", gridlock::to_text(record.status), work_text(record),
             directory.string(), resume_text(record, directory));
  return ExitCode::run_failed;
}

}  // namespace gridlock::cli
