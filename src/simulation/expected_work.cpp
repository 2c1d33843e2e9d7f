#include "simulation/expected_work.hpp"

#include <algorithm>
#include <limits>

#include "core/resources.hpp"
#include "gridlock/parallel/communicator.hpp"
#include "simulation/memory.hpp"

namespace gridlock {

namespace {

double steps_of(RunSettings const& run, double duration_of_step) {
  double steps = std::numeric_limits<double>::infinity();
  if (run.steps) steps = std::min(steps, static_cast<double>(*run.steps));
  if (run.time) steps = std::min(steps, *run.time / duration_of_step);
  // In a dense fluid a disk collides a few times in ten default time steps; three steps per collision is the estimate.
  if (run.collisions_per_disk) steps = std::min(steps, *run.collisions_per_disk * 3.0);
  return steps;
}

}  // namespace

bool takes_steps(Configuration const& configuration) {
  RunSettings const& run = configuration.run;
  return configuration.protocol.empty() || run.steps.value_or(0) > 0 || run.time || run.collisions_per_disk;
}

bool uses_device(Configuration const& configuration) {
  return configuration.kind().can_use_device(configuration) && device_of(configuration.engine.device) == Device::gpu;
}

bool uses_threads(Configuration const& configuration) { return configuration.kind().uses_threads(configuration); }

std::uint64_t threads_of(Configuration const& configuration, std::optional<std::uint64_t> asked_for,
                         AllProcesses processes) {
  if (!uses_threads(configuration)) return 1;
  std::uint64_t const threads = asked_for.value_or(configuration.engine.threads);
  if (threads > 0) return threads;
  return std::max<std::uint64_t>(1, usable_cores() / processes.communicator().count_on_machine());
}

Expectation expectation_of(Setup const& setup) {
  Configuration const& configuration = setup.configuration;
  Simulation const& simulation = *setup.simulation;
  double const agents = static_cast<double>(simulation.agents());
  double const steps = steps_of(configuration.run, simulation.time_step());
  return {.work = std::max(agents, 1.0) * steps * setup.cost_of_move + 1.0,
          .bytes = expected_memory(configuration, simulation.agents())};
}

}  // namespace gridlock
