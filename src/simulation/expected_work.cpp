#include "simulation/expected_work.hpp"

#include <algorithm>
#include <limits>
#include <memory>

#include "core/resources.hpp"
#include "gridlock/simulation/simulate.hpp"
#include "simulation/memory.hpp"

namespace gridlock {

namespace {

/// Cells and candidates that a turn looks at on a grid chosen from the sizes, and the rest of a turn in the same unit.
constexpr double usual_cells = 9.0;
constexpr double usual_candidates = 9.0;
constexpr double rest_of_turn = 10.0;

/// The work of a turn in usual turns: lists of few cells have many disks in each, lists of many cells many to look at.
double work_of_turn(EngineSettings const& engine, State const& state) {
  if (engine.kind != "stepped" || engine.grid != GridKind::linked || !engine.cells) return 1.0;
  double const k = static_cast<double>(*engine.cells);
  double const cutoff = 2.0 * radius_range(state.disks).largest / std::min(state.box.width(), state.box.height());
  double const block = std::min(k, 3.0 + 2.0 * k * cutoff);
  double const cells = block * block;
  double const candidates = static_cast<double>(state.disks.size()) * cells / (k * k);
  return (rest_of_turn + cells + candidates) / (rest_of_turn + usual_cells + usual_candidates);
}

double steps_of(RunSettings const& run, double duration_of_step) {
  double steps = std::numeric_limits<double>::infinity();
  if (run.steps) steps = std::min(steps, static_cast<double>(*run.steps));
  if (run.time) steps = std::min(steps, *run.time / duration_of_step);
  // A disk of a dense fluid collides a few times while it travels ten of the default time steps.
  if (run.collisions_per_disk) steps = std::min(steps, *run.collisions_per_disk * 3.0);
  return steps;
}

}  // namespace

bool uses_threads(Configuration const& configuration) {
  return configuration.is_of_model() || configuration.engine.kind == "tiled";
}

std::uint64_t threads_of(Configuration const& configuration) {
  if (!uses_threads(configuration)) return 1;
  return configuration.engine.threads > 0 ? configuration.engine.threads : usable_cores();
}

Expectation expectation_of(Setup const& setup) {
  Configuration const& configuration = setup.configuration;
  if (configuration.is_of_model()) {
    // Only the model knows how many agents its settings make.
    Setup single = setup;
    single.configuration.engine.threads = 1;
    std::unique_ptr<Simulation> const simulation = make_simulation(std::move(single));
    double const agents = static_cast<double>(simulation->agents());
    return {.work = std::max(agents, 1.0) * steps_of(configuration.run, simulation->time_step()) + 1.0,
            .bytes = expected_memory(configuration, agents)};
  }
  double const disks = static_cast<double>(setup.state.disks.size());
  double const steps = steps_of(configuration.run, step_duration(configuration.engine, setup.state));
  return {.work = disks * steps * work_of_turn(configuration.engine, setup.state) + 1.0,
          .bytes = expected_memory(configuration)};
}

}  // namespace gridlock
