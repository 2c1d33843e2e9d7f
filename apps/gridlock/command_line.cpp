#include "gridlock/command_line.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <functional>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/core/target.hpp"
#include "gridlock/core/version.hpp"
#include "gridlock/engine/device.hpp"
#include "other_program.hpp"
#include "usage_error.hpp"
#include "verbs.hpp"

namespace gridlock {

namespace {

using cli::ExitCode;

/// Refuses empty texts as values of options, since they come from mistakes such as an unset shell variable.
void refuse_empty_values(CLI::App& app) {
  for (CLI::App* const verb : app.get_subcommands({})) {
    for (CLI::Option* const option : verb->get_options()) {
      if (option->get_items_expected_max() > 0) option->check(cli::not_empty());
    }
  }
}

/// Turns `help` into --help and `help WORD` into WORD --help.
std::vector<std::string> without_help(std::vector<std::string> words) {
  if (words.empty() || words.front() != "help") return words;
  words.erase(words.begin());
  words.insert(words.empty() ? words.begin() : words.begin() + 1, "--help");
  return words;
}

bool has_command(CLI::App& app, std::string const& word) {
  return !app.get_subcommands([&](CLI::App const* command) { return command->check_name(word); }).empty();
}

/// A command of Gridlock that is a separate program, with its text in the help.
struct OtherCommand {
  std::string_view name;
  char const* documentation;
  char const* group;
};

constexpr char const* python_commands = "Commands of the Python package";
constexpr std::array<OtherCommand, 6> other_commands{
    {{"view", "Show a run, a sweep or a file in the browser, also while it is written", "Commands for the browser"},
     {"plot", "Draw the pictures of a run, sweep or packing from its data", python_commands},
     {"show", "Show a model in Python, or settings, in the browser while it runs", python_commands},
     {"paper", "Make the paper's Figures 4 to 7 and check its claims", python_commands},
     {"jam", "Jam disks by quench, growth and decompression, shear them, and compare with published numbers",
      python_commands},
     {"melt", "Melt hard disks and compare pressures, order and defects with published numbers", python_commands}}};

bool is_other_command(std::string_view word) {
  return std::ranges::find(other_commands, word, &OtherCommand::name) != other_commands.end();
}

/// Returns where to get a missing program.
std::string origin_of(std::string_view command) {
  if (command != "view") return cli::python_package(command);
  return "it is built where cpp-httplib is installed (Debian: libcpp-httplib-dev)";
}

/// Replaces this process by the program of the first word, if that is a command of another program. Errors: Error if a
/// separate program of Gridlock is missing.
void hand_over(CLI::App& app, std::vector<std::string> const& words) {
  if (words.empty() || (has_command(app, words.front()) && !is_other_command(words.front()))) return;
  std::filesystem::path const program = cli::find_other_program(words.front());
  if (!program.empty()) cli::become(program, {words.begin() + 1, words.end()});
  if (!is_other_command(words.front())) return;
  throw Error({.what = fmt::format("the program gridlock-{} is not installed", words.front()),
               .hint = origin_of(words.front())});
}

/// Adds other programs to the help. Only the help searches for them, since that takes time.
void add_other_programs(CLI::App& app) {
  for (std::string const& word : cli::other_programs()) {
    if (has_command(app, word)) continue;
    app.add_subcommand(word, fmt::format("The program gridlock-{}", word))->group("Other programs");
  }
}

/// Sets what the command lines of all programs of Gridlock have in common.
void set_up_app(CLI::App& app, std::string const& name) {
  // target() is called for every command, so that an invalid name of instructions is refused before a run.
  std::string const instructions = to_text(target());
  app.set_version_flag("--version", [name, instructions] {
    std::string text = fmt::format("{} {}, instructions: {}", name, version(), instructions);
    if (std::optional<DeviceInfo> const device = find_device()) text += fmt::format(", device: {}", device->name);
    return text;
  });
  app.get_formatter()->label("SUBCOMMAND", "COMMAND");
  app.require_subcommand(1);
  app.failure_message(CLI::FailureMessage::help);
}

/// Parses the words, which carries out the command. Errors: Error for invalid words.
void parse(CLI::App& app, std::vector<std::string> const& words, bool lists_other_programs) {
  try {
    app.parse(std::vector<std::string>(words.rbegin(), words.rend()));  // CLI11 takes words from the end
  } catch (CLI::ParseError const& error) {
    bool const is_version = dynamic_cast<CLI::CallForVersion const*>(&error) != nullptr;
    if (lists_other_programs && !is_version && app.get_subcommands().empty()) add_other_programs(app);
    if (error.get_exit_code() == 0) {  // true for --help and --version
      app.exit(error);
      return;
    }
    throw Error(cli::usage_problem(app, error, words.empty() ? "" : words.front()));
  }
}

std::vector<std::string> words_of(int argc, char** argv) {
  return without_help({argv + std::min(argc, 1), argv + argc});
}

ExitCode run_command_line(int argc, char** argv) {
  cli::set_program_name_of(argc, argv);
  CLI::App app{"gridlock: simulates many agents that interact only with nearby neighbours", cli::program_name()};
  set_up_app(app, "gridlock");
  ExitCode exit_code = ExitCode::good;
  cli::add_run(app, exit_code);
  cli::add_resume(app, exit_code);
  cli::add_sweep(app, exit_code);
  cli::add_collect(app, exit_code);
  cli::add_check(app, exit_code);
  cli::add_explain(app, exit_code);
  cli::add_info(app, exit_code);
  cli::add_verify(app, exit_code);
  cli::add_export(app, exit_code);
  cli::add_movie(app, exit_code);
  cli::add_contacts(app, exit_code);
  refuse_empty_values(app);
  for (CLI::App* const command : app.get_subcommands({})) command->group("Commands");
  for (auto const& [name, documentation, group] : other_commands) {
    app.add_subcommand(std::string(name), documentation)->group(group);
  }
  app.footer(fmt::format("Start with:  {} explain", cli::program_name()));
  std::vector<std::string> const words = words_of(argc, argv);
  hand_over(app, words);
  parse(app, words, true);
  return exit_code;
}

std::uint64_t hash_of(std::vector<std::string> const& words) {
  std::string all;
  for (std::string const& word : words) all.append(word).push_back('\0');
  return std::hash<std::string>{}(all);
}

/// Carries out a command on several processes.
ExitCode run_command_line_of_crew(int argc, char** argv, cli::CrewOptions crew) {
  cli::set_program_name_of(argc, argv);
  std::vector<std::string> const words = words_of(argc, argv);
  crew.command_hash = hash_of(words);
  CLI::App app{"gridlock-mpi: simulates on many machines; start it with mpirun or srun", cli::program_name()};
  set_up_app(app, "gridlock-mpi");
  ExitCode exit_code = ExitCode::good;
  cli::add_run(app, exit_code, &crew);
  cli::add_resume(app, exit_code, &crew);
  cli::add_sweep(app, exit_code, &crew);
  refuse_empty_values(app);
  for (CLI::App* const command : app.get_subcommands({})) command->group("Commands");
  std::string const all = cli::name_with_all_commands();
  app.footer(fmt::format("All other commands are those of {}.", all));
  bool const is_command = !words.empty() && !words.front().starts_with('-');
  if (is_command && !has_command(app, words.front())) {
    throw Error({.what = fmt::format("{} has no command \"{}\"", cli::program_name(), words.front()),
                 .hint = fmt::format("it has run, resume and sweep; all others are those of {0}: {0} {1}", all,
                                     words.front())});
  }
  parse(app, words, false);
  return exit_code;
}

/// Carries out the only command of a separate program; error messages refer to it as a command of gridlock.
ExitCode run_command_line_of_one(int argc, char** argv, std::string const& name, cli::AddCommand add) {
  cli::set_program_name("gridlock");
  CLI::App app{"gridlock", "gridlock"};
  set_up_app(app, "gridlock");
  ExitCode exit_code = ExitCode::good;
  add(app, exit_code);
  refuse_empty_values(app);
  std::vector<std::string> words{name};
  words.insert(words.end(), argv + std::min(argc, 1), argv + argc);
  parse(app, words, false);
  return exit_code;
}

/// Prints an error without throwing if standard error is full, since the exit code also reports the failure.
void print_error(std::string const& text) { std::fputs(fmt::format("error: {}\n", text).c_str(), stderr); }

/// Returns the exit code after output. It reports a failure if standard output was not written completely.
ExitCode after_printing(ExitCode exit_code) {
  bool const is_flushed = std::fflush(stdout) == 0;
  int const why = errno;
  if (is_flushed && std::ferror(stdout) == 0) return exit_code;
  print_error(fmt::format("cannot write to standard output: {}\n  hint: what was printed is not complete",
                          is_flushed ? "an earlier write failed" : std::strerror(why)));
  return exit_code == ExitCode::good ? ExitCode::run_failed : exit_code;
}

/// The reason why a command failed; an empty text if it succeeded.
struct Failure {
  ExitCode exit_code = ExitCode::good;
  std::string text;
  bool is_of_printing = false;  ///< after_printing() prints the reason
};

Failure failure_of(std::exception const& error) {
  if (auto const* const input = dynamic_cast<gridlock::Error const*>(&error)) {
    std::string text;
    for (gridlock::Problem const& problem : input->problems()) {
      text += (text.empty() ? "" : "\nerror: ") + gridlock::to_text(problem);
    }
    return {ExitCode::bad_input, text};
  }
  if (dynamic_cast<std::bad_alloc const*>(&error) != nullptr) {
    return {ExitCode::run_failed, "not enough memory\n  hint: use fewer disks; a run needs about 200 bytes for each"};
  }
  bool const is_of_system = dynamic_cast<std::system_error const*>(&error) != nullptr;
  return {ExitCode::run_failed, error.what(), is_of_system && std::ferror(stdout) != 0};
}

/// Carries out a command and prints its exception.
template <class Command>
Failure guarded(Command command) {
  // At a limit on file size, the signal would end the program without a message; ignored, writing fails instead.
  std::signal(SIGXFSZ, SIG_IGN);
  try {
    return {command(), ""};
  } catch (std::exception const& error) {
    Failure failure = failure_of(error);
    if (!failure.is_of_printing) print_error(failure.text);
    return failure;
  }
}

}  // namespace

int command_line(int argc, char** argv) {
  return static_cast<int>(after_printing(guarded([&] { return run_command_line(argc, argv); }).exit_code));
}

int cli::command_line_of_one(int argc, char** argv, std::string const& name, AddCommand add) {
  return static_cast<int>(
      after_printing(guarded([&] { return run_command_line_of_one(argc, argv, name, add); }).exit_code));
}

int cli::command_line_of_crew(int argc, char** argv, CrewOptions const& crew, std::string& failure) {
  Failure const end = guarded([&] { return run_command_line_of_crew(argc, argv, crew); });
  failure = end.text;
  return static_cast<int>(after_printing(end.exit_code));
}

}  // namespace gridlock
