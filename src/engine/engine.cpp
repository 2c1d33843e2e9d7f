#include "gridlock/engine/engine.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <string>
#include <string_view>
#include <utility>

#include "core/magnitude.hpp"
#include "event_chain.hpp"
#include "exact.hpp"
#include "gridlock/core/error.hpp"
#include "soft.hpp"
#include "stepped.hpp"
#include "tiled.hpp"

namespace gridlock {

namespace {

/// All engines. A new engine takes one line here and two files of its own.
std::array<EngineRecord, 5> const& registry() {
  static std::array<EngineRecord, 5> const records{stepped_record(), tiled_record(), exact_record(),
                                                   event_chain_record(), soft_record()};
  return records;
}

/// Visits a setting whose value is a name in the registry; an unknown name is left for the checks that follow.
void visit_kind(SettingVisitor& visitor, std::string& kind) {
  static std::string const documentation = [] {
    std::string text;
    for (EngineRecord const& record : registry()) {
      text +=
          fmt::format("{}\"{}\" {}", text.empty() ? "How the disks move: " : ", ", record.name, record.documentation);
    }
    return text + ".";
  }();
  std::vector<std::string_view> kinds;
  for (EngineRecord const& record : registry()) kinds.push_back(record.name);
  auto place = static_cast<std::size_t>(std::ranges::find(kinds, kind) - kinds.begin());
  visitor.visit_choice({.key = "kind", .documentation = documentation}, kinds, place);
  if (place < kinds.size()) kind = kinds[place];
}

}  // namespace

std::vector<Count> Engine::counts(State const& /*state*/, Counters const& counters) const {
  std::vector<Count> counts{{"moves", counters.moves},
                            {"halted_moves", counters.halted_moves},
                            {"pair_collisions", counters.pair_collisions},
                            {"wall_hits", counters.all_wall_hits()},
                            {"distance_checks", counters.distance_checks}};
  if (counters.inner_wall_hits > 0) counts.push_back({"inner_wall_hits", counters.inner_wall_hits});
  return counts;
}

std::span<EngineRecord const> engine_records() { return registry(); }

EngineRecord const& engine_record(std::string_view kind) {
  auto const found = std::ranges::find(registry(), kind, &EngineRecord::name);
  if (found != registry().end()) return *found;
  throw Error({.what = fmt::format("there is no engine \"{}\"", kind),
               .hint = fmt::format("engine.kind is one of: {}", fmt::join(engine_kinds(), ", ")),
               .key = "engine.kind"});
}

void refuse_to_report_collisions() {
  throw Error({.what = "an observable needs every collision one by one, and this engine does not report them",
               .hint = "use engine.kind = \"exact\"",
               .key = "engine.kind"});
}

namespace {

void require_propulsion(EngineRecord const& engine, EngineSettings const& settings) {
  if (!settings.propulsion.is_on() || (engine.has_time_step && !engine.has_potential)) return;
  if (engine.has_potential) {
    if (settings.thermostat.kind == ThermostatKind::overdamped) return;
    throw Error({.what = fmt::format("disks of the engine \"{}\" propel themselves against the friction of the "
                                     "overdamped thermostat, but thermostat.kind is \"{}\"",
                                     engine.name, to_text(settings.thermostat.kind)),
                 .hint = "use thermostat.kind = \"overdamped\"",
                 .key = "propulsion.speed"});
  }
  if (settings.thermostat.kind == ThermostatKind::brownian) return;
  throw Error({.what = fmt::format("disks of the engine \"{}\" propel themselves from kick to kick of the Brownian "
                                   "thermostat, but thermostat.kind is \"{}\"",
                                   engine.name, to_text(settings.thermostat.kind)),
               .hint = "use thermostat.kind = \"brownian\", or engine.kind = \"tiled\" for the rule with a time step",
               .key = "propulsion.speed"});
}

/// Errors: Error for a thermostat of other engines.
void require_thermostat(EngineRecord const& engine, ThermostatSettings const& thermostat) {
  if (thermostat.kind == ThermostatKind::none) return;
  if (thermostat.has_friction() ? engine.has_potential : engine.has_free_flight) return;
  throw Error({.what = fmt::format("the engine \"{}\" has no thermostat \"{}\"", engine.name, to_text(thermostat.kind)),
               .hint = fmt::format("use engine.kind = \"{}\", or thermostat.kind = \"none\"",
                                   thermostat.has_friction() ? "soft" : "exact"),
               .key = "thermostat.kind"});
}

/// Errors: Error for a drag of pairs in another engine, without inertia, or in a bath with a temperature.
void require_pair_drag(EngineRecord const& engine, EngineSettings const& settings) {
  if (!settings.pair_drag.exists()) return;
  auto const refuse = [](std::string what, char const* hint) {
    throw Error({.what = std::move(what), .hint = hint, .key = "pair_drag.coefficient"});
  };
  if (!engine.has_potential) {
    refuse(fmt::format("the engine \"{}\" has no drag of pairs", engine.name),
           "use engine.kind = \"soft\", or leave [pair_drag] out; collisions of \"exact\" lose energy by "
           "collisions.restitution");
  }
  ThermostatSettings const& thermostat = settings.thermostat;
  if (thermostat.kind == ThermostatKind::overdamped) {
    refuse(
        "disks without inertia have no velocities that a drag of pairs could slow down: they would follow from a "
        "system of equations in each step",
        "use thermostat.kind = \"none\", or \"langevin\" with temperature = 0.0");
  }
  if (thermostat.kind == ThermostatKind::langevin && thermostat.temperature != 0.0) {
    refuse(
        "a drag of pairs takes energy that the noise of the thermostat \"langevin\" does not give back, so the disks "
        "would be colder than thermostat.temperature",
        "use thermostat.temperature = 0.0, thermostat.kind = \"none\", or leave [pair_drag] out");
  }
}

}  // namespace

void require_known(EngineRecord const& engine, EngineSettings const& settings) {
  require_propulsion(engine, settings);
  auto const refuse = [&](std::string_view what, std::string_view without, std::string key) {
    throw Error({.what = fmt::format("the engine \"{}\" has no {}", engine.name, what),
                 .hint = fmt::format("use engine.kind = \"exact\", or {}", without),
                 .key = std::move(key)});
  };
  require_thermostat(engine, settings.thermostat);
  require_pair_drag(engine, settings);
  if (engine.has_potential) require_valid(settings.potential);
  if (settings.flow.exists() && !engine.has_potential) {
    throw Error({.what = fmt::format("the engine \"{}\" has no flow", engine.name),
                 .hint = "use engine.kind = \"soft\", or leave [flow] out",
                 .key = "flow.shear_rate"});
  }
  if (engine.has_free_flight) return;
  if (settings.collisions.lose_energy()) {
    refuse("collisions that lose energy", "collisions.restitution = 1", "collisions.restitution");
  }
  if (settings.gravity.exists()) refuse("gravity", "leave [gravity] out", "gravity");
  if ((engine.has_potential || engine.is_monte_carlo) && !settings.walls.empty())
    refuse("walls inside the box", "leave [[walls]] out", "walls");
}

double bytes_per_kicked_disk(EngineSettings const& settings) {
  // Time, disk and number of a kick; heading and place of a swimmer.
  double const of_kicks = settings.thermostat.kind == ThermostatKind::andersen ? 24.0 : 0.0;
  bool const keeps_headings = settings.propulsion.is_on() && engine_record(settings.kind).has_free_flight;
  return of_kicks + (keeps_headings ? 32.0 : 0.0);
}

std::vector<std::string> engine_kinds() {
  std::vector<std::string> kinds;
  for (EngineRecord const& record : registry()) kinds.emplace_back(record.name);
  return kinds;
}

Device device_of(Device setting) {
  char const* const wish = std::getenv("GRIDLOCK_DEVICE");
  std::string_view const name = wish == nullptr ? "" : wish;
  if (name.empty()) return setting;
  if (name == "gpu") return Device::gpu;
  if (name == "cpu") return Device::cpu;
  throw Error({.what = fmt::format("GRIDLOCK_DEVICE is \"{}\"", name),
               .hint = "set it to gpu, for all runs that can use a graphics processor, to cpu, or unset it"});
}

void require_room_on_device(std::size_t count, std::string_view things, std::size_t bytes) {
  std::optional<DeviceInfo> const device = find_device();
  if (!device || bytes <= device->free_memory) return;
  double const share = static_cast<double>(device->free_memory) / static_cast<double>(bytes);
  throw Error({.what = fmt::format("{} {} need {:.1f} MB on the graphics processor \"{}\", of which {:.1f} MB are free",
                                   count, things, 1e-6 * static_cast<double>(bytes), device->name,
                                   1e-6 * static_cast<double>(device->free_memory)),
               .hint = fmt::format("use at most about {:.0f} {}, or engine.device = \"cpu\" or GRIDLOCK_DEVICE=cpu",
                                   std::floor(share * static_cast<double>(count)), things),
               .key = "engine.device"});
}

std::unique_ptr<Engine> make_engine(EngineSettings const& settings, State const& state) {
  EngineRecord const& record = engine_record(settings.kind);
  require_known(record, settings);
  if (!record.has_oblique_boxes) require_rectangle(state.box, fmt::format("the engine \"{}\"", record.name));
  return record.make(settings, state);
}

double step_duration(EngineSettings const& settings, State const& state) {
  return step_duration(settings, radius_range(state.agents).smallest);
}

double step_duration(EngineSettings const& settings, double smallest_radius) {
  double const diameter = 2.0 * smallest_radius;
  double const speed = settings.speed.value_or(1.0);
  return settings.time_step * diameter / (speed > 0.0 ? speed : 1.0);
}

void describe(EngineSettings& settings, SettingVisitor& visitor) {
  static constexpr std::array<std::string_view, 2> contacts{"always", "approaching"};
  static constexpr std::array<std::string_view, 2> grids{"linked", "packed"};
  visit_kind(visitor, settings.kind);
  visitor.visit({.key = "time_step",
                 .unit = "diameters of the smallest disk per speed",
                 .documentation = "Length of one time step.",
                 .min = 0.0,
                 .max = 1e6,
                 .min_is_allowed = false},
                settings.time_step);
  visitor.visit({.key = "speed",
                 .unit = "length / time",
                 .documentation = "The speed that time_step refers to; for soft disks the step is then in units of "
                                  "σ √(m/ε).",
                 .min = 0.0,
                 .max = max_magnitude,
                 .default_note = "velocities.max; for soft disks √(ε/m), of the mean mass"},
                settings.speed);
  visitor.visit({.key = "substeps",
                 .documentation = "Equal parts of a time step in which a disk tries to move.",
                 .min = 1,
                 .max = 1e6},
                settings.substeps);
  visitor.visit(
      {.key = "cells",
       .documentation = "k: the linked lists divide the box into k × k cells (the paper calls a cell a neighbourhood).",
       .min = 1,
       .max = 46340,
       .default_note = "as many as keep the 3×3 block wide enough for every collision of one step"},
      settings.cells);
  visit_enum(visitor,
             {.key = "contact",
              .documentation = "Whether a halted disk collides with its partner \"always\" (the paper's rule) or only "
                               "when the two are \"approaching\"."},
             contacts, settings.contact);
  visitor.visit({.key = "audit_every",
                 .unit = "pair collisions",
                 .documentation = "How often the exact engine looks for overlaps and missed collisions; 0 is never."},
                settings.audit_every);
  visit_enum(visitor,
             {.key = "grid",
              .documentation = "How stepped finds the neighbours of a disk: \"linked\" is the paper's lists in k × k "
                               "cells, \"packed\" is faster, chooses its own cells and gives the same bits."},
             grids, settings.grid);
  describe_chains(settings.chains, settings.chain_length, visitor);
  describe_device(settings, visitor);
  describe_threads(settings, visitor);
}

void describe_threads(EngineSettings& settings, SettingVisitor& visitor) {
  visitor.visit({.key = "threads",
                 .documentation =
                     "How many threads exact, tiled, soft and the models use; any number gives the same bits, and 0 is "
                     "all cores that the process may use.",
                 .max = 1024},
                settings.threads);
}

void describe_device(EngineSettings& settings, SettingVisitor& visitor) {
  static constexpr std::array<std::string_view, 2> devices{"cpu", "gpu"};
  visit_enum(
      visitor,
      {.key = "device",
       .documentation = "The processor of tiled and of the models flocking and epidemic: \"cpu\" is the cores of "
                        "the machine, \"gpu\" a graphics processor, in a program built for it; both give the "
                        "same bits. The environment variable GRIDLOCK_DEVICE, cpu or gpu, takes its place."},
      devices, settings.device);
}

}  // namespace gridlock
