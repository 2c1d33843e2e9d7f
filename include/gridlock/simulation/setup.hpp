#pragma once

/// \file
/// From a configuration to a simulation that is ready to run.
///
/// ```cpp
/// Setup const setup = set_up(SettingsFile::from_path("scenes/paper.toml"));
/// for (Event const& note : setup.notes) std::string const text = to_text(note);
/// double const dt = setup.simulation->time_step();
/// ```

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gridlock/core/disks.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/io/settings_file.hpp"
#include "gridlock/parallel/detail/all_processes.hpp"
#include "gridlock/simulation/configuration.hpp"
#include "gridlock/simulation/event.hpp"
#include "gridlock/simulation/run.hpp"
#include "gridlock/simulation/simulation.hpp"

namespace gridlock {

/// A run about to start: the simulation, and the configuration with every choice made, so that it gives the same bits
/// again.
struct Setup {
  Configuration configuration;
  std::unique_ptr<Simulation> simulation;  ///< nothing where SetupOptions::on_slow_start has left the start out
  std::filesystem::path start_file;        ///< the file the state was read from; empty for any other start
  std::vector<Event> notes;
  double cost_of_move = 1.0;  ///< expected, in moves on cells chosen from the sizes
};

/// Whether the user has given a setting.
using IsGiven = std::function<bool(std::string_view key)>;

/// Is told how many seconds a random start will take, where that is long; says whether to make it.
using OnSlowStart = std::function<bool(double seconds)>;

/// The options of a set-up besides its configuration.
struct SetupOptions {
  /// A slow start that is not to be made is left out, or replaced by a lattice of the same disks so that everything
  /// else is checked, and noted. Empty: every start is made.
  OnSlowStart on_slow_start = {};
  std::optional<std::uint64_t> threads = {};  ///< in place of engine.threads, which stays what is recorded
  AllProcesses processes = {};                ///< those that share the run; this one alone, as a rule
  std::optional<State> start = {};            ///< disks start from it, in place of what [disks] asks for
  std::filesystem::path directory = {};       ///< of relative file names; set_up() of a file knows it
  IsGiven is_given = [](std::string_view) { return false; };  ///< set_up() of a file knows it
};

/// Reads the settings and sets up the run they describe.
/// Errors: Error with the place in the file of everything that is wrong: keys, types, bounds, and set-ups that cannot
/// exist or that the engine cannot treat rightly.
/// Cost: with on_slow_start about a second more for random starts of 25,000 disks or more.
Setup set_up(SettingsFile const& file, SetupOptions const& options = {});

/// The same from a configuration made in code; relative file names are taken from the current directory.
Setup set_up(Configuration configuration, SetupOptions const& options = {});

/// Where the run ends.
StopCondition stop_condition_of(Setup const& setup);

/// How far a set-up goes, and what it looks at.
RunPlan plan_of(Setup const& setup);

/// The disks of a set-up. Errors: Error for a set-up of another model.
State const& disks_of(Setup const& setup);

/// Throws Error for a set-up of another model than the one asked for.
[[noreturn]] void throw_other_model(Setup const& setup);

}  // namespace gridlock
