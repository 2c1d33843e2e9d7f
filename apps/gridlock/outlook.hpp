#pragma once

#include "gridlock/simulation/setup.hpp"

namespace gridlock::cli {

/// Prints the stages of a protocol, and for a large run estimates of memory, time and frames. Cost: for a large run up
/// to two steps, or a few seconds, since the speed is measured.
void print_outlook(Setup const& setup);

}  // namespace gridlock::cli
