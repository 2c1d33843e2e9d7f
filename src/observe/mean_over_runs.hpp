#pragma once

#include <span>

#include "gridlock/observe/estimate.hpp"

namespace gridlock {

/// Returns the mean of one value from each run, such as runs of different seeds, with its standard error from their
/// scatter; a single run has no error. Contract: there is at least one value (asserted).
Estimate mean_over_runs(std::span<double const> values);

}  // namespace gridlock
