#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gridlock/simulation/setup.hpp"

namespace gridlock {

/// Number of agents from which a random start may be slow; with fewer it succeeds or fails within a few seconds.
constexpr std::uint64_t many_agents = 25'000;

/// Returns whether to make a start that needs about `attempts` random positions. If not, adds a note under `key`.
bool makes_start(double attempts, std::string const& key, SetupOptions const& options, std::vector<Event>& notes);

}  // namespace gridlock
