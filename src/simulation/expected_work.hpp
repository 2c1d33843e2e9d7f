#pragma once

#include <cstdint>
#include <optional>

#include "gridlock/parallel/detail/all_processes.hpp"
#include "gridlock/simulation/setup.hpp"

namespace gridlock {

/// The work and memory that a run will probably take. Sweeps use it for the order and progress of runs, and to choose
/// runs that fit into memory together.
struct Expectation {
  double work = 0.0;  ///< in moves of an agent with a typical number of neighbours
  double bytes = 0.0;
};
Expectation expectation_of(Setup const& setup);

/// Returns whether the run has steps of an engine or a model, and not only a protocol.
bool takes_steps(Configuration const& configuration);

/// Returns whether a run becomes faster with more than one thread.
bool uses_threads(Configuration const& configuration);

/// Returns whether a graphics processor takes the steps of a run.
bool uses_device(Configuration const& configuration);

/// Returns the number of threads of a run in each of its processes: `asked_for`, or else the configured number.
std::uint64_t threads_of(Configuration const& configuration, std::optional<std::uint64_t> asked_for = std::nullopt,
                         AllProcesses processes = {});

}  // namespace gridlock
