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
#include "core/temperature.hpp"
#include "engine/stepped.hpp"
#include "gridlock/core/detail/time_step_rule.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/simulation/world_simulation.hpp"
#include "observe/displacement_curve.hpp"
#include "parallel/disks_of_all.hpp"
#include "simulation/countable_time.hpp"
#include "simulation/disks_start.hpp"
#include "simulation/dynamics_notes.hpp"
#include "simulation/expected_work.hpp"
#include "simulation/patient_engine.hpp"
#include "simulation/protocol_simulation.hpp"

namespace gridlock {

namespace {

/// Replaces missing settings by their defaults, so that the configuration records all values of the run.
void resolve(Configuration& configuration, Disks const& disks) {
  bool const is_soft = engine_record(configuration.engine.kind).has_potential;
  if (!configuration.engine.speed && is_soft && count_of_fixed(disks) < disks.size()) {
    configuration.engine.speed = std::sqrt(configuration.engine.potential.energy / mean_mass(disks));
  }
  if (!configuration.engine.speed) {
    PropulsionSettings const& propulsion = configuration.engine.propulsion;
    configuration.engine.speed = propulsion.is_on() ? propulsion.speed : configuration.velocities.max;
  }
  if (configuration.disks.start == StartKind::file) return;
  if (!configuration.disks.count) configuration.disks.count = 841;
  if (!configuration.disks.radius && !configuration.disks.packing_fraction) configuration.disks.packing_fraction = 0.5;
}

/// Checks the time step, which a speed near 0 makes too long to compute with.
void require_bounded_step(EngineSettings const& engine, DisksOverview const& disks) {
  double const duration = step_duration(engine, disks.radii.smallest);
  if (!engine_record(engine.kind).has_time_step || duration <= max_magnitude) return;
  throw Error({.what = fmt::format("engine.speed = {} makes a time step of {:.3g}, too long to compute with",
                                   engine.speed.value_or(1.0), duration),
               .hint = "use a speed near that of the disks, or 0 for a speed of 1",
               .key = "engine.speed"});
}

/// Checks the clock at the start. Near the end of its range it cannot count steps, so a run would end at once or never.
void require_clock(Clock const& clock, DisksOverview const& disks, std::filesystem::path const& start_file,
                   EngineSettings const& engine) {
  // Half of all steps, so that a run from there can have as many; counts of steps end at 2⁶⁴ − 1.
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

/// Makes the engine, which checks the state itself: the exact engine tolerates rounding errors of disks in contact.
std::unique_ptr<Engine> engine_for(State const& state, std::filesystem::path const& start_file,
                                   EngineSettings const& settings) {
  return blaming_file(start_file, [&] { return make_engine(settings, state); });
}

/// Checks that a disk at twice v_max cannot jump over another disk in a sub-step. Collisions soon make disks that fast
/// (one move in 3000 in equilibrium, exp(−8)). The rare faster disk is detected in its move.
void require_short_substeps(EngineSettings const& engine, DisksOverview const& disks) {
  EngineRecord const& record = engine_record(engine.kind);
  if (!record.has_time_step || record.has_potential) return;
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

/// Returns a note if the engine has a time step and the results are known to mislead.
std::optional<Event> misleading_rule(Box const& box, DisksOverview const& disks, EngineSettings const& settings) {
  EngineRecord const& engine = engine_record(settings.kind);
  // The caveats are those of a rule for elastic disks.
  if (!engine.has_time_step || engine.has_potential || settings.propulsion.is_on()) return std::nullopt;
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

/// Returns a note on disks for which processes wait; in equilibrium one in 10¹³ exceeds 4 times engine.speed.
std::optional<Event> wait_for_fast_disks(EngineSettings const& engine, DisksOverview const& disks) {
  double const speed = engine.speed.value_or(1.0);
  if (engine.processes.count() == 1 || !(speed > 0.0) || !(disks.largest_speed > 4.0 * speed)) return std::nullopt;
  return Event{.kind = EventKind::fast_on_ranks,
               .key = "engine.speed",
               .values = {{"ratio", disks.largest_speed / speed}, {"speed", speed}}};
}

/// Returns notes on stages with two settings that may end them.
std::vector<Event> notes_on_ends(std::vector<StageSettings> const& stages) {
  std::vector<Event> notes;
  for (std::size_t k = 0; k < stages.size(); ++k) {
    StageSettings const& stage = stages[k];
    char const* ends = nullptr;
    if (stage.until_packing_fraction && stage.until_pressure) ends = "until_packing_fraction and until_pressure";
    if (stage.until_time && stage.collisions_per_disk) ends = "until_time and collisions_per_disk";
    if (ends == nullptr) continue;
    notes.push_back(
        {.kind = EventKind::stage_with_two_ends,
         .key = fmt::format("protocol[{}]", k),
         .values = {{"stage", static_cast<std::uint64_t>(k + 1)}, {"name", stage.kind}, {"ends", std::string(ends)}}});
  }
  return notes;
}

void require_no_overlaps_in_run(Configuration const& configuration) {
  auto const& stages = configuration.protocol;
  if (engine_record(configuration.engine.kind).has_potential) return;
  if (stages.empty() || !leaves_overlaps(stages.back().kind) || !takes_steps(configuration)) return;
  throw Error(
      {.what = fmt::format("the run is one of hard disks, and the last stage of the protocol, \"{}\", leaves overlaps",
                           stages.back().kind),
       .hint = "add a stage \"separate\" at the end, or give [run] no length",
       .key = fmt::format("protocol[{}]", stages.size() - 1)});
}

/// An engine that moves nothing and accepts any disks, for the end of a protocol without a run.
class RestingEngine final : public Engine {
 public:
  explicit RestingEngine(double duration) : duration_(duration) {}

  void advance(State& /*state*/, Counters& /*counters*/, StopCondition const& /*stop_condition*/) override {}
  [[nodiscard]] double time_step() const override { return duration_; }
  void require_valid(State const& /*state*/) const override {}
  void report_collisions(ReportCollision /*report*/) override {}

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
    return {
        {"disks", "How many disks, how large, and where they start.",
         [&](SettingVisitor& visitor) { describe(configuration.disks, visitor); }},
        {"velocities", "How fast the disks are at the start.",
         [&](SettingVisitor& visitor) { describe(configuration.velocities, visitor); }},
        {"engine", "How the disks move; of other models the threads.",
         [&](SettingVisitor& visitor) { describe(configuration.engine, visitor); }},
        {"potential", "How the disks of the engine soft repel or attract each other.",
         [&](SettingVisitor& visitor) { describe(configuration.engine.potential, visitor); }},
        {"flow", "Whether a steady flow shears the disks of the engine soft.",
         [&](SettingVisitor& visitor) { describe(configuration.engine.flow, visitor); }},
        {"pair_drag", "Whether disks of the engine soft that touch lose energy.",
         [&](SettingVisitor& visitor) { describe(configuration.engine.pair_drag, visitor); }},
        {"thermostat", "Whether the disks of the engines exact and soft exchange energy with a bath, as colloids do.",
         [&](SettingVisitor& visitor) { describe(configuration.engine.thermostat, visitor); }},
        {"collisions", "Whether collisions of the engine exact lose energy, as those of grains do.",
         [&](SettingVisitor& visitor) { describe(configuration.engine.collisions, visitor); }},
        {"gravity", "Whether the disks of the engine exact fall.",
         [&](SettingVisitor& visitor) { describe(configuration.engine.gravity, visitor); }},
        {"propulsion", "Whether disks propel themselves along headings that turn at random.",
         [&](SettingVisitor& visitor) { describe(configuration.engine.propulsion, visitor); }},
        {"soft", "How disks repel each other in the stages quench, compress, decompress and shear of a protocol.",
         [&](SettingVisitor& visitor) { describe(configuration.soft, visitor); }}};
  }
  [[nodiscard]] std::string unused_because_of(Configuration const& configuration, std::string_view key) const override {
    constexpr std::string_view table = "engine.";
    if (key == "model.verify_every") return "model.kind = \"disks\"";
    if (key == "disks.start" && !configuration.disks.file.empty() && configuration.disks.start != StartKind::file) {
      return "disks.file";
    }
    if (key.starts_with("soft.") && configuration.protocol.empty()) return "no [[protocol]]";
    if (key == "collisions.contact_time" && !configuration.engine.collisions.lose_energy()) {
      return "collisions.restitution = 1";
    }
    bool const has_potential = engine_record(configuration.engine.kind).has_potential;
    if (key.starts_with("potential.") && !has_potential) {
      return fmt::format("engine.kind = \"{}\"", configuration.engine.kind);
    }
    if (key.starts_with("potential.")) return unused_of_potential(configuration.engine.potential.kind, key);
    if (key.starts_with("thermostat.")) return unused_of_thermostat(configuration.engine.thermostat.kind, key);
    PropulsionSettings const& propulsion = configuration.engine.propulsion;
    if (key == "pair_drag.direction" && !configuration.engine.pair_drag.exists()) return "pair_drag.coefficient = 0";
    if (key == "propulsion.rotational_diffusion" && !propulsion.is_on()) return "propulsion.speed = 0";
    if (key == "engine.contact" && propulsion.is_on()) return "propulsion.speed above 0";
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
  [[nodiscard]] bool can_use_device(Configuration const& configuration) const override {
    return takes_steps(configuration) && engine_record(configuration.engine.kind).uses_device;
  }
  [[nodiscard]] std::optional<Problem> not_shared(Configuration const& configuration) const override {
    if (!configuration.protocol.empty()) return Problem{.what = "a run with a [[protocol]]", .key = "protocol"};
    if (engine_record(configuration.engine.kind).uses_processes) return {};
    return Problem{.what = fmt::format("the engine \"{}\"", configuration.engine.kind), .key = "engine.kind"};
  }
  [[nodiscard]] bool ends_within_steps(Configuration const& configuration) const override {
    return !engine_record(configuration.engine.kind).has_time_step;
  }
  [[nodiscard]] bool counts_collisions() const override { return true; }
  [[nodiscard]] std::vector<std::pair<std::string, std::string>> choices(
      Configuration const& configuration) const override {
    if (!takes_steps(configuration)) return {};
    std::vector<std::pair<std::string, std::string>> choices{{"engine", configuration.engine.kind}};
    if (engine_record(configuration.engine.kind).has_potential) {
      choices.emplace_back("potential", to_text(configuration.engine.potential.kind));
    }
    ThermostatKind const thermostat = configuration.engine.thermostat.kind;
    if (thermostat != ThermostatKind::none) choices.emplace_back("thermostat", to_text(thermostat));
    if (configuration.engine.propulsion.is_on()) {
      choices.emplace_back("propulsion speed", fmt::format("{:.6g}", configuration.engine.propulsion.speed));
    }
    return choices;
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

  void check(Configuration const& configuration) const override {
    require_known(engine_record(configuration.engine.kind), configuration.engine);
    require_counted_collisions(configuration.engine, configuration.run);
    require_places_along_x(configuration);
    require_free_flight(configuration.engine, configuration.observe);
    require_valid(configuration.protocol);
    require_known_tilt(configuration);
    if (!configuration.protocol.empty() && !configuration.engine.walls.empty()) {
      throw Error({.what = "the stages of a protocol know no walls inside the box",
                   .hint = "take [[protocol]] or [[walls]] out",
                   .key = "walls"});
    }
    require_no_overlaps_in_run(configuration);
  }
  void build(Setup& setup, SetupOptions const& options) const override;

 private:
  static double bytes_per_disk(Configuration const& configuration) {
    EngineRecord const& engine = engine_record(configuration.engine.kind);
    CheckpointSettings const& checkpoint = configuration.checkpoint;
    bool const has_checkpoints = checkpoint.every_seconds > 0.0 || checkpoint.every_steps > 0 || checkpoint.keep_last ||
                                 checkpoint.keep_states > 0;
    bool const has_threads = threads_of(configuration, std::nullopt) > 1;
    ObserveSettings const& observe = configuration.observe;
    std::uint64_t const origins =
        DisplacementCurve::origins_in_use(observe.displacement_lag, observe.displacement_origin_every);
    return engine.bytes_per_disk + (has_threads ? engine.bytes_per_disk_of_threads : 0.0) +
           (has_checkpoints ? engine.bytes_per_disk_of_checkpoint : 0.0) + bytes_per_kicked_disk(configuration.engine) +
           DisplacementCurve::bytes_per_agent * static_cast<double>(origins);
  }
};

/// Whether disks at rest get velocities during the run.
bool gives_velocities(EngineSettings const& settings) {
  return engine_record(settings.kind).has_potential || settings.thermostat.kind != ThermostatKind::none ||
         settings.propulsion.is_on() || settings.gravity.exists();
}

/// Returns the engine of a run; if only collisions end the run, it fails after a long time without collisions.
std::unique_ptr<EngineFor<HardDisks>> patient(std::unique_ptr<Engine> engine, RunSettings const& run,
                                              State const& state, AllProcesses processes) {
  if (run.steps || run.time) return engine;
  return std::make_unique<PatientEngine>(std::move(engine), patience_for(state, processes), processes);
}

DynamicsTraits traits_of(EngineSettings const& settings) {
  EngineRecord const& engine = engine_record(settings.kind);
  bool const has_steps = engine.has_time_step;
  bool const propels = settings.propulsion.is_on();
  if (engine.has_potential) {
    return {.keeps_counters = false,
            .halts_moves = false,
            .propels = propels,
            .has_impulses = false,
            .potential = settings.potential,
            .thermostat = settings.thermostat,
            .propulsion = settings.propulsion,
            .pair_drag = settings.pair_drag,
            .flow = settings.flow};
  }
  return {.has_dynamics = !engine.is_monte_carlo,
          .halts_moves = has_steps,
          .propels = propels,
          .has_impulses = !(has_steps && propels)};
}

/// Returns a simulation that a protocol prepares. Its time step in units of the diameter is that of the start.
std::unique_ptr<Simulation> prepared_simulation(Configuration const& configuration, EngineSettings const& settings,
                                                State state) {
  if (count_of_fixed(state.agents) > 0) {
    throw Error({.what = fmt::format("{} disks are fixed, and the stages of a protocol move and change all disks",
                                     count_of_fixed(state.agents)),
                 .hint = "take [[protocol]] out, or let all species move",
                 .key = "protocol"});
  }
  double const duration = step_duration(settings, state);
  ProtocolSettings const protocol{.stages = configuration.protocol,
                                  .soft = configuration.soft,
                                  .time_step = settings.time_step,
                                  .threads = settings.threads};
  bool const can_run =
      engine_record(settings.kind).has_potential || !leaves_overlaps(configuration.protocol.back().kind);
  auto const make = [=, run = configuration.run, observe = configuration.observe](State world, bool is_prepared) {
    EngineSettings engine = settings;
    engine.time_step *= duration / step_duration(settings, world);
    std::unique_ptr<EngineFor<HardDisks>> advancing = std::make_unique<RestingEngine>(duration);
    // These disks get a real engine even if this run has no length, since the run may be lengthened later; not in an
    // oblique box that the engine does not know.
    bool const knows_box = engine_record(engine.kind).has_oblique_boxes || !world.box.is_oblique();
    if (is_prepared && can_run && (knows_box || run.steps != 0))
      advancing = patient(make_engine(engine, world), run, world, {});
    auto simulation = std::make_unique<DiskSimulation>(std::move(advancing), std::move(world));
    simulation->observe(observe, traits_of(settings));
    return simulation;
  };
  return std::make_unique<ProtocolSimulation>(protocol, std::move(state), make);
}

/// Checks settings of a run against its disks, and adds notes.
void check_disks(Setup& setup, EngineSettings const& settings, Box const& box, Clock const& clock,
                 DisksOverview const& disks) {
  require_clock(clock, disks, setup.start_file, settings);
  require_short_substeps(settings, disks);
  require_countable_turns(settings, disks);
  if (auto note = misleading_rule(box, disks, settings)) setup.notes.push_back(*std::move(note));
  if (auto note = may_collapse(settings.collisions)) setup.notes.push_back(*std::move(note));
  if (auto note = motion_by_propulsion(settings, disks)) setup.notes.push_back(*std::move(note));
  if (auto note = nothing_moves(disks, setup.configuration.velocities); note && !gives_velocities(settings)) {
    setup.notes.push_back(*std::move(note));
  }
  if (auto note = wait_for_fast_disks(settings, disks)) setup.notes.push_back(*std::move(note));
}

void DisksKind::build(Setup& setup, SetupOptions const& options) const {
  Configuration& configuration = setup.configuration;
  RunSettings const& run = configuration.run;
  AllProcesses const processes = options.processes;
  bool const has_speed = configuration.engine.speed.has_value();
  State own = start_of_disks(setup, options);
  DisksOverview const all = overview_of_all(own.agents, processes);
  resolve(configuration, own.agents);
  if (configuration.protocol.empty()) {
    configuration.engine.thermostat = resolved(configuration.engine.thermostat, own);
    if (auto note = motion_by_thermostat(configuration.engine.thermostat, own.agents))
      setup.notes.push_back(*std::move(note));
  }
  EngineSettings settings = configuration.engine;
  settings.threads = configuration.protocol.empty() ? threads_of(configuration, options.threads, processes)
                                                    : options.threads.value_or(settings.threads);
  settings.processes = processes;
  processes.agree([&] {
    if (has_speed) require_bounded_step(configuration.engine, all);
    bool const needs_motion = ends_with_collisions(run) && !gives_velocities(configuration.engine);
    if (configuration.protocol.empty() && needs_motion) require_motion(all);
  });
  if (!configuration.protocol.empty()) {
    std::ranges::move(notes_on_ends(configuration.protocol), std::back_inserter(setup.notes));
    if (auto note = other_potential(configuration)) setup.notes.push_back(*std::move(note));
    setup.simulation = prepared_simulation(configuration, settings, std::move(own));
    return;
  }
  require_floor(settings, own);
  if (auto note = lasting_contacts(settings, own)) setup.notes.push_back(*std::move(note));
  std::unique_ptr<Engine> engine = engine_for(own, setup.start_file, settings);
  processes.agree([&] { check_disks(setup, settings, own.box, own.clock, all); });
  EngineRecord const& record = engine_record(settings.kind);
  setup.cost_of_move = record.cost_of_move(settings, own);
  std::unique_ptr<EngineFor<HardDisks>> advancing = patient(std::move(engine), run, own, processes);
  auto simulation = std::make_unique<DiskSimulation>(std::move(advancing), std::move(own), processes);
  simulation->observe(configuration.observe, traits_of(settings));
  setup.simulation = std::move(simulation);
}

}  // namespace

std::unique_ptr<ModelKind> disks_kind() { return std::make_unique<DisksKind>(); }

}  // namespace gridlock
