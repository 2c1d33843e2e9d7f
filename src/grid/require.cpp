#include "grid/require.hpp"

#include <cmath>
#include <string>

#include "core/number_text.hpp"
#include "gridlock/core/error.hpp"

namespace gridlock {

namespace {

/// All are looked at, many at once: x − x is 0 for finite numbers alone.
bool are_finite(std::span<double const> coordinates) {
  std::size_t broken = 0;
  for (double const p : coordinates) broken += static_cast<std::size_t>(!(p - p == 0.0));
  return broken == 0;
}

}  // namespace

void require_cutoff(double cutoff) {
  if (cutoff >= 0.0) return;
  throw Error(
      {.what = "the cutoff of a neighbour search is " + number_text(cutoff), .hint = "use a distance of 0 or above"});
}

void require_equal_lengths(std::span<double const> x, std::span<double const> y) {
  if (x.size() == y.size()) return;
  throw Error({.what = "there are " + std::to_string(x.size()) + " x coordinates and " + std::to_string(y.size()) +
                       " y coordinates",
               .hint = "give every point one of each"});
}

void require_points(std::span<double const> x, std::span<double const> y) {
  require_equal_lengths(x, y);
  if (are_finite(x) && are_finite(y)) return;
  std::size_t i = 0;
  while (std::isfinite(x[i]) && std::isfinite(y[i])) ++i;
  throw Error({.what = "point " + std::to_string(i) + " is at (" + number_text(x[i]) + ", " + number_text(y[i]) + ")",
               .hint = "every coordinate must be finite"});
}

void require_all_moved(std::size_t moved, std::size_t held, std::size_t coordinates) {
  if (moved == held) return;
  throw Error({.what = "there are coordinates for " + std::to_string(coordinates) + " agents, but " +
                       std::to_string(held - moved) + " agents of the grid are beyond them",
               .hint = "give coordinates for every agent that the grid holds"});
}

}  // namespace gridlock
