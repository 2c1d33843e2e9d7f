#include "outlook.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <ctime>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/io/settings_file.hpp"
#include "simulation/expected_work.hpp"
#include "simulation/frame_schedule.hpp"
#include "terminal.hpp"

namespace gridlock::cli {

namespace {

constexpr double gigabyte = 1e9;

/// Limits above which a run counts as large: minutes of work, or a gigabyte.
constexpr double large_work = 1e9;  // in turns of an agent
constexpr double large_bytes = gigabyte;

std::string bytes_text(double bytes) {
  return bytes >= gigabyte ? fmt::format("{:.1f} GB", bytes / gigabyte) : fmt::format("{:.0f} MB", bytes / 1e6);
}

std::vector<std::string> lines_of(StageSettings stage) {
  std::vector<std::string> lines;
  std::string const settings = to_toml([&](SettingVisitor& visitor) { describe(stage, visitor); });
  for (std::size_t at = 0; at < settings.size();) {
    std::size_t const end = std::min(settings.find('\n', at), settings.size());
    lines.push_back(settings.substr(at, end - at));
    at = end + 1;
  }
  return lines;
}

/// Returns a stage in words: "decompress: until_pressure = 1e-8".
std::string in_words(StageSettings const& stage) {
  std::string text;
  std::vector<std::string> const usual = lines_of({.kind = stage.kind});
  for (std::string const& line : lines_of(stage)) {
    if (std::ranges::find(usual, line) == usual.end()) text += (text.empty() ? ": " : ", ") + line;
  }
  return stage.kind + text;
}

void print_stages(std::vector<StageSettings> const& stages) {
  for (std::size_t k = 0; k < stages.size(); ++k) fmt::print("  stage {}: {}\n", k + 1, in_words(stages[k]));
}

/// The speed of a simulation per second of processor time.
struct Pace {
  double time = 0.0;  ///< time of the simulation
  double pair_collisions = 0.0;
};

/// Measures the speed in at most two steps; returns nothing if a step fails or the time does not advance.
std::optional<Pace> measured_pace(Simulation& simulation) {
  constexpr double patience = 2.0;  // in seconds
  // Processor time is measured, since other programs may compete for the cores.
  auto const since = [](std::clock_t begin) { return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC; };
  Pace pace;
  double seconds = 0.0;
  // The first step builds the neighbour search and the caches, so the second step is measured too.
  for (int steps = 0; steps < 2 && seconds < patience; ++steps) {
    Clock const before = simulation.clock();
    auto const collisions = static_cast<double>(simulation.pair_collisions());
    std::clock_t const begin = std::clock();
    try {
      simulation.advance({.step = before.step + 1, .should_continue = [&] { return since(begin) < patience; }});
    } catch (RunFailure const&) {
      return std::nullopt;
    }
    seconds = std::max(since(begin), 1e-6);
    pace = {.time = (simulation.clock().time - before.time) / seconds,
            .pair_collisions = (static_cast<double>(simulation.pair_collisions()) - collisions) / seconds};
  }
  if (!(pace.time > 0.0)) return std::nullopt;
  return pace;
}

/// Returns the expected duration of a run in seconds; the run ends at the first of its lengths.
double expected_seconds(RunSettings const& run, double time_step, std::size_t agents, Pace const& pace) {
  double seconds = std::numeric_limits<double>::infinity();
  if (run.steps) seconds = std::min(seconds, static_cast<double>(*run.steps) * time_step / pace.time);
  if (run.time) seconds = std::min(seconds, *run.time / pace.time);
  if (run.collisions_per_disk && pace.pair_collisions > 0.0) {
    seconds = std::min(seconds, *run.collisions_per_disk * static_cast<double>(agents) / 2.0 / pace.pair_collisions);
  }
  return seconds;
}

/// Returns the bytes of a frame with the requested columns, before compression.
double bytes_of_frame(AgentsView const& agents, std::string const& columns) {
  std::size_t bytes = sizeof(Id);
  for (std::size_t const place : chosen_columns(agents.names(), columns)) {
    bytes += std::visit([](auto values) { return sizeof(typename decltype(values)::element_type); },
                        agents.columns()[place].second);
  }
  return static_cast<double>(bytes) * static_cast<double>(agents.size());
}

/// Returns the number of frames until the end of a run, at most 10⁶ if its number of steps is unknown.
double expected_frames(Setup const& setup) {
  constexpr double most = 1e6;
  TrajectorySettings const& trajectory = setup.configuration.trajectory;
  if (!trajectory.has_frames()) return 0.0;
  RunSettings const& run = setup.configuration.run;
  double const time_step = setup.simulation->time_step();
  double steps = run.steps ? static_cast<double>(*run.steps) : most;
  if (run.time) steps = std::min(steps, *run.time / time_step);
  FrameSchedule const schedule(trajectory, time_step);
  double frames = 1.0;
  for (std::uint64_t step = schedule.next_after(0); static_cast<double>(step) <= steps && frames < most; ++frames) {
    step = schedule.next_after(step);
  }
  return frames;
}

void print_expectation(Setup const& setup) {
  Simulation& simulation = *setup.simulation;
  Expectation const expected = expectation_of(setup);
  bool const is_prepared = simulation.is_prepared();
  double const frames = is_prepared ? expected_frames(setup) : 0.0;
  double const bytes = frames * bytes_of_frame(simulation.view(), setup.configuration.trajectory.columns);
  bool const is_long = is_prepared && expected.work >= large_work;
  if (!is_long && expected.bytes < large_bytes && bytes < large_bytes) return;
  std::string text = fmt::format("about {} of memory", bytes_text(expected.bytes));
  std::optional<Pace> const pace = is_prepared ? measured_pace(simulation) : std::nullopt;
  if (pace) {
    double const seconds =
        expected_seconds(setup.configuration.run, simulation.time_step(), simulation.agents(), *pace);
    if (std::isfinite(seconds)) text += fmt::format(", {} on one core of this machine", duration_text(seconds));
  }
  if (frames > 0.0) text += fmt::format(", {:.0f} frames of {} at most in all", frames, bytes_text(bytes));
  fmt::print("  estimate: {}\n", text);
}

}  // namespace

void print_outlook(Setup const& setup) {
  print_stages(setup.configuration.protocol);
  if (setup.simulation != nullptr) print_expectation(setup);
}

}  // namespace gridlock::cli
