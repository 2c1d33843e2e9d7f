#include "gridlock/simulation/configuration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <utility>

#include "core/magnitude.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/core/saturating.hpp"
#include "gridlock/io/xyz.hpp"
#include "simulation/countable_time.hpp"
#include "simulation/memory.hpp"
#include "simulation/setup_notes.hpp"

namespace gridlock {

namespace {

constexpr std::uint64_t default_steps = 10'000;

using IsGiven = std::function<bool(std::string_view)>;

Error contradiction(std::string key, std::string what) {
  return Error(
      {.what = std::move(what), .hint = "leave the setting out, or give the value of the file", .key = std::move(key)});
}

bool is_close(double a, double b) { return std::abs(a - b) <= 1e-9 * std::abs(b); }

/// A file brings its box; a box that was asked for besides must be the same.
void take_box(BoxSettings& settings, Box const& box, IsGiven const& is_given) {
  bool const asks_for_size = is_given("box.side") || is_given("box.width") || is_given("box.height");
  double const width = settings.width.value_or(settings.side);
  double const height = settings.height.value_or(settings.side);
  if (asks_for_size && !(is_close(width, box.width()) && is_close(height, box.height()))) {
    throw contradiction("box", fmt::format("the box of the start file is {} × {}, not {} × {}", box.width(),
                                           box.height(), width, height));
  }
  if (is_given("box.edge") && settings.edge != box.edge()) {
    throw contradiction("box.edge",
                        fmt::format("the start file has {} edges", box.is_periodic() ? "periodic" : "wall"));
  }
  settings = {.edge = box.edge(), .side = box.width()};
  if (box.width() != box.height()) {
    settings.width = box.width();
    settings.height = box.height();
  }
}

/// Whether every disk of a file has the radius asked for, as one of the kinds asked for.
bool are_radii_as_asked(Disks const& disks, double radius, std::vector<SpeciesSettings> const& species) {
  return std::ranges::all_of(disks.column<Radius>(), [&](double r) {
    if (species.empty()) return is_close(radius, r);
    return std::ranges::any_of(species,
                               [&](SpeciesSettings const& kind) { return is_close(radius * kind.size_ratio, r); });
  });
}

/// Gives the disks of a file without radii the size asked for; otherwise checks that the size asked for is the file's.
void take_sizes(State& state, bool has_radii, DisksSettings& settings) {
  auto const radii = state.disks.column<Radius>();
  double const count = static_cast<double>(state.disks.size());
  if (settings.count && *settings.count != state.disks.size()) {
    throw contradiction("disks.count",
                        fmt::format("the start file holds {} disks, not {}", state.disks.size(), *settings.count));
  }
  if (!has_radii) {
    if (!settings.radius && !settings.packing_fraction) {
      throw Error({.what = "the start file has no radii, and none are given",
                   .hint = "give disks.radius or disks.packing_fraction, or add a column radius:R:1 to the file",
                   .key = "disks.file"});
    }
    if (!settings.species.empty()) {
      throw Error({.what = "the start file has no radii, and species are dealt to lattice and random starts only",
                   .hint = "add columns radius:R:1 and masses:R:1 to the file, or leave disks.species out",
                   .key = "disks.species"});
    }
    double const radius = settings.radius.value_or(
        std::sqrt(settings.packing_fraction.value_or(0.0) * state.box.area() / (std::numbers::pi * count)));
    for (double& r : radii) r = radius;
  }
  if (settings.radius && !are_radii_as_asked(state.disks, *settings.radius, settings.species)) {
    auto const [smallest, largest] = radius_range(state.disks);
    throw contradiction("disks.radius", fmt::format("the start file has radii from {:.9g} to {:.9g}, not {:.9g}",
                                                    smallest, largest, *settings.radius));
  }
  double const packing_fraction = covered_area(state.disks) / state.box.area();
  if (settings.packing_fraction && !is_close(*settings.packing_fraction, packing_fraction)) {
    throw contradiction("disks.packing_fraction", fmt::format("the start file has packing fraction {:.9g}, not {:.9g}",
                                                              packing_fraction, *settings.packing_fraction));
  }
  settings.count = state.disks.size();
}

State start_from_file(Configuration& configuration, std::filesystem::path const& path, IsGiven const& is_given) {
  XyzFrame frame = read_xyz(path);
  take_box(configuration.box, frame.state.box, is_given);
  take_sizes(frame.state, frame.has_radii, configuration.disks);
  configuration.disks.start = StartKind::file;
  frame.state.seed = configuration.run.seed;
  if (!frame.has_velocities || configuration.velocities.redraw) {
    draw_velocities(frame.state, configuration.velocities);
  }
  return std::move(frame.state);
}

/// Fills in what was left out, so that the configuration says what was run.
void resolve(Configuration& configuration) {
  if (!configuration.engine.speed) configuration.engine.speed = configuration.velocities.max;
  RunSettings& run = configuration.run;
  if (!run.steps && !run.time && !run.collisions_per_disk) run.steps = default_steps;
  if (configuration.disks.start == StartKind::file) return;
  if (!configuration.disks.count) configuration.disks.count = 841;
  if (!configuration.disks.radius && !configuration.disks.packing_fraction) configuration.disks.packing_fraction = 0.5;
}

/// A speed near 0 makes a time step that cannot be computed with.
void require_bounded_step(EngineSettings const& engine, State const& state) {
  double const duration = step_duration(engine, state);
  if (engine.kind == "exact" || duration <= most_magnitude) return;
  throw Error({.what = fmt::format("engine.speed = {} makes a time step of {:.3g}, too long to compute with",
                                   engine.speed.value_or(1.0), duration),
               .hint = "use a speed near that of the disks, or 0 for a speed of 1",
               .key = "engine.speed"});
}

/// A run that starts so late that its clock cannot count on would never end, or end at once.
void require_clock(Setup const& setup, EngineSettings const& engine) {
  // As many as any run can have from there; the counts of steps end at 2⁶⁴ − 1.
  constexpr std::uint64_t most_steps = never_reached / 2;
  Clock const& clock = setup.state.clock;
  auto const refuse = [&](std::string what, std::string hint) {
    throw Error({.what = setup.start_file.empty() ? what : fmt::format("{}: {}", setup.start_file.string(), what),
                 .hint = std::move(hint),
                 .key = "disks.file"});
  };
  if (clock.step > most_steps) {
    refuse(fmt::format("step {} is too late for a start: the counts of a run end at {}", clock.step, never_reached),
           "set step in its second line to a smaller number, such as 0");
  }
  double const duration = step_duration(engine, setup.state);
  if (can_count(clock.time, duration)) return;
  refuse(fmt::format("at time {:.6g} a clock cannot count steps of {:.6g}: numbers of that size are {:.3g} apart",
                     clock.time, duration, spacing_at(clock.time)),
         "set Time in its second line to a smaller number, such as 0");
}

/// Makes the engine only to see whether it takes the state, so that `check` too refuses what it refuses. What counts
/// as valid is the engine's to say: the exact one allows for the rounding of disks it left in contact.
void require_engine(Setup const& setup, EngineSettings const& settings) {
  try {
    static_cast<void>(make_engine(settings, setup.state));
  } catch (Error const& error) {
    if (setup.start_file.empty()) throw;
    std::vector<Problem> problems = error.problems();
    for (Problem& problem : problems) {
      if (problem.key != "disks") continue;  // the key of what is wrong with the state itself
      problem.what = fmt::format("{}: {}", setup.start_file.string(), problem.what);
      problem.key = "disks.file";
    }
    throw Error(std::move(problems));
  }
}

/// Collisions soon give some disk twice v_max (one turn in 3000 in equilibrium, exp(−8)): a sub-step in which it covers a
/// contact distance could jump over a disk. The rare disk that is faster still is caught in its turn.
void require_short_substeps(EngineSettings const& engine, State const& state) {
  if (engine.kind == "exact") return;
  double const substep = step_duration(engine, state) / static_cast<double>(engine.substeps);
  double const displacement = 2.0 * engine.speed.value_or(1.0) * substep;
  double const contact = 2.0 * radius_range(state.disks).smallest;
  if (displacement < contact) return;
  throw Error(
      {.what = fmt::format("a disk at twice the speed {} would cover {:.6g} in one sub-step and could jump over "
                           "a disk of diameter {:.6g}",
                           engine.speed.value_or(1.0), displacement, contact),
       .hint = "use a smaller engine.time_step or more engine.substeps",
       .key = "engine.time_step"});
}

void require_trajectory(TrajectorySettings const& settings, State const& state) {
  static_cast<void>(FrameSchedule(settings, 1.0));
  static_cast<void>(with_columns(frame_of(State{.box = state.box}), settings.columns));
}

/// Whether two disks keep apart for as long as they meet no other: at a distance along x or y that no motion changes.
bool keep_apart(State const& state, std::size_t i, std::size_t j) {
  double const contact = state.disks.column<Radius>()[i] + state.disks.column<Radius>()[j];
  Vector const d = state.box.displacement(position(state.disks, i), position(state.disks, j));
  Vector const v = velocity(state.disks, i);
  Vector const w = velocity(state.disks, j);
  // A wall turns back one of two disks before the other.
  bool const is_fixed_in_x = v.x == w.x && (state.box.is_periodic() || v.x == 0.0);
  bool const is_fixed_in_y = v.y == w.y && (state.box.is_periodic() || v.y == 0.0);
  return (is_fixed_in_x && is_fixed_in_y) || (is_fixed_in_x && std::abs(d.x) >= contact) ||
         (is_fixed_in_y && std::abs(d.y) >= contact);
}

/// Whether any two disks can ever meet, as far as that is plain to see.
bool can_collide(State const& state) {
  constexpr std::size_t most_disks_for_all_pairs = 2000;
  if (state.disks.size() < 2 || !(kinetic_energy(state.disks) > 0.0)) return false;
  if (state.disks.size() > most_disks_for_all_pairs) return true;
  for (std::size_t i = 0; i < state.disks.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (!keep_apart(state, i, j)) return true;
    }
  }
  return false;
}

/// Counts of collisions end before 2⁶⁴.
constexpr double most_collisions = 9e18;

double pair_collisions(double collisions_per_disk, State const& state) {
  return collisions_per_disk * static_cast<double>(state.disks.size()) / 2.0;
}

/// Refuses a run that cannot come to its end: its time or collisions are beyond counting, or its disks never collide.
void require_end(Configuration const& configuration, State const& state) {
  RunSettings const& run = configuration.run;
  if (run.collisions_per_disk && pair_collisions(*run.collisions_per_disk, state) >= most_collisions) {
    throw Error({.what = fmt::format("no run reaches {:.3g} collisions per disk", *run.collisions_per_disk),
                 .hint = "use a smaller number",
                 .key = "run.collisions_per_disk"});
  }
  if (run.time) require_countable_end(state.clock.time + *run.time, step_duration(configuration.engine, state));
  bool const has_end = run.steps || run.time;
  if (has_end || can_collide(state)) return;
  throw Error({.what = "disks that never collide cannot reach run.collisions_per_disk",
               .hint = "give run.steps or run.time as well",
               .key = "run.collisions_per_disk"});
}

std::string names_of(ModelKinds const& kinds) {
  std::string names;
  for (auto const& kind : kinds.all()) names += fmt::format("{}\"{}\"", names.empty() ? "" : ", ", kind->name());
  return names;
}

/// A table of something that is not run would be left out without a word.
void refuse_tables_of_others(Configuration const& configuration, IsGiven const& is_given) {
  std::string const& model = configuration.model.kind;
  std::vector<Problem> problems;
  for (auto const& other : configuration.models.all()) {
    if (other->name() == model || !is_given(other->name())) continue;
    std::string const run = model.empty() ? "the disks are run" : fmt::format("the model \"{}\" is run", model);
    problems.push_back({.what = fmt::format("[{}] means nothing here: {}", other->name(), run),
                        .hint = fmt::format("set model.kind = \"{}\", or take the table out", other->name()),
                        .key = std::string(other->name())});
  }
  for (char const* table : {"disks", "velocities"}) {
    if (model.empty() || !is_given(table)) continue;
    problems.push_back(
        {.what = fmt::format("[{}] means nothing to the model \"{}\"", table, model),
         .hint = fmt::format("its agents are set in [{}]; gridlock explain {} lists what there is", model, model),
         .key = table});
  }
  if (!model.empty() && configuration.run.collisions_per_disk) {
    problems.push_back({.what = "the length of a run of a model cannot be given in collisions",
                        .hint = "give run.steps or run.time",
                        .key = "run.collisions_per_disk"});
  }
  if (!problems.empty()) throw Error(std::move(problems));
}

/// What is wrong with a model that this program does not have; nothing where it has it.
std::optional<Problem> unknown_model(Configuration const& configuration) {
  std::string const& kind = configuration.model.kind;
  if (!configuration.is_of_model() || configuration.models.find(kind) != nullptr) return std::nullopt;
  return Problem{.what = fmt::format("there is no model \"{}\" in this program", kind),
                 .hint = fmt::format("its models are {}; a model of one's own runs in one's own program, see "
                                     "docs/getting_started/own_model.md",
                                     names_of(configuration.models)),
                 .key = "model.kind"};
}

/// Whether a problem is about a table of that name or something in it.
bool is_about_table(Problem const& problem, std::string const& table) {
  return problem.key == table || problem.key.starts_with(table + ".");
}

/// Whether a start that tries so many random places is to be made; one that is not is noted.
bool takes_start(double attempts, std::string const& key, OnSlowStart const& on_slow_start,
                 std::vector<SetupNote>& notes) {
  constexpr double many_attempts = 3e7;
  constexpr double seconds_per_attempt = 1.5e-7;
  double const seconds = attempts * seconds_per_attempt;
  if (attempts < many_attempts || on_slow_start(seconds)) return true;
  notes.push_back({.kind = NoteKind::start_not_tried,
                   .key = key,
                   .text = fmt::format("the random start was not tried, since that takes about {:.0f} s; "
                                       "gridlock run will tell whether all find room",
                                       seconds)});
  return false;
}

/// Fewer give up within a few seconds.
constexpr std::uint64_t many_agents = 25'000;

/// A model brings its own agents and settings; of the disks' tables only engine.threads means anything to it.
Setup set_up_model(Configuration configuration, OnSlowStart const& on_slow_start) {
  ModelKind const* const kind = configuration.models.find(configuration.model.kind);
  if (!configuration.run.steps && !configuration.run.time) configuration.run.steps = default_steps;
  Setup setup;
  setup.state = {.box = make_box(configuration.box), .seed = configuration.run.seed};
  kind->check_settings(setup.state.box);
  require_memory_for_agents(static_cast<double>(kind->agents_at_start()), static_cast<double>(kind->bytes_per_agent()),
                            std::string(kind->name()) + ".count");
  require_memory(configuration);
  std::uint64_t const seed = configuration.run.seed;
  bool const may_be_slow = on_slow_start && kind->agents_at_start() >= many_agents;
  double const attempts = may_be_slow ? kind->attempts_at_start(setup.state.box, seed) : 0.0;
  if (takes_start(attempts, "model.kind", on_slow_start, setup.notes)) {
    for (std::string const& text : kind->check_start(setup.state.box, seed)) {
      setup.notes.push_back({.kind = NoteKind::misleading_rule, .key = "model.kind", .text = text});
    }
  }
  setup.configuration = std::move(configuration);
  return setup;
}

/// The start, or another one in its place with a note, where it is slow and not to be made.
void make_start(Setup& setup, Configuration const& configuration, OnSlowStart const& on_slow_start) {
  Box const box = make_box(configuration.box);
  std::uint64_t const seed = configuration.run.seed;
  DisksSettings disks = configuration.disks;
  bool const may_be_slow = on_slow_start && disks.count.value_or(0) >= many_agents;
  double const attempts = may_be_slow ? expected_attempts(box, disks, seed) : 0.0;
  if (!takes_start(attempts, "disks.start", on_slow_start, setup.notes)) {
    disks.start = StartKind::triangular;
    try {
      setup.state = make_start(box, disks, seed);
      return;
    } catch (Error const&) {
      // Very unequal disks may fit at random and on no lattice of the largest: then there is nothing else to check.
      setup.notes.pop_back();
    }
  }
  setup.state = make_start(box, configuration.disks, seed);
}

Setup set_up(Configuration configuration, std::filesystem::path const& directory, IsGiven const& is_given,
             OnSlowStart const& on_slow_start) {
  if (configuration.is_of_model()) {
    if (auto const problem = unknown_model(configuration)) throw Error(*problem);
    refuse_tables_of_others(configuration, is_given);
    Setup setup = set_up_model(std::move(configuration), on_slow_start);
    std::ranges::move(unused_settings(setup.configuration, is_given), std::back_inserter(setup.notes));
    std::ranges::move(notes_of(setup), std::back_inserter(setup.notes));
    return setup;
  }
  refuse_tables_of_others(configuration, is_given);
  // What is run is decided: the settings of models would only fill its resolved configuration.
  configuration.models.clear();
  require_memory(configuration);
  Setup setup;
  setup.notes = unused_settings(configuration, is_given);
  bool const is_from_file = configuration.disks.start == StartKind::file || !configuration.disks.file.empty();
  if (is_from_file && !configuration.disks.file.empty()) {
    setup.start_file = directory / configuration.disks.file;
    setup.state = start_from_file(configuration, setup.start_file, is_given);
  } else {
    make_start(setup, configuration, on_slow_start);
    draw_velocities(setup.state, configuration.velocities);
  }
  if (configuration.engine.speed) require_bounded_step(configuration.engine, setup.state);
  resolve(configuration);
  require_clock(setup, configuration.engine);
  require_end(configuration, setup.state);
  require_engine(setup, configuration.engine);
  require_short_substeps(configuration.engine, setup.state);
  require_trajectory(configuration.trajectory, setup.state);
  setup.configuration = std::move(configuration);
  std::ranges::move(notes_of(setup), std::back_inserter(setup.notes));
  return setup;
}

}  // namespace

