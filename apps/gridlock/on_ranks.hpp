#pragma once

#include <functional>

#include "verbs.hpp"

namespace gridlock {
class Ranks;
}

namespace gridlock::cli {

/// Carries out a command of one run: with a crew rank 0 does, and the others help it until it has ended. `work` is given the
/// ranks, or none where it is alone.
/// Errors: those of `work`; RunFailure where another rank cannot take part.
ExitCode carry_out(CrewOptions const* options, std::function<ExitCode(Ranks*)> const& work);

}  // namespace gridlock::cli
