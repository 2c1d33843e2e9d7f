#pragma once

#include <cstdint>
#include <optional>

#include "gridlock/parallel/detail/all_processes.hpp"
#include "gridlock/simulation/setup.hpp"

namespace gridlock {

/// The work and the memory that a run is expected to take, as far as its set-up tells: for the order of many runs,
/// their progress, and which of them fit into memory beside one another.
struct Expectation {
  double work = 0.0;  ///< in turns of an agent among neighbours of the usual number
  double bytes = 0.0;
};
Expectation expectation_of(Setup const& setup);

/// Whether a run takes steps of an engine or a model; else its protocol is all of it.
bool takes_steps(Configuration const& configuration);

/// Whether more threads than one are of any use to a run.
bool uses_threads(Configuration const& configuration);

/// The threads a run is carried out by in each of its processes, where it may be asked for others than the configured
/// ones.
std::uint64_t threads_of(Configuration const& configuration, std::optional<std::uint64_t> asked_for = std::nullopt,
                         AllProcesses processes = {});

}  // namespace gridlock
