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

namespace CLI {  // <CLI/CLI.hpp> takes a compiler seconds, and a main function needs none of it
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
  run_failed = 1,  ///< the run failed or was stopped; its partial results have been written
  bad_input = 2,   ///< the user's input cannot be used; nothing was written
};

/// The processes that run a command together, and what they are told before they meet.
struct CrewOptions {
  SweepCrew& crew;
  std::function<void(std::size_t)> set_runs_at_a_time;  ///< that each makes
  std::function<void(std::size_t)>
      set_processes_of_run;            ///< SweepCrew::processes_of_run(), all where there are not as many
  bool has_threads_that_send = false;  ///< also other threads than the first may call MPI
  std::uint64_t command_hash = 0;      ///< of the command line, which must be the same for all
};

/// Each adds its command to the command line; parsing it runs the command and leaves how it ended in `exit_code`.
/// With a crew, processes of which this is one carry it out together.
void add_run(CLI::App& app, ExitCode& exit_code, CrewOptions const* crew = nullptr);
void add_resume(CLI::App& app, ExitCode& exit_code, CrewOptions const* crew = nullptr);
void add_sweep(CLI::App& app, ExitCode& exit_code, CrewOptions const* crew = nullptr);
void add_collect(CLI::App& app, ExitCode& exit_code);
void add_check(CLI::App& app, ExitCode& exit_code);
void add_explain(CLI::App& app, ExitCode& exit_code);
void add_info(CLI::App& app, ExitCode& exit_code);
void add_export(CLI::App& app, ExitCode& exit_code);
void add_movie(CLI::App& app, ExitCode& exit_code);
void add_contacts(CLI::App& app, ExitCode& exit_code);

/// As those above.
using AddCommand = void (*)(CLI::App& app, ExitCode& exit_code);

/// The command line of a program gridlock-NAME that has one command of Gridlock, NAME: its help and its errors are
/// those of
/// `gridlock NAME`. Returns the exit code.
int command_line_of_one(int argc, char** argv, std::string const& name, AddCommand add);

/// The command line of one of several processes that carry out a command together. `failure` is what it printed of its
/// end; empty where it ended well. Returns the exit code.
int command_line_of_crew(int argc, char** argv, CrewOptions const& crew, std::string& failure);

/// The name the program was started by, for messages that say what to type; "gridlock" before it is known.
std::string const& program_name();
void set_program_name(std::string name);
/// The first word of a command line, without its folder.
void set_program_name_of(int argc, char** argv);
/// The program that has all commands: NAME beside NAME-mpi, otherwise this one.
std::string name_with_all_commands();

/// Accepts whole numbers in a range. CLI11's own validators speak of floating-point ranges and take −1 for 2⁶⁴ − 1.
CLI::Validator whole_number(std::uint64_t least, std::uint64_t most = std::numeric_limits<std::uint64_t>::max());
/// Accepts one of a few words.
CLI::Validator one_of(std::vector<std::string> const& words);
/// Refuses an empty text.
CLI::Validator not_empty();

/// The trajectory meant by the directory of a run, or by its own name.
/// Errors: Error for a directory of a run that kept no frames.
std::filesystem::path trajectory_file(std::string const& path);

/// Tells on the error stream what the trajectory of another program has and H5mdReader does not read.
void print_note_on_left_out(std::filesystem::path const& source, gridlock::H5mdReader const& trajectory);

/// A configuration file and the `--set` options on top of it: what run, sweep and check have in common.
struct ConfigurationOptions {
  std::string file;
  std::vector<std::string> assignments;

  void add_to(CLI::App& verb);
  [[nodiscard]] gridlock::SettingsFile read() const;
};

/// Where results go, and whether they may replace others.
struct OutputOptions {
  std::string directory;
  bool overwrites = false;

  void add_to(CLI::App& verb, std::string const& default_directory);
  /// The directory asked for, or results/<stem>.
  [[nodiscard]] std::filesystem::path directory_for(std::string const& stem) const;
};

}  // namespace gridlock::cli
