#pragma once

/// \file
/// Makes a simulation that is ready to run from a configuration.
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

/// A run that is ready to start: the simulation, and the resolved configuration, which gives the same bits again.
struct Setup {
  Configuration configuration;
  std::unique_ptr<Simulation> simulation;  ///< nullptr if SetupOptions::on_slow_start left the start out
  std::filesystem::path start_file;        ///< the file from which the state was read; empty for any other start
  std::filesystem::path potential_file;    ///< the file of the rows of a potential; empty for any other potential
  std::vector<Event> notes;
  double cost_of_move = 1.0;  ///< expected cost of a move, relative to a move with cells that the program chooses
};

/// Returns whether the user has given a setting.
using IsGiven = std::function<bool(std::string_view key)>;

/// A function called with the seconds that a long random start will take; returns whether to make the start.
using OnSlowStart = std::function<bool(double seconds)>;

/// The options of a set-up besides its configuration.
struct SetupOptions {
  /// Called before a slow start. If it returns false, the start is left out, or replaced by a lattice of the same disks
  /// so that everything else is checked, with a note. Empty: every start is made.
  OnSlowStart on_slow_start = {};
  std::optional<std::uint64_t> threads = {};  ///< used in place of engine.threads, which is still recorded
  AllProcesses processes = {};                ///< the processes that share the run; default: this process alone
  std::optional<State> start = {};            ///< the start of the disks, in place of the settings [disks]
  std::filesystem::path directory = {};       ///< directory of relative file names; set_up() of a file sets it
  IsGiven is_given = [](std::string_view) { return false; };  ///< set_up() of a file sets it
};

/// Reads the settings and sets up the run they describe.
/// Errors: Error with file, line and column of every mistake: keys, types, bounds, and set-ups that are impossible or
/// that the engine cannot advance correctly.
/// Cost: with on_slow_start about a second more for random starts of 25,000 disks or more.
Setup set_up(SettingsFile const& file, SetupOptions const& options = {});

/// Sets up the run of a configuration made in code; relative file names are in the current directory.
Setup set_up(Configuration configuration, SetupOptions const& options = {});

StopCondition stop_condition_of(Setup const& setup);

/// Returns the plan of the run: its length, samples and equilibration.
RunPlan plan_of(Setup const& setup);

/// Returns the disks of a set-up. Errors: Error for a set-up of another model.
State const& disks_of(Setup const& setup);

/// Throws Error for a set-up whose model is not the expected one.
[[noreturn]] void throw_other_model(Setup const& setup);

}  // namespace gridlock
