#include "simulation/disks_kind.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "core/disks_overview.hpp"
#include "core/magnitude.hpp"
#include "core/saturating.hpp"
#include "engine/stepped.hpp"
#include "gridlock/core/detail/time_step_rule.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/grid/validate.hpp"
#include "gridlock/simulation/world_simulation.hpp"
#include "simulation/countable_time.hpp"
#include "simulation/disks_of_rank.hpp"
#include "simulation/divided_simulation.hpp"
#include "simulation/expected_work.hpp"
#include "simulation/patient_engine.hpp"
#include "simulation/protocol_simulation.hpp"
#include "simulation/slow_start.hpp"
#include "simulation/start_file.hpp"

namespace gridlock {

namespace {

/// Fills in what was left out, so that the configuration says what was run.
void resolve(Configuration& configuration) {
  if (!configuration.engine.speed) configuration.engine.speed = configuration.velocities.max;
  if (configuration.disks.start == StartKind::file) return;
  if (!configuration.disks.count) configuration.disks.count = 841;
  if (!configuration.disks.radius && !configuration.disks.packing_fraction) configuration.disks.packing_fraction = 0.5;
}

/// A speed near 0 makes a time step that cannot be computed with.
void require_bounded_step(EngineSettings const& engine, DisksOverview const& disks) {
  double const duration = step_duration(engine, disks.radii.smallest);
  if (!engine_record(engine.kind).has_time_step || duration <= max_magnitude) return;
  throw Error({.what = fmt::format("engine.speed = {} makes a time step of {:.3g}, too long to compute with",
                                   engine.speed.value_or(1.0), duration),
               .hint = "use a speed near that of the disks, or 0 for a speed of 1",
               .key = "engine.speed"});
}

/// A run that starts so late that its clock cannot count on would never end, or end at once.
void require_clock(Clock const& clock, DisksOverview const& disks, std::filesystem::path const& start_file,
                   EngineSettings const& engine) {
  // As many as any run can have from there; the counts of steps end at 2⁶⁴ − 1.
  constexpr std::uint64_t max_steps = never_reached / 2;
  auto const refuse = [&](std::string what, std::string hint) {
    throw Error({.what = start_file.empty() ? what : fmt::format("{}: {}", start_file.string(), what),
                 .hint = std::move(hint),
                 .key = "disks.file"});
  };
  if (clock.step > max_steps) {
    refuse(fmt::format("step {} is too late for a start: the counts of a run end at {}", clock.step, never_reached),
           "set step in its second line to a smaller number, such as 0");
  }
  double const duration = step_duration(engine, disks.radii.smallest);
  if (can_count(clock.time, duration)) return;
  refuse(fmt::format("at time {:.6g} a clock cannot count steps of {:.6g}: numbers of that size are {:.3g} apart",
                     clock.time, duration, spacing_at(clock.time)),
         "set Time in its second line to a smaller number, such as 0");
}

/// Said once and of the setting, not pair by pair.
void require_hard_start(DisksSettings const& disks, State const& state) {
  if (disks.start != StartKind::uniform || !(largest_overlap(state) > 0.0)) return;
  throw Error({.what = "disks at uniform points overlap, and the run is one of hard disks",
               .hint = "begin a [[protocol]] with stage = \"quench\", or use disks.start = \"random\"",
               .key = "disks.start"});
}

/// Calls `act`; what is wrong with a state from a file is blamed on the file.
template <class Act>
auto blaming_file(std::filesystem::path const& start_file, Act act) {
  try {
    return act();
  } catch (Error const& error) {
    if (start_file.empty()) throw;
    std::vector<Problem> problems = error.problems();
    for (Problem& problem : problems) {
      if (problem.key != "disks") continue;  // the key of what is wrong with the state itself
      problem.what = fmt::format("{}: {}", start_file.string(), problem.what);
      problem.key = "disks.file";
    }
    throw Error(std::move(problems));
  }
}

/// The engine. What counts as valid is the engine's to say: the exact one allows for the rounding of disks it left in
/// contact.
std::unique_ptr<Engine> engine_for(State const& state, std::filesystem::path const& start_file,
                                   EngineSettings const& settings) {
  return blaming_file(start_file, [&] { return make_engine(settings, state); });
}

/// Collisions soon give some disk twice v_max (one turn in 3000 in equilibrium, exp(−8)): a sub-step in which it covers
/// a contact distance could jump over a disk. The rare disk that is faster still is caught in its turn.
void require_short_substeps(EngineSettings const& engine, DisksOverview const& disks) {
  if (!engine_record(engine.kind).has_time_step) return;
  double const substep = step_duration(engine, disks.radii.smallest) / static_cast<double>(engine.substeps);
  double const displacement = 2.0 * engine.speed.value_or(1.0) * substep;
  double const contact = 2.0 * disks.radii.smallest;
  if (displacement < contact) return;
  throw Error(
      {.what = fmt::format("a disk at twice the speed {} would cover {:.6g} in one sub-step and could jump over "
                           "a disk of diameter {:.6g}",
                           engine.speed.value_or(1.0), displacement, contact),
       .hint = "use a smaller engine.time_step or more engine.substeps",
       .key = "engine.time_step"});
}

/// Whether two disks keep apart for as long as they meet no other: at a distance along x or y that no motion changes.
bool keep_apart(State const& state, std::size_t i, std::size_t j) {
  double const contact = state.agents.column<Radius>()[i] + state.agents.column<Radius>()[j];
  Vector const d = state.box.displacement(position(state.agents, i), position(state.agents, j));
  Vector const v = velocity(state.agents, i);
  Vector const w = velocity(state.agents, j);
  // A wall turns back one of two disks before the other.
  bool const is_fixed_in_x = v.x == w.x && (state.box.is_periodic() || v.x == 0.0);
  bool const is_fixed_in_y = v.y == w.y && (state.box.is_periodic() || v.y == 0.0);
  return (is_fixed_in_x && is_fixed_in_y) || (is_fixed_in_x && std::abs(d.x) >= contact) ||
         (is_fixed_in_y && std::abs(d.y) >= contact);
}

/// Beyond that nobody looks at all pairs.
constexpr std::size_t max_disks_for_all_pairs = 2000;

/// Whether any two disks can ever meet, as far as that is plain to see.
bool can_collide(State const& state) {
  if (state.agents.size() < 2 || !(kinetic_energy(state.agents) > 0.0)) return false;
  if (state.agents.size() > max_disks_for_all_pairs) return true;
  for (std::size_t i = 0; i < state.agents.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (!keep_apart(state, i, j)) return true;
    }
  }
  return false;
}

[[noreturn]] void refuse_rest() {
  throw Error({.what = "disks that never collide cannot reach run.collisions_per_disk",
               .hint = "give run.steps or run.time as well",
               .key = "run.collisions_per_disk"});
}

/// Refuses a run whose disks never collide, where nothing else ends it.
void require_collisions(RunSettings const& run, State const& state) {
  if (!run.steps && !run.time && !can_collide(state)) refuse_rest();
}

/// Where the engine has a time step and that is known to mislead.
std::optional<Event> misleading_rule(Box const& box, DisksOverview const& disks, EngineRecord const& engine) {
  if (!engine.has_time_step) return std::nullopt;
  TimeStepCaveats const caveats = time_step_caveats(box, disks.covered_area);
  if (!caveats.any()) return std::nullopt;
  Event event{
      .kind = EventKind::misleading_rule, .key = "engine.kind", .values = {{"engine", std::string(engine.name)}}};
  if (caveats.centre_drifts) event.values.emplace_back("centre_drifts", std::uint64_t{1});
  if (caveats.too_dense) {
    event.values.emplace_back("packing_fraction", *caveats.too_dense);
    event.values.emplace_back("largest_packing_fraction", TimeStepCaveats::largest_packing_fraction);
  }
  return event;
}

std::optional<Event> nothing_moves(DisksOverview const& disks, VelocitySettings const& velocities) {
  if (disks.largest_speed > 0.0) return std::nullopt;
  return Event{.kind = EventKind::nothing_moves, .key = velocities.max > 0.0 ? "disks.file" : "velocities.max"};
}

/// In equilibrium one disk in 10¹³ is four times as fast as the speed that an engine has its time step from.
std::optional<Event> fast_on_ranks(Communicator const& ranks, EngineSettings const& engine,
                                   DisksOverview const& disks) {
  double const speed = engine.speed.value_or(1.0);
  if (ranks.count() == 1 || !(speed > 0.0) || !(disks.largest_speed > 4.0 * speed)) return std::nullopt;
  return Event{.kind = EventKind::fast_on_ranks,
               .key = "engine.speed",
               .values = {{"ratio", disks.largest_speed / speed}, {"speed", speed}}};
}

/// Stages that two settings may end.
std::vector<Event> notes_on_ends(std::vector<StageSettings> const& stages) {
  std::vector<Event> notes;
  for (std::size_t k = 0; k < stages.size(); ++k) {
    StageSettings const& stage = stages[k];
    char const* ends = nullptr;
    if (stage.until_packing_fraction && stage.until_pressure) ends = "until_packing_fraction and until_pressure";
    if (stage.until_time && stage.collisions_per_disk) ends = "until_time and collisions_per_disk";
    if (ends == nullptr) continue;
    notes.push_back({.kind = EventKind::stage_with_two_ends,
                     .key = fmt::format("protocol[{}]", k),
                     .values = {{"stage", static_cast<std::uint64_t>(k + 1)},
                                {"name", stage.kind},
                                {"ends", std::string(ends)}}});
  }
  return notes;
}

void require_no_overlaps_in_run(Configuration const& configuration) {
  auto const& stages = configuration.protocol;
  if (stages.empty() || !leaves_overlaps(stages.back().kind) || !takes_steps(configuration)) return;
  throw Error(
      {.what = fmt::format("the run is one of hard disks, and the last stage of the protocol, \"{}\", leaves overlaps",
                           stages.back().kind),
       .hint = "add a stage \"separate\" at the end, or give [run] no length",
       .key = fmt::format("protocol[{}]", stages.size() - 1)});
}

/// Moves nothing and takes any disks: for what a protocol leaves where no run follows.
class RestingEngine final : public Engine {
 public:
  explicit RestingEngine(double duration) : duration_(duration) {}

