#include "gridlock/command_line.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <new>
#include <string>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/run/run_directory.hpp"
#include "verbs.hpp"

namespace gridlock {

namespace {

using cli::ExitCode;

/// What CLI11 found wrong, in our words where the verb is missing or unknown.
void print_usage_error(CLI::App const& app, CLI::ParseError const& error, std::string const& first_word) {
  if (!app.get_subcommands().empty()) {
    fmt::print(stderr, "error: {}\n  hint: {} {} --help shows what there is\n", error.what(), cli::program_name(),
               app.get_subcommands().front()->get_name());
    return;
  }
  std::vector<std::string> verbs;
  for (CLI::App const* verb : app.get_subcommands({})) verbs.push_back(verb->get_name());
  std::string const what = first_word.empty()            ? cli::program_name() + " needs a verb"
                           : first_word.starts_with("-") ? std::string(error.what())
                                                         : fmt::format("there is no verb \"{}\"", first_word);
  fmt::print(stderr, "error: {}\n  hint: the verbs are {}; {} --help explains them\n", what, fmt::join(verbs, ", "),
             cli::program_name());
}

ExitCode run_command_line(int argc, char** argv) {
  if (argc > 0) cli::set_program_name(std::filesystem::path(argv[0]).filename().string());
  CLI::App app{"gridlock: many moving disks that only feel their neighbours", cli::program_name()};
  app.set_version_flag("--version", std::string("gridlock ") + gridlock::version());
  app.require_subcommand(1);
  app.failure_message(CLI::FailureMessage::help);
  ExitCode exit_code = ExitCode::good;
  cli::add_run(app, exit_code);
  cli::add_resume(app, exit_code);
  cli::add_sweep(app, exit_code);
  cli::add_collect(app, exit_code);
  cli::add_paper(app, exit_code);
  cli::add_check(app, exit_code);
  cli::add_explain(app, exit_code);
  cli::add_info(app, exit_code);
  cli::add_plot(app, exit_code);
  cli::add_export(app, exit_code);
  cli::add_movie(app, exit_code);
  app.footer(fmt::format("Start with:  {0} paper --quick    or    {0} explain", cli::program_name()));
  try {
    app.parse(argc, argv);
  } catch (CLI::ParseError const& error) {
    if (error.get_exit_code() == 0) {  // --help and --version
      app.exit(error);
      return ExitCode::good;
    }
    print_usage_error(app, error, argc > 1 ? argv[1] : "");
    return ExitCode::bad_input;
  }
  return exit_code;
}

}  // namespace

int command_line(int argc, char** argv) {
  try {
    return static_cast<int>(run_command_line(argc, argv));
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

}  // namespace gridlock