void describe(RunSettings& settings, SettingVisitor& visitor) {
  visitor.visit({.key = "steps",
                 .documentation = "Length of the run in time steps.",
                 .default_note = "10000, where run.time and run.collisions_per_disk are left out too"},
                settings.steps);
  visitor.visit({.key = "time",
                 .unit = "time",
                 .documentation = "Length of the run in physical time; the run ends at whichever length comes first.",
                 .least = 0.0,
                 .default_note = "no limit"},
                settings.time);
  visitor.visit({.key = "collisions_per_disk",
                 .documentation = "Length of the run in collisions every disk has had on average.",
                 .least = 0.0,
                 .default_note = "no limit"},
                settings.collisions_per_disk);
  visitor.visit({.key = "seed", .documentation = "Every random number of the run follows from it."}, settings.seed);
  visitor.visit(
      {.key = "final_state",
       .documentation = "Whether the last state is written as final.xyz, which takes about 120 bytes a disk."},
      settings.final_state);
}

void describe(CheckpointSettings& settings, SettingVisitor& visitor) {
  visitor.visit(
      {.key = "every_seconds",
       .unit = "s of real time",
       .documentation = "How often a run saves itself, so that gridlock resume can go on from there; 0 for never.",
       .least = 0.0},
      settings.every_seconds);
  visitor.visit({.key = "every_steps",
                 .documentation = "Besides, a checkpoint whenever about this many steps have passed; 0 for none."},
                settings.every_steps);
  visitor.visit(
      {.key = "keep_last",
       .documentation = "Whether a finished run keeps its last checkpoint, with which gridlock resume --steps "
                        "lengthens it."},
      settings.keep_last);
}