  void advance(State& /*state*/, Counters& /*counters*/, StopCondition const& /*stop_condition*/) override {}
  [[nodiscard]] double time_step() const override { return duration_; }
  void require_valid(State const& /*state*/) const override {}

 private:
  double duration_;
};

class DisksKind final : public ModelKind {
 public:
  [[nodiscard]] std::unique_ptr<ModelKind> copy() const override { return std::make_unique<DisksKind>(*this); }
  [[nodiscard]] std::string_view name() const override { return "disks"; }
  [[nodiscard]] std::string_view documentation() const override { return "Hard disks."; }
  [[nodiscard]] std::string_view agents_name() const override { return "disks"; }
  [[nodiscard]] std::string title(Configuration const& configuration) const override {
    std::size_t const stages = configuration.protocol.size();
    std::string protocol = fmt::format("protocol of {} stage{}", stages, stages == 1 ? "" : "s");
    if (!takes_steps(configuration)) return protocol;
    return fmt::format("{}engine {}", stages == 0 ? "" : protocol + ", then ", configuration.engine.kind);
  }
  [[nodiscard]] std::vector<std::string> value_names(std::string_view /*column*/) const override { return {}; }

  [[nodiscard]] std::vector<SettingTable> tables(Configuration& configuration) override {
    return {{"disks", "How many disks, how large, and where they start.",
             [&](SettingVisitor& visitor) { describe(configuration.disks, visitor); }},
            {"velocities", "How fast the disks are at the start.",
             [&](SettingVisitor& visitor) { describe(configuration.velocities, visitor); }},
            {"engine", "How the disks move; of other models the threads.",
             [&](SettingVisitor& visitor) { describe(configuration.engine, visitor); }},
            {"soft", "How disks repel each other in the stages quench, compress and decompress of a protocol.",
             [&](SettingVisitor& visitor) { describe(configuration.soft, visitor); }}};
  }
  [[nodiscard]] std::string unused_because_of(Configuration const& configuration, std::string_view key) const override {
    constexpr std::string_view table = "engine.";
    if (key == "model.verify_every") return "model.kind = \"disks\"";
    if (key == "disks.start" && !configuration.disks.file.empty() && configuration.disks.start != StartKind::file) {
      return "disks.file";
    }
    if (key.starts_with("soft.") && configuration.protocol.empty()) return "no [[protocol]]";
    if (!key.starts_with(table)) return "";
    EngineSettings const& engine = configuration.engine;
    std::string_view const decides = engine_record(engine.kind).unused_because_of(engine, key.substr(table.size()));
    if (decides.empty()) return "";
    std::string const name = fmt::format("engine.{}", decides);
    Configuration described = configuration;
    return fmt::format("{} = {}", name, value_in_toml(describing(described), name));
  }
  [[nodiscard]] bool uses_threads(Configuration const& configuration) const override {
    return engine_record(configuration.engine.kind).uses_threads;
  }
  [[nodiscard]] std::optional<Problem> not_shared_by_ranks(Configuration const& configuration) const override {
    if (!configuration.protocol.empty()) return Problem{.what = "a run with a [[protocol]]", .key = "protocol"};
    if (engine_record(configuration.engine.kind).uses_ranks) return {};
    return Problem{.what = fmt::format("the engine \"{}\"", configuration.engine.kind), .key = "engine.kind"};
  }
  [[nodiscard]] bool is_divided_among_ranks(Configuration const& configuration) const override {
    return !not_shared_by_ranks(configuration);
  }
  [[nodiscard]] bool ends_within_steps(Configuration const& configuration) const override {
    return !engine_record(configuration.engine.kind).has_time_step;
  }
  [[nodiscard]] bool counts_collisions() const override { return true; }
  [[nodiscard]] std::vector<std::pair<std::string, std::string>> choices(
      Configuration const& configuration) const override {
    if (!takes_steps(configuration)) return {};
    return {{"engine", configuration.engine.kind}};
  }

