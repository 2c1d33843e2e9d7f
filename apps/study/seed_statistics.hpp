#pragma once

#include <cstddef>

namespace gridlock {

/// How many standard errors chance alone exceeds in 0.27 % of all cases, as three do for a well-known error: Student's t,
/// since an error from the scatter of few values is itself uncertain. 235.8 for one degree of freedom, towards 3.
/// Errors: to 1 % of the value from 9 degrees on, where the series in 1/degrees is used. Contract: degrees ≥ 1 (asserted).
/// Source: M. Abramowitz & I. Stegun, Handbook of Mathematical Functions (1964), 26.7.5.
double three_sigma(std::size_t degrees_of_freedom);

}  // namespace gridlock
