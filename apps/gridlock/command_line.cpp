#include "gridlock/command_line.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <functional>
#include <new>
#include <string>

#include "gridlock/core/error.hpp"
#include "gridlock/workspace/run_directory.hpp"
#include "usage_error.hpp"
#include "verbs.hpp"

namespace gridlock {

namespace {

using cli::ExitCode;

/// An empty text, as of a shell variable without a value, never means anything.
void refuse_empty_values(CLI::App& app) {
  for (CLI::App* const verb : app.get_subcommands({})) {
    for (CLI::Option* const option : verb->get_options()) {
      if (option->get_items_expected_max() > 0) option->check(cli::not_empty());
    }
  }
}

using AddCommand = std::function<void(CLI::App& app, ExitCode& exit_code)>;

ExitCode run_command_line(int argc, char** argv, AddCommand const& add_more) {
  if (argc > 0) cli::set_program_name(std::filesystem::path(argv[0]).filename().string());
  CLI::App app{"gridlock: simulates many agents that interact only with nearby neighbours", cli::program_name()};
  app.set_version_flag("--version", std::string("gridlock ") + gridlock::version());
  app.get_formatter()->label("SUBCOMMAND", "COMMAND");
  app.require_subcommand(1);
  app.failure_message(CLI::FailureMessage::help);
  ExitCode exit_code = ExitCode::good;
  cli::add_run(app, exit_code);
  cli::add_resume(app, exit_code);
  cli::add_sweep(app, exit_code);
  cli::add_collect(app, exit_code);
  cli::add_check(app, exit_code);
  cli::add_explain(app, exit_code);
  cli::add_info(app, exit_code);
  cli::add_plot(app, exit_code);
  cli::add_export(app, exit_code);
  cli::add_movie(app, exit_code);
  if (add_more) add_more(app, exit_code);
  refuse_empty_values(app);
  for (CLI::App* const command : app.get_subcommands({})) command->group("Commands");
  std::string const example = add_more ? fmt::format("{} paper --quick    or    ", cli::program_name()) : "";
  app.footer(fmt::format("Start with:  {}{} explain", example, cli::program_name()));
  try {
    app.parse(argc, argv);
  } catch (CLI::ParseError const& error) {
    if (error.get_exit_code() == 0) {  // --help and --version
      app.exit(error);
      return ExitCode::good;
    }
    throw Error(cli::usage_problem(app, error, argc > 1 ? argv[1] : ""));
  }
  return exit_code;
}

}  // namespace

int cli::command_line(int argc, char** argv, AddCommand const& add_more) {
  try {
    return static_cast<int>(run_command_line(argc, argv, add_more));
  } catch (gridlock::Error const& error) {
    for (gridlock::Problem const& problem : error.problems()) {
      fmt::print(stderr, "error: {}\n", gridlock::to_text(problem));
    }
    return static_cast<int>(ExitCode::bad_input);
  } catch (std::bad_alloc const&) {
    fmt::print(stderr, "error: not enough memory\n  hint: use fewer disks; a run needs about 200 bytes for each\n");
    return static_cast<int>(ExitCode::run_failed);
  } catch (std::exception const& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return static_cast<int>(ExitCode::run_failed);
  }
}

int command_line(int argc, char** argv) { return cli::command_line(argc, argv, {}); }

}  // namespace gridlock