  [[nodiscard]] std::vector<MemoryDemand> memory(Configuration const& configuration) const override {
    auto const disks = static_cast<double>(configuration.disks.count.value_or(0));
    auto const cells = static_cast<double>(configuration.engine.cells.value_or(0));
    double const bytes_per_cell = engine_record(configuration.engine.kind).bytes_per_cell;
    return {
        {fmt::format("{:.0f} disks", disks), "disks.count", bytes_per_disk(configuration) * disks, "use fewer disks"},
        {fmt::format("a grid of {0:.0f} × {0:.0f} cells", cells), "engine.cells", bytes_per_cell * cells * cells,
         "leave engine.cells out, or use fewer"}};
  }
  [[nodiscard]] double expected_bytes(Configuration const& configuration, std::size_t /*agents*/) const override {
    double bytes = 0.0;
    for (MemoryDemand const& demand : memory(configuration)) bytes += demand.bytes;
    return bytes;
  }

  [[nodiscard]] std::unique_ptr<AgentsOfRank> agents_of_rank(Communicator& ranks,
                                                             Configuration const& configuration) const override;
  void check(Configuration const& configuration) const override {
    static_cast<void>(engine_record(configuration.engine.kind));
    require_valid(configuration.protocol);
    require_no_overlaps_in_run(configuration);
  }
  void build(Setup& setup, SetupOptions const& options) const override;

