#include "run/idle_settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>

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

bool is_one_of(std::string_view name, std::vector<std::string_view> const& names) {
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

}  // namespace

std::vector<IdleSetting> idle_settings(Configuration const& configuration,
                                       std::function<bool(std::string_view)> const& is_given) {
  std::vector<IdleSetting> idle;
  bool const is_of_model = configuration.is_of_model();
  std::string const choice = is_of_model ? fmt::format("model.kind = \"{}\"", configuration.model.kind)
                                         : fmt::format("engine.kind = \"{}\"", configuration.engine.kind);
  for (EngineSetting const& setting : settings_of(configuration.engine)) {
    std::string key = fmt::format("engine.{}", setting.name);
    if (is_used(configuration, setting.name) || !is_given(key)) continue;
    // Coarse neighbourhoods are shown in the picture of the start, whatever finds the neighbours.
    bool const is_drawn = setting.name == "cells" && !is_of_model;
    idle.push_back({.key = std::move(key),
                    .why = fmt::format("has no effect{} with {}", is_drawn ? " on the disks" : "", choice),
                    .is_default = setting.is_default});
  }
  if (!is_of_model && is_given("model.verify_every")) {
    idle.push_back({.key = "model.verify_every",
                    .why = "has no effect without model.kind",
                    .is_default = configuration.model.verify_every == 0});
  }
  return idle;
}

std::vector<std::string> notes_on(std::vector<std::vector<IdleSetting>> const& runs) {
  std::vector<std::string> notes;
  if (runs.empty()) return notes;
  for (IdleSetting const& candidate : runs.front()) {
    bool is_idle = true;
    bool is_alike = true;
    bool is_default = true;
    for (std::vector<IdleSetting> const& run : runs) {
      auto const found = std::ranges::find(run, candidate.key, &IdleSetting::key);
      is_idle = is_idle && found != run.end();
      if (!is_idle) break;
      is_alike = is_alike && found->why == candidate.why;
      is_default = is_default && found->is_default;
    }
    if (!is_idle || is_default) continue;
    notes.push_back(is_alike ? candidate.text() : fmt::format("{} has no effect in any run", candidate.key));
  }
  return notes;
}

}  // namespace gridlock
