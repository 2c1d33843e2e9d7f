#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "gridlock/core/disks.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/workspace/run_directory.hpp"
#include "gridlock/workspace/sweep.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace gridlock::cli {

namespace {

std::string in_words(gridlock::Box const& box) {
  return fmt::format("{} box {} × {}", box.is_periodic() ? "periodic" : "walled", box.width(), box.height());
}

/// "packing fraction 0.7, radius 0.016, " of agents that have one; else empty.
std::string sizes_in_words(gridlock::Simulation const& simulation) {
  gridlock::AgentsView const agents = simulation.view();
  if (!agents.has<gridlock::Radius>() || agents.empty()) return "";
  auto const [smallest, largest] = std::ranges::minmax(agents.column<gridlock::Radius>());
  return fmt::format("packing fraction {:.6g}, radius {:.6g}{}, ",
                     gridlock::covered_area(agents) / simulation.box().area(), smallest,
                     largest > smallest ? fmt::format(" to {:.6g}", largest) : "");
}

void print_setup(gridlock::Setup const& setup) {
  gridlock::Configuration const& configuration = setup.configuration;
  gridlock::ModelKind const& kind = configuration.kind();
  if (setup.simulation == nullptr) {
    fmt::print("{}, {}\n", in_words(gridlock::make_box(configuration.box)), kind.title(configuration));
    return;
  }
  gridlock::Simulation const& simulation = *setup.simulation;
  fmt::print("{} {}, {}{}, {}, step {:.6g} of time\n", simulation.agents(), kind.agents_name(),
             sizes_in_words(simulation), in_words(simulation.box()), kind.title(configuration), simulation.time_step());
}

void print_notes(std::vector<std::vector<gridlock::Event>> const& notes) {
  for (std::string const& note : gridlock::texts_of(notes)) fmt::print(stderr, "note: {}\n", note);
}

/// Everything but a random start that takes long.
gridlock::Setup set_up_soon(gridlock::SettingsFile const& settings) {
  return gridlock::set_up(settings, {.on_slow_start = [](double) { return false; }, .threads = 1});
}

/// Sets up every run of a sweep; what is wrong with any of them comes at the end.
void check_all(gridlock::SweepPlan const& plan) {
  std::vector<gridlock::Problem> problems;
  std::vector<std::vector<gridlock::Event>> notes;
  for (gridlock::SweepRun const& run : plan.runs) {
    try {
      gridlock::Setup const setup = set_up_soon(run.settings);
      fmt::print("{}: ", run.name);
      print_setup(setup);
      notes.push_back(setup.notes);
    } catch (gridlock::Error const& error) {
      for (gridlock::Problem problem : error.problems()) {
        problem.what = fmt::format("{}: {}", run.name, problem.what);
        problems.push_back(std::move(problem));
      }
    } catch (std::bad_alloc const&) {
      problems.push_back({.what = fmt::format("{}: not enough memory", run.name)});
    }
  }
  if (!problems.empty()) throw gridlock::Error(std::move(problems));
  print_notes(notes);
  fmt::print("{} runs\n", plan.runs.size());
}

ExitCode check(ConfigurationOptions const& options) {
  gridlock::SettingsFile const settings = options.read();
  if (!settings.is_given("sweep")) {
    gridlock::Setup const setup = set_up_soon(settings);
    print_setup(setup);
    print_notes({setup.notes});
  } else {
    check_all(gridlock::plan_sweep(settings));
  }
  fmt::print("{} can be run\n", options.file);
  return ExitCode::good;
}

}  // namespace

void add_check(CLI::App& app, ExitCode& exit_code) {
  CLI::App* const verb = app.add_subcommand("check", "Check a configuration without running it");
  auto const options = std::make_shared<ConfigurationOptions>();
  options->add_to(*verb);
  verb->callback([options, &exit_code] { exit_code = check(*options); });
}

}  // namespace gridlock::cli
