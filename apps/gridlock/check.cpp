#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <map>
#include <memory>
#include <new>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "gridlock/core/disks.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/workspace/run_directory.hpp"
#include "gridlock/workspace/sweep.hpp"
#include "outlook.hpp"
#include "simulation/expected_work.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace gridlock::cli {

namespace {

/// Returns "packing fraction 0.7, radius 0.016, " for agents with a radius; otherwise an empty text.
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
    fmt::print("{}, {}\n", text_of(gridlock::make_box(configuration.box)), kind.title(configuration));
    return;
  }
  gridlock::Simulation const& simulation = *setup.simulation;
  std::string const step = gridlock::takes_steps(configuration)
                               ? fmt::format(", step {:.6g} of time", simulation.time_step())
                               : std::string();
  fmt::print("{} {}, {}{}, {}{}\n", simulation.agents(), kind.agents_name(), sizes_in_words(simulation),
             text_of(simulation.box()), kind.title(configuration), step);
}

void print_notes(std::vector<std::vector<gridlock::Event>> const& notes) {
  for (std::string const& note : gridlock::texts_of(notes)) fmt::print(stderr, "note: {}\n", note);
}

/// Sets up a run, except for a random start that would take long.
gridlock::Setup set_up_soon(gridlock::SettingsFile const& settings) {
  return gridlock::set_up(settings, {.on_slow_start = [](double) { return false; }, .threads = 1});
}

/// Collects the problems of the runs of a sweep. Among runs that differ only in the seed, the first reports the problem
/// and the others are counted.
class SweepProblems {
 public:
  explicit SweepProblems(gridlock::SweepPlan const& plan) : plan_(plan) {}

  void add(gridlock::SweepRun const& run, std::vector<gridlock::Problem> const& problems) {
    for (std::size_t k = 0; k < problems.size(); ++k) {
      auto const [place, is_new] = place_of_.try_emplace({values_but_seed(run), problems[k].key, k}, problems_.size());
      if (is_new) {
        problems_.push_back(problems[k]);
        problems_.back().what = fmt::format("{}: {}", run.name, problems[k].what);
        other_seeds_.push_back(0);
      } else {
        ++other_seeds_[place->second];
      }
    }
  }

  /// Errors: Error if there are any problems.
  void require_none() {
    for (std::size_t k = 0; k < problems_.size(); ++k) {
      std::size_t const others = other_seeds_[k];
      if (others == 0) continue;
      problems_[k].what += fmt::format("; {} other {} refused too", others, others == 1 ? "seed is" : "seeds are");
    }
    if (!problems_.empty()) throw gridlock::Error(std::move(problems_));
  }

 private:
  [[nodiscard]] std::vector<std::string> values_but_seed(gridlock::SweepRun const& run) const {
    std::vector<std::string> values = run.values;
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (plan_.keys[k] == "run.seed") values[k].clear();
    }
    return values;
  }

  gridlock::SweepPlan const& plan_;
  std::vector<gridlock::Problem> problems_;
  std::vector<std::size_t> other_seeds_;
  std::map<std::tuple<std::vector<std::string>, std::string, std::size_t>, std::size_t> place_of_;
};

/// Sets up every run of a sweep, and reports all problems at the end.
void check_all(gridlock::SweepPlan const& plan) {
  SweepProblems problems(plan);
  std::vector<std::vector<gridlock::Event>> notes;
  for (gridlock::SweepRun const& run : plan.runs) {
    try {
      gridlock::Setup const setup = set_up_soon(run.settings);
      fmt::print("{}: ", run.name);
      print_setup(setup);
      notes.push_back(setup.notes);
    } catch (gridlock::Error const& error) {
      problems.add(run, error.problems());
    } catch (std::bad_alloc const&) {
      problems.add(run, {{.what = "not enough memory"}});
    }
  }
  problems.require_none();
  print_notes(notes);
  fmt::print("{} runs\n", plan.runs.size());
}

ExitCode check(ConfigurationOptions const& options) {
  gridlock::SettingsFile const settings = options.read();
  if (!settings.is_given("sweep")) {
    gridlock::Setup const setup = set_up_soon(settings);
    print_setup(setup);
    print_outlook(setup);
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
