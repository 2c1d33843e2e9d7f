#pragma once

#include "gridlock/simulation/setup.hpp"

namespace gridlock::cli {

/// Prints what a run will do, where one line does not say it: the stages of its protocol, and of a large run the
/// memory, time and frames that are expected. Cost: of a large run two steps, or a few seconds of them, which it
/// carries out.
void print_outlook(Setup const& setup);

}  // namespace gridlock::cli