void describe(ModelSettings& settings, SettingVisitor& visitor) {
  visitor.visit({.key = "kind",
                 .documentation = "The model to run, such as \"flocking\"; its settings stand in a table of that name.",
                 .default_note = "none: hard disks"},
                settings.kind);
  visitor.visit({.key = "verify_every",
                 .documentation = "Steps between two in which every neighbour search is compared with a look at all "
                                  "agents; 0 for none."},
                settings.verify_every);
}

void describe(Configuration& configuration, SettingVisitor& visitor) {
  auto const table = [&](std::string_view name, std::string_view documentation, auto& settings) {
    visitor.enter(name, documentation);
    describe(settings, visitor);
    visitor.leave();
  };
  bool const is_of_model = configuration.is_of_model();
  table("box", "The rectangle the agents live in.", configuration.box);
  if (!is_of_model) {
    table("disks", "How many disks, how large, and where they start.", configuration.disks);
    table("velocities", "How fast the disks are at the start.", configuration.velocities);
  }
  table("engine", is_of_model ? "Of a model only the threads." : "How the disks move.", configuration.engine);
  table("run", "How long the run lasts, and its seed.", configuration.run);
  table("observe", "What is measured, and how often.", configuration.observe);
  table("checkpoint", "When a run saves itself on the way.", configuration.checkpoint);
  table("trajectory", "Which moments of a run are kept in trajectory.h5.", configuration.trajectory);
  if (!configuration.models.all().empty()) {
    table("model", "Another model instead of the disks.", configuration.model);
  }
  for (auto const& kind : configuration.models.all()) {
    if (is_of_model && kind->name() != configuration.model.kind) continue;
    visitor.enter(kind->name(), kind->documentation());
    kind->describe(visitor);
    visitor.leave();
  }
}

