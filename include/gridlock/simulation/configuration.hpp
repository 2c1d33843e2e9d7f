#pragma once

/// \file
/// All settings of a run.
///
/// ```cpp
/// Configuration configuration;
/// configuration.disks = {.count = 100, .packing_fraction = 0.5, .start = StartKind::triangular};
/// configuration.engine.kind = "tiled";
/// configuration.run.steps = 200;
/// ```

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gridlock/core/setting.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/io/settings_file.hpp"
#include "gridlock/lattice/start.hpp"
#include "gridlock/observe/observable.hpp"
#include "gridlock/protocol/settings.hpp"
#include "gridlock/simulation/detail/model_kind.hpp"
#include "gridlock/simulation/detail/trajectory_settings.hpp"

namespace gridlock {

/// The settings `[run]`: the run ends when it reaches the first of its three lengths.
struct RunSettings {
  std::optional<std::uint64_t> steps;  ///< default: 10,000 if no other length is given
  std::optional<double> time;
  std::optional<double> collisions_per_disk;  ///< 2 · pair collisions / N
  std::uint64_t seed = 1;
  bool final_state = true;  ///< whether final.xyz is written
};
void describe(RunSettings& settings, SettingVisitor& visitor);

/// The settings `[checkpoint]`: the time between checkpoints. An interrupted run always writes a checkpoint.
struct CheckpointSettings {
  double every_seconds = 60.0;    ///< real time; 0: never
  std::uint64_t every_steps = 0;  ///< checked after every chunk of steps; 0: never
  bool keep_last = true;          ///< whether a finished run keeps a checkpoint, from which it can be lengthened
  std::uint64_t keep_states = 0;  ///< number of states along the run that are kept for `gridlock verify --windows`
};
void describe(CheckpointSettings& settings, SettingVisitor& visitor);

/// The settings `[model]`: the model of the run.
struct ModelSettings {
  std::string kind = "disks";
  std::uint64_t verify_every = 0;  ///< steps between comparisons of searches with brute force; 0: never
};
void describe(ModelSettings& settings, SettingVisitor& visitor);

/// All settings of a run, one member per table of the TOML file.
struct Configuration {
  BoxSettings box;
  ModelSettings model;
  DisksSettings disks;
  VelocitySettings velocities;
  EngineSettings engine;
  SoftSettings soft;
  std::vector<StageSettings> protocol;  ///< stages before the run
  RunSettings run;
  ObserveSettings observe;
  CheckpointSettings checkpoint;
  TrajectorySettings trajectory;
  ModelKinds models = known_models();  ///< each with settings in a table of its own

  /// Returns the model of the run. Errors: Error for a model that this program does not have.
  [[nodiscard]] ModelKind const& kind() const;
};
/// Describes the tables of settings of every run, then those of each model in `models`.
void describe(Configuration& configuration, SettingVisitor& visitor);

/// Returns describe() of a configuration as a function, for reading and writing settings files.
Describe describing(Configuration& configuration);

/// Returns the configuration of a settings file, with defaults for settings that the file leaves out.
/// Errors: Error with the place in the file of every key, type or value that cannot be used.
Configuration read_configuration(SettingsFile const& file);

}  // namespace gridlock
