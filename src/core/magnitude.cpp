#include "core/magnitude.hpp"

#include <algorithm>
#include <string>

#include "core/number_text.hpp"

namespace gridlock {

namespace {

/// Largest ratio of the sides: rounding along the longer side must be far below the length of the shorter.
constexpr double max_elongated = 1e10;

}  // namespace

std::optional<Problem> find_extreme_sides(Box const& box) {
  double const shorter = std::min(box.width(), box.height());
  double const longer = std::max(box.width(), box.height());
  auto const sides = [&] { return number_text(box.width()) + " × " + number_text(box.height()); };
  if (!has_bounded_magnitude(shorter) || !has_bounded_magnitude(longer)) {
    return Problem{.what = "the box of " + sides() + " is too large or too small to compute with",
                   .hint = magnitude_hint,
                   .key = "box"};
  }
  if (longer / shorter > max_elongated) {
    return Problem{.what = "the box of " + sides() + " is too elongated to compute with",
                   .hint = "make the longer side at most 1e10 times the shorter one",
                   .key = "box"};
  }
  return std::nullopt;
}

}  // namespace gridlock
