#pragma once

#include <cstddef>
#include <optional>

#include "gridlock/observe/observable.hpp"

namespace gridlock {

// Energy and temperature, computed once for all observables of a snapshot. The sums are exact, so that they do not
// depend on the order of the rows. Sums in core are taken row by row, because they change states, whose bits must stay.

/// Returns the number of agents that are not fixed. Contract and cost: as measured_kinetic_energy().
std::size_t count_of_moving(Snapshot const& now);

/// Returns ½ Σ m v². Contract: the agents have a mass and a velocity. Cost: one pass over the agents at the first call.
double measured_kinetic_energy(Snapshot const& now);

/// Returns kT as temperature() defines it. Contract and cost: as measured_kinetic_energy().
std::optional<double> measured_temperature(Snapshot const& now);

}  // namespace gridlock