Describe describing(Configuration& configuration) {
  return [&configuration](SettingVisitor& visitor) { describe(configuration, visitor); };
}

Configuration read_configuration(SettingsFile const& file) {
  Configuration configuration;
  try {
    file.read_into(describing(configuration));
  } catch (Error const& error) {
    auto const problem = unknown_model(configuration);
    if (!problem) throw;
    // Its table is unknown for that reason alone.
    std::vector<Problem> problems = file.locate(Error(*problem)).problems();
    std::ranges::copy_if(error.problems(), std::back_inserter(problems),
                         [&](Problem const& other) { return !is_about_table(other, configuration.model.kind); });
    throw Error(std::move(problems));
  }
  return configuration;
}

Setup set_up(SettingsFile const& file) { return set_up(file, OnSlowStart()); }

Setup set_up(SettingsFile const& file, OnSlowStart const& on_slow_start) {
  Configuration configuration = read_configuration(file);
  try {
    // A file named on the command line is meant from where the user stands, one named in the TOML file from there.
    auto const location = file.location("disks.file");
    bool const is_from_command_line = location && location->line == 0;
    return set_up(
        std::move(configuration), is_from_command_line ? "" : file.directory(),
        [&](std::string_view key) { return file.is_given(key); }, on_slow_start);
  } catch (Error const& error) {
    throw file.locate(error);
  }
}

Setup set_up(Configuration const& configuration) {
  return set_up(configuration, {}, [](std::string_view) { return false; }, {});
}

StopCondition stop_condition_of(Setup const& setup) {
  RunSettings const& run = setup.configuration.run;
  Clock const& clock = setup.state.clock;
  StopCondition stop_condition;
  if (run.steps) stop_condition.step = saturating_sum(clock.step, *run.steps);
  if (run.time) stop_condition.time = clock.time + *run.time;
  if (run.collisions_per_disk) {
    double const pairs = pair_collisions(*run.collisions_per_disk, setup.state);
    if (pairs < most_collisions) stop_condition.pair_collisions = static_cast<std::uint64_t>(std::ceil(pairs));
  }
  return stop_condition;
}

}  // namespace gridlock
