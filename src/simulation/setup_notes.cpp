#include "simulation/setup_notes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "gridlock/core/time_step_rule.hpp"

namespace gridlock {

namespace {

struct EngineSetting {
  std::string_view name;
  bool is_default;
};

std::vector<EngineSetting> settings_of(EngineSettings const& engine) {
  EngineSettings const usual;
  return {{"kind", engine.kind == usual.kind},
          {"time_step", engine.time_step == usual.time_step},
          {"speed", !engine.speed},
          {"substeps", engine.substeps == usual.substeps},
          {"cells", !engine.cells},
          {"contact", engine.contact == usual.contact},
          {"audit_every", engine.audit_every == usual.audit_every},
          {"grid", engine.grid == usual.grid},
          {"threads", engine.threads == usual.threads}};
}

bool is_one_of(std::string_view name, std::initializer_list<std::string_view> names) {
  return std::ranges::find(names, name) != names.end();
}

/// Whether a run depends on a setting of the table [engine].
bool is_used(Configuration const& configuration, std::string_view name) {
  if (configuration.is_of_model()) return name == "threads";
  std::string const& kind = configuration.engine.kind;
  if (kind == "stepped") return !is_one_of(name, {"audit_every", "threads"});
  if (kind == "tiled") return !is_one_of(name, {"audit_every", "grid", "cells"});
  if (kind == "exact") return !is_one_of(name, {"contact", "substeps", "cells", "grid", "threads"});
  return true;
}

std::optional<SetupNote> misleading_rule(Setup const& setup) {
  std::string const& kind = setup.configuration.engine.kind;
  if (kind == "exact") return std::nullopt;
  std::string const reasons = where_time_steps_mislead(setup.state.box, setup.state.disks);
  if (reasons.empty()) return std::nullopt;
  return SetupNote{
      .kind = NoteKind::misleading_rule,
      .key = "engine.kind",
      .text = fmt::format("with engine.kind = \"{}\" {}, because of its time step; \"exact\" has none", kind, reasons)};
}

/// The ends of a run that are known beforehand, from its start.
struct End {
  double step = std::numeric_limits<double>::infinity();
  double time = std::numeric_limits<double>::infinity();
};

End end_of(Setup const& setup) {
  // A length meant as a multiple of the step must not miss it for a rounding.
  constexpr double rounding = 1e-9;
  RunSettings const& run = setup.configuration.run;
  End end;
  if (run.steps) end.step = static_cast<double>(*run.steps);
  if (run.time) end.time = *run.time;
  // How long a step is only the model knows.
  if (setup.configuration.is_of_model()) return end;
  double const duration = step_duration(setup.configuration.engine, setup.state);
  bool const ends_within_steps = setup.configuration.engine.kind == "exact";
  double const steps = end.time / duration;
  end.step = std::min(end.step,
                      ends_within_steps ? std::floor(steps * (1.0 + rounding)) : std::ceil(steps * (1.0 - rounding)));
  end.time = end.step * duration * (1.0 + rounding);
  return end;
}

void note_frames_beyond(char const* key, char const* unit, std::vector<double> const& asked_for, double end,
                        std::vector<SetupNote>& notes) {
  auto const beyond = std::ranges::count_if(asked_for, [&](double at) { return at > end; });
  if (beyond == 0) return;
  notes.push_back({.kind = NoteKind::frames_beyond_end,
                   .key = key,
                   .text = fmt::format("{} of {} in {} lie{} beyond the end of the run at {} {:.6g}: no frame there",
                                       beyond, asked_for.size(), key, beyond == 1 ? "s" : "", unit, end)});
}

}  // namespace

std::vector<SetupNote> unused_settings(Configuration const& configuration,
                                       std::function<bool(std::string_view)> const& is_given) {
  std::vector<SetupNote> notes;
  bool const is_of_model = configuration.is_of_model();
  std::string const choice = is_of_model ? fmt::format("model.kind = \"{}\"", configuration.model.kind)
                                         : fmt::format("engine.kind = \"{}\"", configuration.engine.kind);
  auto const add = [&](std::string key, std::string const& why, bool is_default) {
    std::string text = key + " " + why;
    notes.push_back({NoteKind::unused_setting, std::move(key), std::move(text), is_default});
  };
  for (EngineSetting const& setting : settings_of(configuration.engine)) {
    std::string key = fmt::format("engine.{}", setting.name);
    if (is_used(configuration, setting.name) || !is_given(key)) continue;
    // Coarse neighbourhoods are shown in the picture of the start, whatever finds the neighbours.
    bool const is_drawn = setting.name == "cells" && !is_of_model;
    add(std::move(key), fmt::format("has no effect{} with {}", is_drawn ? " on the disks" : "", choice),
        setting.is_default);
  }
  if (!is_of_model && is_given("model.verify_every")) {
    add("model.verify_every", "has no effect without model.kind", configuration.model.verify_every == 0);
  }
  return notes;
}

std::vector<SetupNote> notes_of(Setup const& setup) {
  std::vector<SetupNote> notes;
  Configuration const& configuration = setup.configuration;
  if (!configuration.is_of_model()) {
    if (auto note = misleading_rule(setup)) notes.push_back(*std::move(note));
    if (!(kinetic_energy(setup.state.disks) > 0.0)) {
      notes.push_back({.kind = NoteKind::nothing_moves,
                       .key = "velocities.max",
                       .text = configuration.velocities.max > 0.0
                                   ? "no disk of the start file has a velocity: nothing moves"
                                   : "velocities.max is 0: nothing moves"});
    }
  }
  End const end = end_of(setup);
  note_frames_beyond("trajectory.steps", "step", configuration.trajectory.steps, end.step, notes);
  note_frames_beyond("trajectory.times", "time", configuration.trajectory.times, end.time, notes);
  return notes;
}

namespace {

/// What is told of one note that some of the runs have; nothing where it is not worth it.
std::optional<std::string> text_of(std::vector<SetupNote> const& alike, std::size_t runs) {
  SetupNote const& first = alike.front();
  bool const has_one_text = std::ranges::all_of(alike, [&](SetupNote const& note) { return note.text == first.text; });
  bool const is_of_all = alike.size() == runs;
  if (first.kind != NoteKind::unused_setting) {
    return is_of_all && has_one_text ? first.text : fmt::format("{} of {} runs: {}", alike.size(), runs, first.text);
  }
  if (!is_of_all || std::ranges::all_of(alike, &SetupNote::is_default)) return std::nullopt;
  return has_one_text ? first.text : fmt::format("{} has no effect in any run", first.key);
}

}  // namespace

std::vector<std::string> notes_on(std::vector<std::vector<SetupNote>> const& runs) {
  std::vector<std::string> texts;
  std::set<std::pair<NoteKind, std::string>> told;
  for (std::vector<SetupNote> const& run : runs) {
    for (SetupNote const& candidate : run) {
      if (!told.emplace(candidate.kind, candidate.key).second) continue;
      std::vector<SetupNote> alike;
      for (std::vector<SetupNote> const& other : runs) {
        std::ranges::copy_if(other, std::back_inserter(alike), [&](SetupNote const& note) {
          return note.kind == candidate.kind && note.key == candidate.key;
        });
      }
      if (auto text = text_of(alike, runs.size())) texts.push_back(*std::move(text));
    }
  }
  return texts;
}

}  // namespace gridlock
