#include <fmt/format.h>

#include <memory>

#include "gridlock/run/run_directory.hpp"
#include "gridlock/run/sweep.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace {

void print_setup(gridlock::Setup const& setup) {
  gridlock::State const& state = setup.state;
  auto const [smallest, largest] = gridlock::radius_range(state.disks);
  fmt::print("{} disks, packing fraction {:.6g}, radius {:.6g}{}, {} box {} × {}, engine {}, step {:.6g} of time\n",
             state.disks.size(), gridlock::covered_area(state.disks) / state.box.area(), smallest,
             largest > smallest ? fmt::format(" to {:.6g}", largest) : "",
             state.box.is_periodic() ? "periodic" : "walled", state.box.width(), state.box.height(),
             setup.configuration.engine.kind, gridlock::step_duration(setup.configuration.engine, state));
}

ExitCode check(ConfigurationOptions const& options) {
  gridlock::SettingsFile const settings = options.read();
  if (!settings.is_given("sweep")) {
    print_setup(gridlock::set_up(settings));
  } else {
    gridlock::SweepPlan const plan = gridlock::plan_sweep(settings);
    for (gridlock::SweepRun const& run : plan.runs) {
      fmt::print("{}: ", run.name);
      print_setup(gridlock::set_up(run.settings));
    }
    fmt::print("{} runs\n", plan.runs.size());
  }
  fmt::print("{} is good\n", options.file);
  return ExitCode::good;
}

}  // namespace

void add_check(CLI::App& app, ExitCode& exit_code) {
  CLI::App* const verb = app.add_subcommand("check", "Say whether a configuration can be run, without running it");
  auto const options = std::make_shared<ConfigurationOptions>();
  options->add_to(*verb);
  verb->callback([options, &exit_code] { exit_code = check(*options); });
}
