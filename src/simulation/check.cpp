#include "simulation/check.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gridlock/core/error.hpp"
#include "observe/unused_settings.hpp"
#include "simulation/countable_time.hpp"
#include "simulation/expected_work.hpp"
#include "simulation/frame_schedule.hpp"
#include "simulation/memory.hpp"

namespace gridlock {

namespace {

/// Largest number of collisions that fits into a counter of 64 bits, with a margin.
constexpr double max_collisions = 9e18;

/// Throws an Error about a table that belongs to another model, since it would have no effect.
void refuse_tables_of_others(Configuration const& configuration, IsGiven const& is_given) {
  std::string const& model = configuration.model.kind;
  Configuration described = configuration;
  std::vector<std::string> own;
  std::vector<Problem> problems;
  for (auto const& kind : described.models.all()) {
    if (kind->name() != model) continue;
    for (SettingTable const& table : kind->tables(described)) own.push_back(table.name);
  }
  for (auto const& other : described.models.all()) {
    for (SettingTable const& table : other->tables(described)) {
      if (std::ranges::find(own, table.name) != own.end() || !is_given(table.name)) continue;
      problems.push_back({.what = fmt::format("[{}] means nothing here: the model \"{}\" is run", table.name, model),
                          .hint = fmt::format("set model.kind = \"{}\", or take the table out; the settings of this "
                                              "model are in {}",
                                              other->name(), fmt::format("[{}]", fmt::join(own, "], ["))),
                          .key = table.name});
    }
  }
  if (!configuration.protocol.empty() && model != "disks") {
    problems.push_back({.what = fmt::format("a protocol means nothing here: the model \"{}\" is run", model),
                        .hint = "set model.kind = \"disks\", or take [[protocol]] out",
                        .key = "protocol"});
  }
  if (!configuration.engine.walls.empty() && model != "disks") {
    problems.push_back({.what = fmt::format("agents of the model \"{}\" know no walls inside the box", model),
                        .hint = "set model.kind = \"disks\", or take [[walls]] out",
                        .key = "walls"});
  }
  for (std::size_t k = 0; k < configuration.protocol.size(); ++k) {
    std::string const table = fmt::format("protocol[{}]", k);
    if (!is_given(table) || is_given(table + ".stage")) continue;
    problems.push_back({.what = fmt::format("{} does not say what happens in it", table),
                        .hint = "name the stage, as in stage = \"quench\"",
                        .key = table});
  }
  if (configuration.run.collisions_per_disk && !configuration.kind().counts_collisions()) {
    problems.push_back(
        {.what = fmt::format("the length of a run of the model \"{}\" cannot be given in collisions", model),
         .hint = "give run.steps or run.time",
         .key = "run.collisions_per_disk"});
  }
  if (!problems.empty()) throw Error(std::move(problems));
}

/// Refuses an empty disks.file, probably a mistake in a script; config.resolved.toml has it together with disks.start.
void require_name_of_file(Configuration const& configuration, IsGiven const& is_given) {
  if (!configuration.disks.file.empty() || !is_given("disks.file") || is_given("disks.start")) return;
  throw Error({.what = "disks.file is empty", .hint = "name a file, or leave the setting out", .key = "disks.file"});
}

/// Refuses box.edge where both edge_x and edge_y say otherwise: it would have no effect.
void require_one_edge(BoxSettings const& box, IsGiven const& is_given) {
  if (!is_given("box.edge") || box.edge_x == AxisEdge::same || box.edge_y == AxisEdge::same) return;
  if (edge_x_of(box) == box.edge || edge_y_of(box) == box.edge) return;
  auto const name = [](Edge edge) { return edge == Edge::wall ? "wall" : "periodic"; };
  throw Error({.what = fmt::format("box.edge = \"{}\" contradicts box.edge_x = \"{}\" and box.edge_y = \"{}\"",
                                   name(box.edge), name(edge_x_of(box)), name(edge_y_of(box))),
               .hint = "leave box.edge out, or one of the other two",
               .key = "box.edge"});
}

/// The end of a run as step and time after its start, as far as it is known in advance; infinite otherwise.
struct End {
  double step = std::numeric_limits<double>::infinity();
  double time = std::numeric_limits<double>::infinity();
};

End end_of(Setup const& setup) {
  // Rounding errors must not add or drop a step of a length that is a multiple of the time step.
  constexpr double rounding = 1e-9;
  RunSettings const& run = setup.configuration.run;
  End end;
  if (run.steps) end.step = static_cast<double>(*run.steps);
  if (run.time) end.time = *run.time;
  if (setup.simulation == nullptr) return end;
  double const duration = setup.simulation->time_step();
  bool const ends_within_steps = setup.configuration.kind().ends_within_steps(setup.configuration);
  double const steps = end.time / duration;
  end.step = std::min(end.step,
                      ends_within_steps ? std::floor(steps * (1.0 + rounding)) : std::ceil(steps * (1.0 - rounding)));
  end.time = end.step * duration * (1.0 + rounding);
  return end;
}

void note_frames_beyond(char const* key, char const* unit, std::vector<double> const& asked_for, double end,
                        std::vector<Event>& notes) {
  auto const beyond = std::ranges::count_if(asked_for, [&](double at) { return at > end; });
  if (beyond == 0) return;
  notes.push_back({.kind = EventKind::frames_beyond_end,
                   .key = key,
                   .values = {{"beyond", static_cast<std::uint64_t>(beyond)},
                              {"asked_for", static_cast<std::uint64_t>(asked_for.size())},
                              {"unit", std::string(unit)},
                              {"end", end}}});
}

}  // namespace

void check(Configuration const& configuration, IsGiven const& is_given, AllProcesses processes) {
  refuse_tables_of_others(configuration, is_given);
  require_name_of_file(configuration, is_given);
  require_one_edge(configuration.box, is_given);
  configuration.kind().check(configuration);
  require_memory(configuration, processes);
}

void require_shareable(Configuration const& configuration, std::size_t processes) {
  if (processes == 1) return;
  std::optional<Problem> problem = configuration.kind().not_shared(configuration);
  if (!problem && uses_device(configuration)) {
    problem = Problem{.what = "a run on a graphics processor",
                      .hint = "use gridlock run, or GRIDLOCK_DEVICE=cpu",
                      .key = "engine.device"};
  }
  if (!problem) return;
  problem->what = fmt::format("{} cannot be shared by {} ranks", problem->what, processes);
  if (problem->hint.empty()) {
    problem->hint =
        "disks with engine.kind = \"tiled\" can, and models whose agents take their turns all at once or tile by tile "
        "and that ask for sums over all agents alone; gridlock run carries out all others, and gridlock-mpi sweep many";
  }
  throw Error(*std::move(problem));
}

void check_end(Setup const& setup) {
  RunSettings const& run = setup.configuration.run;
  TrajectorySettings const& trajectory = setup.configuration.trajectory;
  static_cast<void>(FrameSchedule(trajectory, 1.0));
  if (setup.simulation == nullptr) return;
  Simulation const& simulation = *setup.simulation;
  std::vector<std::string_view> names = simulation.view().names();
  // Columns of frames that the engine adds.
  if (setup.configuration.engine.propulsion.is_on()) names.insert(names.end(), {"heading_x", "heading_y"});
  static_cast<void>(chosen_columns(names, trajectory.columns));
  if (run.collisions_per_disk &&
      *run.collisions_per_disk * static_cast<double>(simulation.agents()) / 2.0 >= max_collisions) {
    throw Error({.what = fmt::format("no run reaches {:.3g} collisions per disk", *run.collisions_per_disk),
                 .hint = "use a smaller number",
                 .key = "run.collisions_per_disk"});
  }
  if (run.time) require_countable_end(simulation.clock().time + *run.time, simulation.time_step());
}

std::vector<Event> unused_settings(Configuration const& configuration, IsGiven const& is_given) {
  ModelKind const& kind = configuration.kind();
  Configuration described = configuration;
  Configuration usual;
  std::vector<Event> notes;
  for (std::string const& key : setting_keys(describing(described))) {
    if (!is_given(key)) continue;
    constexpr std::string_view observe = "observe.";
    std::string const choice =
        key.starts_with(observe)
            ? std::string(unused_because_of(configuration.observe, std::string_view(key).substr(observe.size())))
            : kind.unused_because_of(configuration, key);
    if (choice.empty()) continue;
    notes.push_back({.kind = EventKind::unused_setting,
                     .key = key,
                     .values = {{"choice", choice}},
                     .is_default = value_in_toml(describing(described), key) == value_in_toml(describing(usual), key)});
  }
  return notes;
}

std::vector<Event> frames_beyond_end(Setup const& setup) {
  std::vector<Event> notes;
  TrajectorySettings const& trajectory = setup.configuration.trajectory;
  End const end = end_of(setup);
  note_frames_beyond("trajectory.steps", "step", trajectory.steps, end.step, notes);
  note_frames_beyond("trajectory.times", "time", trajectory.times, end.time, notes);
  return notes;
}

}  // namespace gridlock
