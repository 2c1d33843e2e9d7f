#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "gridlock/io/settings_file.hpp"
#include "gridlock/workspace/sweep.hpp"

namespace CLI {  // including <CLI/CLI.hpp> takes seconds, and main functions do not need it
class App;
class Validator;
}  // namespace CLI

namespace gridlock {
class H5mdReader;
}  // namespace gridlock

namespace gridlock::cli {

/// Exit code of a command.
enum class ExitCode : int {
  good = 0,
  run_failed = 1,  ///< the run failed or was stopped; partial results have been written
  bad_input = 2,   ///< the user's input is invalid; nothing was written
};

/// The processes that carry out a command together, and their settings before SweepCrew::meet().
struct CrewOptions {
  SweepCrew& crew;
  std::function<void(std::size_t)> set_runs_at_a_time;  ///< simultaneous runs in each process
  std::function<void(std::size_t)>
      set_processes_of_run;            ///< SweepCrew::processes_of_run(); all processes if there are fewer
  bool has_threads_that_send = false;  ///< whether threads other than the main thread may call MPI
  std::uint64_t command_hash = 0;      ///< hash of the command line, equal in all processes
};

/// Each function adds its command to the command line. Parsing carries out the command and stores its exit code in
/// `exit_code`. With a crew, several processes carry it out together.
void add_run(CLI::App& app, ExitCode& exit_code, CrewOptions const* crew = nullptr);
void add_resume(CLI::App& app, ExitCode& exit_code, CrewOptions const* crew = nullptr);
void add_sweep(CLI::App& app, ExitCode& exit_code, CrewOptions const* crew = nullptr);
void add_collect(CLI::App& app, ExitCode& exit_code);
void add_check(CLI::App& app, ExitCode& exit_code);
void add_explain(CLI::App& app, ExitCode& exit_code);
void add_verify(CLI::App& app, ExitCode& exit_code);
void add_info(CLI::App& app, ExitCode& exit_code);
void add_export(CLI::App& app, ExitCode& exit_code);
void add_movie(CLI::App& app, ExitCode& exit_code);
void add_contacts(CLI::App& app, ExitCode& exit_code);

/// The type of these functions, for commands without a crew.
using AddCommand = void (*)(CLI::App& app, ExitCode& exit_code);

/// Parses and carries out the command line of a program gridlock-NAME, which has only the command NAME. Help and errors
/// are those of `gridlock NAME`. Returns the exit code.
int command_line_of_one(int argc, char** argv, std::string const& name, AddCommand add);

/// Parses and carries out the command line of one of several processes. `failure` gets the text of the error; empty if
/// the command succeeded. Returns the exit code.
int command_line_of_crew(int argc, char** argv, CrewOptions const& crew, std::string& failure);

/// Returns the name by which the program was started, for hints on commands; "gridlock" before it is set.
std::string const& program_name();
void set_program_name(std::string name);
/// Sets the name of the program to the first word of a command line, without its directory.
void set_program_name_of(int argc, char** argv);
/// Returns the name of the program with all commands: NAME for a program NAME-mpi, otherwise this program.
std::string name_with_all_commands();

/// Accepts whole numbers in a range. CLI11's validators mention floating-point ranges and read −1 as 2⁶⁴ − 1.
CLI::Validator whole_number(std::uint64_t least, std::uint64_t most = std::numeric_limits<std::uint64_t>::max());
/// Accepts one of the given words.
CLI::Validator one_of(std::vector<std::string> const& words);
/// Refuses an empty text.
CLI::Validator not_empty();

/// Returns the trajectory in the directory of a run, or the path itself if it is no directory. Errors: Error if the run
/// has no trajectory.
std::filesystem::path trajectory_file(std::string const& path);

/// Prints a note on data in another program's trajectory that H5mdReader does not read.
void print_note_on_left_out(std::filesystem::path const& source, gridlock::H5mdReader const& trajectory);

/// A configuration file with `--set` options, as the commands run, sweep and check take them.
struct ConfigurationOptions {
  std::string file;
  std::vector<std::string> assignments;

  void add_to(CLI::App& verb);
  [[nodiscard]] gridlock::SettingsFile read() const;
};

/// The output directory, and whether files of other origin may be replaced there.
struct OutputOptions {
  std::string directory;
  bool overwrites = false;

  void add_to(CLI::App& verb, std::string const& default_directory);
  /// Returns the given directory, or else results/<stem>.
  [[nodiscard]] std::filesystem::path directory_for(std::string const& stem) const;
};

}  // namespace gridlock::cli
