#pragma once

#include <cstddef>
#include <span>

#include "drawing/page.hpp"
#include "gridlock/observe/estimate.hpp"

namespace gridlock {

/// A mean over runs that differ in the seed alone; its error is the one over seeds.
struct MeanOfRuns {
  Estimate mean;
  std::size_t runs = 0;
};

/// Whether values fall from the first to the last and end below a level, as far as their errors can tell.
///
///     a exceeds b  where  a − b > t √(error_a² + error_b²),   t = three_sigma(runs_a + runs_b − 2)
///
/// Differs where a later value exceeds an earlier one, neighbours or not, or the last exceeds the level. Agrees where
/// neither does, the first exceeds the last and the level exceeds the last. Undecided otherwise, always where no value has an
/// error: what one run does alone, another seed may not.
///
/// Between n equal values there are n(n − 1)/2 pairs to be mistaken about, each by chance in 0.14 % of all cases.
Verdict verdict_on_fall(std::span<MeanOfRuns const> values, double level);

}  // namespace gridlock
