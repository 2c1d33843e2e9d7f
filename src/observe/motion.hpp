#pragma once

#include <optional>

#include "gridlock/observe/observable.hpp"

namespace gridlock {

// Energy and temperature, measured once for all observables that ask the same snapshot. The sums are exact, so that the
// order of the rows changes no bit; those of core, which feed back into states, keep the bits of a sum row by row.

/// ½ Σ m v². Contract: the agents have a mass and a velocity. Cost: one pass over the agents, the first time.
double measured_kinetic_energy(Snapshot const& now);

/// kT as temperature() defines it. Contract and cost: the same.
std::optional<double> measured_temperature(Snapshot const& now);

}  // namespace gridlock
