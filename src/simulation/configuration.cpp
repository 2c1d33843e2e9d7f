#include "gridlock/simulation/configuration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "gridlock/core/error.hpp"
#include "simulation/lacking.hpp"

namespace gridlock {

namespace {

std::string names_of(ModelKinds const& kinds) {
  std::string names;
  for (auto const& kind : kinds.all()) names += fmt::format("{}\"{}\"", names.empty() ? "" : ", ", kind->name());
  return names;
}

Problem unknown_model(Configuration const& configuration) {
  auto const instead = instead_of_model(configuration.model.kind);
  return {.what = fmt::format("there is no model \"{}\" in this program", configuration.model.kind),
          .hint = instead.value_or(
              fmt::format("its models are {}; a model of one's own in C++ runs in the program that registers it, see "
                          "docs/getting_started/own_model.md, and one in Python after register_model: a run of it is "
                          "continued by gridlock.open(DIR).resume() and verified by gridlock.verify(DIR), see "
                          "docs/getting_started/own_model_python.md",
                          names_of(configuration.models))),
          .key = "model.kind"};
}

/// Returns whether a problem concerns a table or a setting in it.
bool is_about_table(Problem const& problem, std::string const& table) {
  return problem.key == table || problem.key.starts_with(table + ".");
}

template <class Settings>
void describe_table(SettingVisitor& visitor, std::string_view name, std::string_view documentation,
                    Settings& settings) {
  visitor.enter(name, documentation);
  describe(settings, visitor);
  visitor.leave();
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
                 .min = 0.0,
                 .default_note = "no limit"},
                settings.time);
  visitor.visit({.key = "collisions_per_disk",
                 .documentation = "Length of the run in collisions every disk has had on average.",
                 .min = 0.0,
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
       .documentation = "How often a run saves itself, so that gridlock resume can continue from there; 0 for never.",
       .min = 0.0},
      settings.every_seconds);
  visitor.visit({.key = "every_steps",
                 .documentation = "Besides, a checkpoint whenever about this many steps have passed; 0 for none."},
                settings.every_steps);
  visitor.visit(
      {.key = "keep_last",
       .documentation = "Whether a finished run keeps its last checkpoint, with which gridlock resume --steps "
                        "lengthens it."},
      settings.keep_last);
  visitor.visit({.key = "keep_states",
                 .documentation = "How many states, spread evenly along the run, are kept in states/, from which "
                                  "gridlock verify --windows replays parts of the run; 0 for none.",
                 .max = 10'000},
                settings.keep_states);
}

void describe(ModelSettings& settings, SettingVisitor& visitor) {
  visitor.visit({.key = "kind",
                 .documentation = "The model to run, such as \"flocking\", whose settings are in a table of that name; "
                                  "\"disks\" are hard disks."},
                settings.kind);
  // Earlier versions wrote an empty kind for disks.
  if (settings.kind.empty()) settings.kind = ModelSettings().kind;
  visitor.visit({.key = "verify_every",
                 .documentation = "Steps between two in which every neighbour search is compared with a look at all "
                                  "agents; 0 for none."},
                settings.verify_every);
}

ModelKind const& Configuration::kind() const {
  ModelKind const* const found = models.find(model.kind);
  if (found == nullptr) throw Error(unknown_model(*this));
  return *found;
}

void describe(Configuration& configuration, SettingVisitor& visitor) {
  describe_table(visitor, "box", "The rectangle the agents live in.", configuration.box);
  describe_table(visitor, "model", "Which model is run.", configuration.model);
  // A table that several models share is described by the first of them.
  std::set<std::string> described;
  for (auto const& kind : configuration.models.all()) {
    for (SettingTable const& table : kind->tables(configuration)) {
      if (!described.insert(table.name).second) continue;
      visitor.enter(table.name, table.documentation);
      table.describe(visitor);
      visitor.leave();
    }
  }
  visitor.visit_tables(
      {.key = "walls",
       .documentation = "Walls inside the box, for hard disks: lines of which disks meet both sides and both ends.",
       .default_note = "none"},
      configuration.engine.walls.size(), [&](std::size_t count) { configuration.engine.walls.resize(count); },
      [&](std::size_t k, SettingVisitor& inner) { describe(configuration.engine.walls[k], inner); });
  visitor.visit_tables(
      {.key = "protocol",
       .documentation = "What happens to the disks before the run, stage by stage; with a protocol, the run has no "
                        "length unless [run] "
                        "gives one.",
       .default_note = "nothing happens"},
      configuration.protocol.size(), [&](std::size_t count) { configuration.protocol.resize(count); },
      [&](std::size_t k, SettingVisitor& inner) { describe(configuration.protocol[k], inner); });
  describe_table(visitor, "run", "How long the run lasts, and its seed.", configuration.run);
  describe_table(visitor, "observe", "What is measured, and how often.", configuration.observe);
  describe_table(visitor, "checkpoint", "When a run saves checkpoints.", configuration.checkpoint);
  describe_table(visitor, "trajectory", "Which frames of a run are kept in trajectory.h5.", configuration.trajectory);
}

Describe describing(Configuration& configuration) {
  return [&configuration](SettingVisitor& visitor) { describe(configuration, visitor); };
}

Configuration read_configuration(SettingsFile const& file) {
  Configuration configuration;
  std::vector<Problem> problems;
  try {
    file.read_into(describing(configuration));
  } catch (Error const& error) {
    problems = error.problems();
  }
  for (Problem& problem : problems) {
    // A hint on a similar name or on another table is more useful than a sentence about a missing feature.
    bool const is_like_nothing = problem.what.starts_with("there is no ") &&
                                 !problem.hint.starts_with("did you mean") &&
                                 problem.hint.find(" belongs in ") == std::string::npos;
    auto const lacking = sentence_on_lacking(problem.key.substr(problem.key.rfind('.') + 1));
    if (is_like_nothing && lacking) problem.hint = *lacking;
    if (auto const instead = instead_of_model(problem.key.substr(0, problem.key.find('.')))) problem.hint = *instead;
  }
  if (configuration.models.find(configuration.model.kind) == nullptr) {
    // The model's table is reported as unknown only because the model is unknown.
    std::erase_if(problems, [&](Problem const& other) { return is_about_table(other, configuration.model.kind); });
    std::vector<Problem> const unknown = file.locate(Error(unknown_model(configuration))).problems();
    problems.insert(problems.begin(), unknown.begin(), unknown.end());
  }
  if (!problems.empty()) throw Error(std::move(problems));
  return configuration;
}

}  // namespace gridlock
