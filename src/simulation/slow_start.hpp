#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gridlock/simulation/setup.hpp"

namespace gridlock {

/// Fewer agents find room, or give up, within a few seconds.
constexpr std::uint64_t many_agents = 25'000;

/// Whether a start that tries so many random places is to be made; one that is not is noted under `key`.
bool makes_start(double attempts, std::string const& key, SetupOptions const& options, std::vector<Event>& notes);

}  // namespace gridlock