 private:
  static double bytes_per_disk(Configuration const& configuration) {
    EngineRecord const& engine = engine_record(configuration.engine.kind);
    CheckpointSettings const& checkpoint = configuration.checkpoint;
    bool const has_checkpoints = checkpoint.every_seconds > 0.0 || checkpoint.every_steps > 0 || checkpoint.keep_last;
    bool const has_threads = threads_of(configuration, std::nullopt) > 1;
    return engine.bytes_per_disk + (has_threads ? engine.bytes_per_disk_of_threads : 0.0) +
           (has_checkpoints ? engine.bytes_per_disk_of_checkpoint : 0.0);
  }
};

/// Whether the start that is asked for is made, or another one in its place, with a note, because it is slow.
bool makes_start_asked_for(Setup& setup, SetupOptions const& options) {
  Configuration const& configuration = setup.configuration;
  DisksSettings const& disks = configuration.disks;
  bool const may_be_slow = options.on_slow_start && disks.count.value_or(0) >= many_agents;
  double const attempts =
      may_be_slow ? expected_attempts(make_box(configuration.box), disks, configuration.run.seed) : 0.0;
  return makes_start(attempts, "disks.start", options, setup.notes);
}

/// Disks of any sizes grow up to here, from ten disks on; mixtures of two sizes jam from about 0.84 on.
constexpr double reached_by_growth = 0.84;

/// A start of the settings, whose refusal names the way to densities at which disks find no room.
State make_start_or_refer_to_growth(Box const& box, DisksSettings const& disks, std::uint64_t seed) {
  try {
    return make_start(box, disks, seed);
  } catch (Error const& error) {
    std::vector<Problem> problems = error.problems();
    bool const can_grow = disks.packing_fraction.value_or(0.5) <= reached_by_growth && count_of(disks) >= 10;
    for (Problem& problem : problems) {
      if (!can_grow || problem.key != "disks.packing_fraction") continue;
      problem.hint += ", or a less dense start and a [[protocol]] with stage = \"grow\", which reaches it";
    }
    throw Error(std::move(problems));
  }
}

/// The start, or a lattice in its place.
State random_or_lattice_start(Setup& setup, bool is_asked_for) {
  Configuration const& configuration = setup.configuration;
  Box const box = make_box(configuration.box);
  std::uint64_t const seed = configuration.run.seed;
  if (!is_asked_for) {
    DisksSettings disks = configuration.disks;
    disks.start = StartKind::triangular;
    try {
      return make_start(box, disks, seed);
    } catch (Error const&) {
      // Very unequal disks may fit at random and on no lattice of the largest: then there is nothing else to check.
      setup.notes.pop_back();
    }
  }
  return make_start_or_refer_to_growth(box, configuration.disks, seed);
}

/// Reads the head of the file that is asked for.
xyz::Reader open_start_file(Setup& setup, SetupOptions const& options) {
  DisksSettings const& disks = setup.configuration.disks;
  setup.start_file = options.directory / disks.file;
  xyz::FrameChoice choice{.frame = {}, .setting = "disks.frame"};
  // There is no frame of such a number as is cut here.
  constexpr std::uint64_t most = std::numeric_limits<std::int64_t>::max();
  if (disks.frame) choice.frame = static_cast<std::int64_t>(std::min(*disks.frame, most));
  return xyz::Reader(TextReader(setup.start_file), choice);
}

/// The start of a file of which the head has been read, with what is worth telling of it.
State read_noted_start(xyz::Reader& reader, Setup& setup, SetupOptions const& options) {
  State state = read_whole_start(reader, setup.configuration, options.is_given);
  std::ranges::move(notes_of_start(reader, setup.configuration.velocities), std::back_inserter(setup.notes));
  return state;
}

State made_start(Setup& setup, bool is_asked_for) {
  State state = random_or_lattice_start(setup, is_asked_for);
  draw_velocities(state, setup.configuration.velocities);
  return state;
}

State start_of(Setup& setup, SetupOptions const& options) {
  if (options.start) return *options.start;
  Configuration& configuration = setup.configuration;
  if (!configuration.disks.file.empty()) {
    xyz::Reader reader = open_start_file(setup, options);
    return read_noted_start(reader, setup, options);
  }
  return made_start(setup, makes_start_asked_for(setup, options));
}

/// The engine of a run, with a limit to waiting where only collisions end it.
std::unique_ptr<EngineFor<HardDisks>> patient(std::unique_ptr<Engine> engine, RunSettings const& run,
                                              State const& state) {
  if (run.steps || run.time) return engine;
  return std::make_unique<PatientEngine>(std::move(engine), patience_for(state));
}

/// A simulation that a protocol prepares. Its time step is in diameters of the start.
std::unique_ptr<Simulation> prepared_simulation(Configuration const& configuration, EngineSettings const& settings,
                                                State state) {
  double const duration = step_duration(settings, state);
  ProtocolSettings const protocol{.stages = configuration.protocol,
                                  .soft = configuration.soft,
                                  .time_step = settings.time_step,
                                  .threads = settings.threads};
  bool const is_hard_at_end = !leaves_overlaps(configuration.protocol.back().kind);
  auto const make = [=, run = configuration.run, observe = configuration.observe](State world, bool is_prepared) {
    EngineSettings engine = settings;
    engine.time_step *= duration / step_duration(settings, world);
    std::unique_ptr<EngineFor<HardDisks>> advancing = std::make_unique<RestingEngine>(duration);
    // Hard disks may be run on later, where this run has no length.
    if (is_prepared && is_hard_at_end) advancing = patient(make_engine(engine, world), run, world);
    auto simulation = std::make_unique<DiskSimulation>(std::move(advancing), std::move(world));
    simulation->observe(observe, {.halts_moves = engine_record(settings.kind).has_time_step});
    return simulation;
  };
  return std::make_unique<ProtocolSimulation>(protocol, std::move(state), make);
}

/// Where the rows of ranks come from; nothing where each makes its own.
struct StartOfRanks {
  std::optional<State> whole;       ///< where it is given or small, or pairs of all disks are looked at
  std::optional<xyz::Reader> file;  ///< of more disks
};

StartOfRanks start_of_ranks(Setup& setup, SetupOptions const& options) {
  Configuration& configuration = setup.configuration;
  DisksSettings& disks = configuration.disks;
  if (!options.start && !disks.file.empty()) {
    StartOfRanks start{.whole = std::nullopt, .file = open_start_file(setup, options)};
    disks.start = StartKind::file;
    if (start.file->count() > max_disks_for_all_pairs) return start;
    return {.whole = read_noted_start(*start.file, setup, options), .file = std::nullopt};
  }
  bool const is_small = disks.count.value_or(0) <= max_disks_for_all_pairs;
  if (options.start || disks.start == StartKind::uniform || is_small) {
    return {.whole = start_of(setup, options), .file = std::nullopt};
  }
  if (makes_start_asked_for(setup, options)) return {};
  return {.whole = made_start(setup, false), .file = std::nullopt};
}

/// Refuses settings of a run that do not fit these disks, and adds notes on what is worth telling.
void check_disks(Setup& setup, EngineSettings const& settings, Box const& box, Clock const& clock,
                 DisksOverview const& disks) {
  require_clock(clock, disks, setup.start_file, settings);
  require_short_substeps(settings, disks);
  if (auto note = misleading_rule(box, disks, engine_record(settings.kind))) setup.notes.push_back(*std::move(note));
  if (auto note = nothing_moves(disks, setup.configuration.velocities)) setup.notes.push_back(*std::move(note));
}

/// Ranks share the disks: none has all of them.
void build_divided(Setup& setup, SetupOptions const& options) {
  Configuration& configuration = setup.configuration;
  bool const has_speed = configuration.engine.speed.has_value();
  StartOfRanks start = start_of_ranks(setup, options);
  resolve(configuration);
  EngineSettings settings = configuration.engine;
  settings.threads = threads_of(configuration, options.threads, options.processes);
  settings.processes = options.processes;
  if (start.whole) {
    // Without disks there are no settings that others could read.
    require_disks(start.whole->agents.size());
    require_collisions(configuration.run, *start.whole);
    require_hard_start(configuration.disks, *start.whole);
  }
  DividedSimulation::announce(options.processes.communicator(), configuration);
  auto disks = blaming_file(setup.start_file, [&] {
    if (!start.file) {
      return std::make_unique<DisksOfRank>(options.processes.communicator(), configuration,
                                           start.whole ? &*start.whole : nullptr);
    }
    StartFile const file{.reader = *start.file, .take_summary = [&](StartFileSummary const& summary) {
                           take_summary(configuration, summary, options.is_given);
                         }};
    return std::make_unique<DisksOfRank>(options.processes.communicator(), configuration, nullptr, &file);
  });
  if (start.file)
    std::ranges::move(notes_of_start(*start.file, configuration.velocities), std::back_inserter(setup.notes));
  start = {};
  DisksOfRank& own = *disks;
  auto simulation = std::make_unique<DividedSimulation>(options.processes.communicator(), std::move(disks));
  if (has_speed) require_bounded_step(configuration.engine, own.all());
  check_disks(setup, settings, own.box(), own.clock(), own.all());
  if (auto note = fast_on_ranks(options.processes.communicator(), settings, own.all()))
    setup.notes.push_back(*std::move(note));
  if (!configuration.run.steps && !configuration.run.time && !(own.all().largest_speed > 0.0)) refuse_rest();
  blaming_file(setup.start_file, [&] { own.begin(settings, configuration.run); });
  simulation->observe(configuration.observe);
  setup.simulation = std::move(simulation);
}

std::unique_ptr<AgentsOfRank> DisksKind::agents_of_rank(Communicator& ranks, Configuration const& configuration) const {
  return std::make_unique<DisksOfRank>(ranks, configuration);
}

void DisksKind::build(Setup& setup, SetupOptions const& options) const {
  Configuration& configuration = setup.configuration;
  RunSettings const& run = configuration.run;
  if (options.processes.count() > 1 && is_divided_among_ranks(configuration)) {
    build_divided(setup, options);
    return;
  }
  State state = start_of(setup, options);
  if (configuration.engine.speed) require_bounded_step(configuration.engine, overview_of(state.agents));
  resolve(configuration);
  EngineSettings settings = configuration.engine;
  settings.threads = options.threads.value_or(settings.threads);
  EngineRecord const& record = engine_record(settings.kind);
  if (!configuration.protocol.empty()) {
    std::ranges::move(notes_on_ends(configuration.protocol), std::back_inserter(setup.notes));
    setup.simulation = prepared_simulation(configuration, settings, std::move(state));
    return;
  }
  require_collisions(run, state);
  require_hard_start(configuration.disks, state);
  std::unique_ptr<Engine> engine = engine_for(state, setup.start_file, settings);
  check_disks(setup, settings, state.box, state.clock, overview_of(state.agents));
  setup.cost_of_move = record.cost_of_move(settings, state);
  std::unique_ptr<EngineFor<HardDisks>> advancing = patient(std::move(engine), run, state);
  auto simulation = std::make_unique<DiskSimulation>(std::move(advancing), std::move(state));
  simulation->observe(configuration.observe, {.halts_moves = record.has_time_step});
  setup.simulation = std::move(simulation);
}

}  // namespace

std::unique_ptr<ModelKind> disks_kind() { return std::make_unique<DisksKind>(); }

}  // namespace gridlock
