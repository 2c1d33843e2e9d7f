#pragma once

#include <span>

#include "gridlock/observe/estimate.hpp"

namespace gridlock {

/// The mean of what equally good runs have measured, such as runs of different seeds, with its standard error from
/// their scatter; the error is absent for a single run. Contract: at least one (asserted).
Estimate mean_over_runs(std::span<double const> values);

}  // namespace gridlock
