#include "gridlock/simulation/setup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "core/saturating.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/simulation/world_simulation.hpp"
#include "simulation/check.hpp"
#include "simulation/potential_file.hpp"
#include "simulation/settings_message.hpp"
#include "simulation/slow_start.hpp"
#include "simulation/start_file.hpp"

namespace gridlock {

namespace {

constexpr std::uint64_t default_steps = 10'000;

}  // namespace

bool makes_start(double attempts, std::string const& key, SetupOptions const& options, std::vector<Event>& notes) {
  constexpr double min_attempts = 3e7;
  constexpr double seconds_per_attempt = 1.5e-7;
  double const seconds = attempts * seconds_per_attempt;
  if (attempts < min_attempts || options.on_slow_start(seconds)) return true;
  notes.push_back({.kind = EventKind::start_not_tried, .key = key, .values = {{"seconds", seconds}}});
  return false;
}

Setup set_up(SettingsFile const& file, SetupOptions const& options) {
  // A path on the command line is relative to the working directory, a path in a TOML file to that file's directory.
  auto const directory_of = [&](char const* key) {
    auto const location = file.location(key);
    bool const is_from_command_line = location && location->line == 0;
    return is_from_command_line ? options.directory : file.directory();
  };
  Configuration configuration;
  std::filesystem::path potential_file;
  options.processes.on_root([&] {
    configuration = read_configuration(file);
    try {
      potential_file = take_table_file(configuration.engine.potential, directory_of("potential.file"));
    } catch (Error const& error) {
      throw file.locate(error);
    }
  });
  broadcast_settings(options.processes, describing(configuration));
  try {
    SetupOptions known = options;
    known.directory = directory_of("disks.file");
    known.is_given = [&](std::string_view key) { return file.is_given(key); };
    Setup setup = set_up(std::move(configuration), known);
    setup.potential_file = std::move(potential_file);
    return setup;
  } catch (Error const& error) {
    throw file.locate(error);
  }
}

Setup set_up(Configuration configuration, SetupOptions const& options) {
  std::filesystem::path potential_file = take_table_file(configuration.engine.potential, options.directory);
  options.processes.agree([&] {
    check(configuration, options.is_given, options.processes);
    require_shareable(configuration, options.processes.count());
  });
  Setup setup;
  setup.potential_file = std::move(potential_file);
  setup.notes = unused_settings(configuration, options.is_given);
  setup.configuration = std::move(configuration);
  // The settings of other models are removed, since they would be written into config.resolved.toml without effect.
  setup.configuration.models.keep_only(setup.configuration.model.kind);
  // box.edge, which has no effect beside both others, is written as one of them, so that the three do not contradict.
  BoxSettings& box = setup.configuration.box;
  if (box.edge_x != AxisEdge::same && box.edge_y != AxisEdge::same) box.edge = edge_x_of(box);
  RunSettings& run = setup.configuration.run;
  if (!run.steps && !run.time && !run.collisions_per_disk) {
    run.steps = setup.configuration.protocol.empty() ? default_steps : 0;
  }
  setup.configuration.kind().build(setup, options);
  options.processes.agree([&] { check_end(setup); });
  if (auto note = flipped_tilt(box.tilt, make_box(box), "box.tilt")) setup.notes.push_back(*std::move(note));
  std::ranges::move(frames_beyond_end(setup), std::back_inserter(setup.notes));
  return setup;
}

StopCondition stop_condition_of(Setup const& setup) {
  RunSettings const& run = setup.configuration.run;
  Clock const clock = setup.simulation->clock();
  StopCondition stop_condition;
  if (run.steps) stop_condition.step = saturating_sum(clock.step, *run.steps);
  if (run.time) stop_condition.time = clock.time + *run.time;
  if (run.collisions_per_disk) {
    double const pairs = *run.collisions_per_disk * static_cast<double>(setup.simulation->agents()) / 2.0;
    stop_condition.pair_collisions = static_cast<std::uint64_t>(std::ceil(pairs));
  }
  return stop_condition;
}

RunPlan plan_of(Setup const& setup) {
  return {.stop_condition = stop_condition_of(setup),
          .sample_every = setup.configuration.observe.every,
          .samples_per_decade = setup.configuration.observe.per_decade,
          .equilibration = setup.configuration.observe.equilibration};
}

void throw_other_model(Setup const& setup) {
  if (setup.simulation == nullptr) {
    throw Error(Problem{.what = "this set-up has no simulation: its slow start was left out", .key = "model.kind"});
  }
  throw Error({.what = fmt::format("this set-up simulates the model \"{}\", not the one that was asked for",
                                   setup.configuration.model.kind),
               .hint = "name its type, simulate<Model>(), or use Run with setup.simulation, which serves every model",
               .key = "model.kind"});
}

State const& disks_of(Setup const& setup) {
  auto const* const disks = dynamic_cast<DiskSimulation const*>(setup.simulation.get());
  if (disks == nullptr) throw_other_model(setup);
  return disks->world();
}

}  // namespace gridlock
