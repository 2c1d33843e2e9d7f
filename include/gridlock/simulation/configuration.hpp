#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gridlock/core/setting.hpp"
#include "gridlock/core/state.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/io/settings_file.hpp"
#include "gridlock/lattice/start.hpp"
#include "gridlock/observe/observable.hpp"
#include "gridlock/simulation/model_kind.hpp"
#include "gridlock/simulation/trajectory.hpp"

namespace gridlock {

/// The settings `[run]`: the run ends at whichever of its three lengths comes first.
struct RunSettings {
  std::optional<std::uint64_t> steps;  ///< left out: 10,000 where no other length is given
  std::optional<double> time;
  std::optional<double> collisions_per_disk;  ///< 2 · pair collisions / N
  std::uint64_t seed = 1;
  bool final_state = true;  ///< whether final.xyz is written
};
void describe(RunSettings& settings, SettingVisitor& visitor);

/// The settings `[checkpoint]`: how often a run in a directory saves itself, besides when it is interrupted.
struct CheckpointSettings {
  double every_seconds = 60.0;    ///< of real time; 0: never
  std::uint64_t every_steps = 0;  ///< looked at after every chunk of work; 0: never
  bool keep_last = true;          ///< whether a finished run keeps one, to be lengthened
};
void describe(CheckpointSettings& settings, SettingVisitor& visitor);

/// The settings `[model]`: which model is run, where it is not the disks.
struct ModelSettings {
  std::string kind;                ///< empty: disks
  std::uint64_t verify_every = 0;  ///< steps between two in which neighbour searches are compared with brute force
};
void describe(ModelSettings& settings, SettingVisitor& visitor);

/// Everything a run is made from, one member per table of the TOML file.
struct Configuration {
  BoxSettings box;
  DisksSettings disks;
  VelocitySettings velocities;
  EngineSettings engine;
  RunSettings run;
  ObserveSettings observe;
  CheckpointSettings checkpoint;
  TrajectorySettings trajectory;
  ModelSettings model;
  ModelKinds models = known_models();  ///< each described in a table of its own

  [[nodiscard]] bool is_of_model() const { return !model.kind.empty(); }
};
/// All tables; for a run of a model those that matter to it.
void describe(Configuration& configuration, SettingVisitor& visitor);

/// describe() of a configuration as the io layer takes it.
Describe describing(Configuration& configuration);

/// What a note on a set-up is about.
enum class NoteKind {
  unused_setting,     ///< a setting was given on which nothing of the run depends
  misleading_rule,    ///< the engine has a time step where that is known to mislead
  frames_beyond_end,  ///< frames are asked for that lie beyond the end of the run
  nothing_moves,      ///< no disk has a velocity
  start_not_tried,    ///< the start takes long and was left out
};

/// Something worth telling of a set-up that can be run all the same.
struct SetupNote {
  NoteKind kind = NoteKind::unused_setting;
  std::string key;  ///< the setting to look at
  std::string text;
  bool is_default = false;  ///< an unused setting with the value it has anyway, as in a resolved configuration
};

/// What to tell of the notes of several runs. Unused settings are told of where they are unused in every run and one run
/// gives another value than the default: a sweep over engines sets what only some of them need. Of other notes it is told in
/// how many runs they hold.
std::vector<std::string> notes_on(std::vector<std::vector<SetupNote>> const& runs);

/// A run about to start: the state, and the configuration with every choice made, so that it gives the same bits again.
struct Setup {
  Configuration configuration;
  State state;
  std::filesystem::path start_file;  ///< the file the state was read from; empty for a lattice or random start
  std::vector<SetupNote> notes = {};
};

/// The configuration that the settings give, with the defaults for what they leave out.
/// Errors: Error with the place in the file of every key, type or value that cannot be used.
Configuration read_configuration(SettingsFile const& file);

/// Reads the settings and sets up the run they describe.
/// Errors: Error with the place in the file of everything that is wrong: keys, types, bounds, and set-ups that cannot
/// exist or that the engine cannot treat rightly.
Setup set_up(SettingsFile const& file);

/// Is told how many seconds a random start will take, where that is long; says whether to make it.
using OnSlowStart = std::function<bool(double seconds)>;

/// The same. A slow start that is not to be made is replaced by a lattice of the same disks, so that everything else is
/// checked, and noted. Cost: about a second more for random starts of 25,000 disks or more.
Setup set_up(SettingsFile const& file, OnSlowStart const& on_slow_start);

/// The same from a configuration made in code; relative file names are taken from the current directory.
Setup set_up(Configuration const& configuration);

/// Where the run ends.
StopCondition stop_condition_of(Setup const& setup);

}  // namespace gridlock
