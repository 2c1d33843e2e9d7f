#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "gridlock/io/table.hpp"
#include "gridlock/simulation/event.hpp"
#include "gridlock/simulation/simulation.hpp"

namespace gridlock {

/// Takes the errors of averages away that the series contradicts, and says which and why.
///
/// Averages are the results with the name of a column whose mean over the samples they have; `left_out` samples at the
/// start are not in them.
std::vector<Event> withhold_errors(Table const& series, std::size_t left_out, std::vector<NamedEstimate>& results);

/// Notes on hard disks after a run that took so much time: that they are still in their cages, or hardly fly.
std::vector<Event> notes_on_motion(Simulation const& simulation, double time, std::span<NamedEstimate const> results);

}  // namespace gridlock
