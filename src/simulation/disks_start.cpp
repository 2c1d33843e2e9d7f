#include "simulation/disks_start.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

#include "gridlock/grid/validate.hpp"
#include "gridlock/lattice/start.hpp"
#include "io/xyz_reader.hpp"
#include "parallel/disks_of_all.hpp"
#include "simulation/shared_start.hpp"
#include "simulation/slow_start.hpp"
#include "simulation/start_file.hpp"

namespace gridlock {

namespace {

/// Throws an Error if uniform points overlap. It names the setting once instead of listing the pairs.
void require_hard_start(DisksSettings const& disks, State const& state) {
  if (disks.start != StartKind::uniform || !(largest_overlap(state) > 0.0)) return;
  throw Error({.what = "disks at uniform points overlap, and the run is one of hard disks",
               .hint = "begin a [[protocol]] with stage = \"quench\", or use disks.start = \"random\"",
               .key = "disks.start"});
}

/// Returns whether two disks cannot meet before one meets a third: their distance along x or y stays constant.
bool keep_apart(State const& state, std::size_t i, std::size_t j) {
  double const contact = state.agents.column<Radius>()[i] + state.agents.column<Radius>()[j];
  Vector const d = state.box.displacement(position(state.agents, i), position(state.agents, j));
  Vector const v = velocity(state.agents, i);
  Vector const w = velocity(state.agents, j);
  // With walls, equal velocities do not stay equal, since one disk reaches the wall first.
  bool const is_fixed_in_x = v.x == w.x && (state.box.is_periodic_x() || v.x == 0.0);
  bool const is_fixed_in_y = v.y == w.y && (state.box.is_periodic_y() || v.y == 0.0);
  return (is_fixed_in_x && is_fixed_in_y) || (is_fixed_in_x && std::abs(d.x) >= contact) ||
         (is_fixed_in_y && std::abs(d.y) >= contact);
}

/// Largest number of disks for which all pairs are examined.
constexpr std::size_t max_disks_for_all_pairs = 2000;

/// Returns false if no two disks can ever meet. May return true for disks that never meet, at least if there are many.
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

/// Returns whether to make the configured start. A slow start may be replaced by another one, with a note.
bool makes_start_asked_for(Setup& setup, SetupOptions const& options) {
  Configuration const& configuration = setup.configuration;
  DisksSettings const& disks = configuration.disks;
  bool const may_be_slow = options.on_slow_start && disks.count.value_or(0) >= many_agents;
  double const attempts =
      may_be_slow ? expected_attempts(make_box(configuration.box), disks, configuration.run.seed) : 0.0;
  return makes_start(attempts, "disks.start", options, setup.notes);
}

/// Packing fraction that ten or more disks of any sizes can reach by growth; mixtures of two sizes jam from 0.84 on.
constexpr double reached_by_growth = 0.84;

/// Makes a start. If the disks find no room but could grow to the packing fraction, the error mentions growth.
StartOfDisks start_or_reference_to_growth(Box const& box, DisksSettings const& disks, std::uint64_t seed) {
  try {
    return {box, disks, seed};
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

/// Makes the configured start, or a triangular lattice instead of a slow start.
StartOfDisks random_or_lattice_start(Setup& setup, bool is_asked_for) {
  Configuration const& configuration = setup.configuration;
  Box const box = make_box(configuration.box);
  std::uint64_t const seed = configuration.run.seed;
  if (!is_asked_for) {
    DisksSettings disks = configuration.disks;
    disks.start = StartKind::triangular;
    try {
      return {box, disks, seed};
    } catch (Error const&) {
      // Disks of very unequal sizes may fit at random but not on a lattice, so the configured start is made after all.
      setup.notes.pop_back();
    }
  }
  return start_or_reference_to_growth(box, configuration.disks, seed);
}

/// Returns the disks of this process, at rest.
Disks dealt_out(AllProcesses processes, StartOfDisks const* start) {
  return deal_out(processes, start == nullptr ? 0 : start->count(), [&](std::uint64_t k) {
    DiskAtStart const disk = start->disk(k);
    return DiskRow{.id = k,
                   .x = disk.site.x,
                   .y = disk.site.y,
                   .velocity_x = 0.0,
                   .velocity_y = 0.0,
                   .radius = disk.radius,
                   .mass = disk.mass,
                   .image_x = 0,
                   .image_y = 0};
  });
}

/// Reads the header of the configured frame.
xyz::Reader open_start_file(Setup const& setup) {
  DisksSettings const& disks = setup.configuration.disks;
  xyz::FrameChoice choice{.frame = {}, .setting = "disks.frame"};
  // Larger frame numbers are reduced to the largest of 64 bits with sign, which no file reaches.
  constexpr std::uint64_t most = std::numeric_limits<std::int64_t>::max();
  if (disks.frame) choice.frame = static_cast<std::int64_t>(std::min(*disks.frame, most));
  return xyz::Reader(TextReader(setup.start_file), choice);
}

/// Checks that a run of these disks can begin and end. `whole` contains the disks of all processes.
void require_good_whole(Setup const& setup, State const& whole) {
  Configuration const& configuration = setup.configuration;
  if (!configuration.protocol.empty()) return;
  if (ends_with_collisions(configuration.run) && !can_collide(whole)) refuse_rest();
  if (!engine_record(configuration.engine.kind).has_potential) require_hard_start(configuration.disks, whole);
}

/// Returns the disks of a file. A large file is read in pieces, so that no process holds all disks.
State start_of_file(Setup& setup, SetupOptions const& options) {
  Configuration& configuration = setup.configuration;
  AllProcesses const processes = options.processes;
  setup.start_file = options.directory / configuration.disks.file;
  configuration.disks.start = StartKind::file;
  std::optional<xyz::Reader> reader;
  processes.on_root([&] { reader.emplace(open_start_file(setup)); });
  auto const note = [&] {
    std::ranges::move(notes_of_start(*reader, configuration.velocities), std::back_inserter(setup.notes));
  };
  bool const are_few = processes.of_root(!reader || reader->count() <= max_disks_for_all_pairs);
  if (are_few || processes.count() == 1) {
    State whole;
    processes.on_root([&] {
      whole = read_whole_start(*reader, configuration, options.is_given);
      note();
      require_good_whole(setup, whole);
    });
    return deal_out(processes, std::move(whole));
  }
  RowsOfFile read = blaming_file(setup.start_file, [&] {
    return read_together(
        processes.communicator(), configuration.disks,
        {.reader = processes.is_root() ? &*reader : nullptr, .take_summary = [&](StartFileSummary const& summary) {
           take_summary(configuration, summary, options.is_given);
         }});
  });
  read.own.seed = configuration.run.seed;
  processes.on_root(note);
  if (!read.has_velocities || configuration.velocities.redraw) {
    processes.agree([&] { draw_velocities(read.own, configuration.velocities, processes); });
  }
  return std::move(read.own);
}

}  // namespace

void require_motion(DisksOverview const& all) {
  if (!(all.largest_speed > 0.0)) refuse_rest();
}

State start_of_disks(Setup& setup, SetupOptions const& options) {
  Configuration const& configuration = setup.configuration;
  DisksSettings const& disks = configuration.disks;
  AllProcesses const processes = options.processes;
  if (!options.start && !disks.file.empty()) return start_of_file(setup, options);
  // The root holds all disks if they are few or may overlap, since their pairs must be examined.
  bool const is_whole = options.start || disks.start == StartKind::uniform ||
                        count_of(disks) <= max_disks_for_all_pairs || processes.count() == 1;
  auto const make_start = [&] { return random_or_lattice_start(setup, makes_start_asked_for(setup, options)); };
  if (is_whole) {
    State whole;
    processes.on_root([&] {
      whole = options.start ? *options.start : make_start().all();
      if (!options.start) draw_velocities(whole, configuration.velocities);
      require_good_whole(setup, whole);
    });
    return deal_out(processes, std::move(whole));
  }
  std::optional<StartOfDisks> start;
  processes.on_root([&] { start.emplace(make_start()); });
  State own{.box = make_box(configuration.box), .agents = {}, .clock = {}, .seed = configuration.run.seed};
  own.agents = dealt_out(processes, start ? &*start : nullptr);
  start.reset();
  processes.agree([&] { draw_velocities(own, configuration.velocities, processes); });
  return own;
}

}  // namespace gridlock
