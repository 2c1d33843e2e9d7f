#include "study/falling.hpp"

#include <cmath>

#include "study/seed_statistics.hpp"

namespace gridlock {

namespace {

bool has_error(MeanOfRuns const& value) { return value.mean.error && value.runs > 1; }

/// Whether a is larger than b, and chance explains it in less than 0.3 % of all cases.
bool exceeds(MeanOfRuns const& a, MeanOfRuns const& b) {
  if (!has_error(a) || !has_error(b)) return false;
  double const error = std::hypot(*a.mean.error, *b.mean.error);
  return a.mean.value - b.mean.value > three_sigma(a.runs + b.runs - 2) * error;
}

/// How far above a level a value lies, in what its error allows; beyond ±1 it is significant.
double above(double level, MeanOfRuns const& value) {
  return (value.mean.value - level) / (three_sigma(value.runs - 1) * *value.mean.error);
}

bool rises_anywhere(std::span<MeanOfRuns const> values) {
  for (std::size_t later = 1; later < values.size(); ++later) {
    for (std::size_t earlier = 0; earlier < later; ++earlier) {
      if (exceeds(values[later], values[earlier])) return true;
    }
  }
  return false;
}

}  // namespace

Verdict verdict_on_fall(std::span<MeanOfRuns const> values, double level) {
  if (rises_anywhere(values)) return Verdict::differs;
  if (values.size() < 2 || !has_error(values.back())) return Verdict::undecided;
  if (above(level, values.back()) > 1.0) return Verdict::differs;
  bool const falls = exceeds(values.front(), values.back());
  return falls && above(level, values.back()) < -1.0 ? Verdict::agrees : Verdict::undecided;
}

}  // namespace gridlock
