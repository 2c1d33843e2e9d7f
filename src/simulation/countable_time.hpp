#pragma once

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "gridlock/core/error.hpp"

namespace gridlock {

/// The distance between neighbouring numbers at `time`.
inline double spacing_at(double time) { return std::nextafter(time, std::numeric_limits<double>::infinity()) - time; }

/// Whether a clock at `time` counts on in steps of `duration`: rounding changes none of them by more than a thousandth.
inline bool can_count(double time, double duration) { return 0.5 * spacing_at(time) <= 1e-3 * duration; }

/// Refuses a run whose clock stops counting before its end.
/// Errors: Error under the key "run.time".
inline void require_countable_end(double end, double duration) {
  if (can_count(end, duration)) return;
  throw Error({.what = fmt::format("no run reaches time {:.6g}: its clock cannot count steps of {:.6g} that far", end,
                                   duration),
               .hint = "use a shorter time, or run.steps",
               .key = "run.time"});
}

}  // namespace gridlock
