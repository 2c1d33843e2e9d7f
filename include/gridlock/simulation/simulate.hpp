#pragma once

/// \file
/// Runs a set-up to its end in one call.
///
/// ```cpp
/// Configuration configuration;
/// configuration.run.steps = 200;
/// RunResult const result = simulate(set_up(configuration));
/// std::vector<double> const energy = result.series.numbers("kinetic_energy");
/// ```

#include "gridlock/core/disks.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/simulation/run.hpp"
#include "gridlock/simulation/setup.hpp"
#include "gridlock/simulation/world_simulation.hpp"

namespace gridlock {

/// The result of a run of a model.
template <class Model>
struct RunResultOf : RunRecord {
  World<Model> world;
  Counters counters;
};
using RunResult = RunResultOf<HardDisks>;

/// Runs a set-up to its end, sampling every observe.every steps and at the end.
///
/// The bits of world and series do not depend on how often progress is reported.
/// Errors: Error for a set-up of another model. A run that fails throws nothing: it returns RunStatus::failed with its
/// partial results.
template <class Model = HardDisks>
RunResultOf<Model> simulate(Setup setup, OnProgress const& on_progress = {}) {
  auto* const simulation = dynamic_cast<WorldSimulation<Model>*>(setup.simulation.get());
  if (simulation == nullptr) throw_other_model(setup);
  Run run(*simulation, plan_of(setup));
  run.advance(on_progress);
  return {run.record(), simulation->world(), simulation->counters()};
}

}  // namespace gridlock
