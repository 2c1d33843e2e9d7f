#pragma once

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "gridlock/core/error.hpp"

namespace gridlock {

/// Returns the distance from `time` to the next larger double.
inline double spacing_at(double time) { return std::nextafter(time, std::numeric_limits<double>::infinity()) - time; }

/// Returns whether a clock at `time` can count steps of `duration`: rounding changes a step by at most a thousandth.
inline bool can_count(double time, double duration) { return 0.5 * spacing_at(time) <= 1e-3 * duration; }

/// Checks that the clock can count steps up to the end of a run.
/// Errors: Error under the key "run.time".
inline void require_countable_end(double end, double duration) {
  if (can_count(end, duration)) return;
  throw Error({.what = fmt::format("no run reaches time {:.6g}: its clock cannot count steps of {:.6g} that far", end,
                                   duration),
               .hint = "use a shorter time, or run.steps",
               .key = "run.time"});
}

}  // namespace gridlock
