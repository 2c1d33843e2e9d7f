#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "gridlock/io/table.hpp"
#include "gridlock/simulation/event.hpp"
#include "gridlock/simulation/simulation.hpp"

namespace gridlock {

/// Removes the errors of averages that contradict the series, and returns notes with the names and reasons, also on
/// viscosities for which the series is too short.
///
/// A result is an average if a column has its name and its value is the mean of the column's samples. The first
/// `left_out` samples do not count.
std::vector<Event> withhold_errors(Table const& series, std::size_t left_out, std::vector<NamedEstimate>& results);

/// Returns notes on hard disks after a run of length `time`: that they have not left their cages, or hardly move.
std::vector<Event> notes_on_motion(Simulation const& simulation, double time, std::span<NamedEstimate const> results);

}  // namespace gridlock
