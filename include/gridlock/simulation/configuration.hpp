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

/// The settings `[model]`: which model is run.
struct ModelSettings {
  std::string kind = "disks";
  std::uint64_t verify_every = 0;  ///< steps between two in which neighbour searches are compared with brute force
};
void describe(ModelSettings& settings, SettingVisitor& visitor);

/// Everything a run is made from, one member per table of the TOML file.
struct Configuration {
  BoxSettings box;
  ModelSettings model;
  DisksSettings disks;
  VelocitySettings velocities;
  EngineSettings engine;
  SoftSettings soft;
  std::vector<StageSettings> protocol;  ///< before the run
  RunSettings run;
  ObserveSettings observe;
  CheckpointSettings checkpoint;
  TrajectorySettings trajectory;
  ModelKinds models = known_models();  ///< each described in a table of its own

  /// The model that is run. Errors: Error for one that this program does not have.
  [[nodiscard]] ModelKind const& kind() const;
};
/// Describes the tables of settings that every run has, then those of each model that the configuration may be of.
void describe(Configuration& configuration, SettingVisitor& visitor);

/// describe() of a configuration as the io layer takes it.
Describe describing(Configuration& configuration);

/// The configuration that the settings give, with the defaults for what they leave out.
/// Errors: Error with the place in the file of every key, type or value that cannot be used.
Configuration read_configuration(SettingsFile const& file);

}  // namespace gridlock
