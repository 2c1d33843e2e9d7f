#include "core/magnitude.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace gridlock {

namespace {

/// Positions along the longer side are rounded to 16 digits of it; the shorter side must stay far above that.
constexpr double most_elongated = 1e10;

}  // namespace

std::optional<Problem> find_extreme_sides(Box const& box) {
  double const shorter = std::min(box.width(), box.height());
  double const longer = std::max(box.width(), box.height());
  if (!has_bounded_magnitude(shorter) || !has_bounded_magnitude(longer)) {
    return Problem{
        .what = fmt::format("the box of {} × {} is too large or too small to compute with", box.width(), box.height()),
        .hint = magnitude_hint,
        .key = "box"};
  }
  if (longer / shorter > most_elongated) {
    return Problem{
        .what = fmt::format("the box of {} × {} is too elongated to compute with", box.width(), box.height()),
        .hint = fmt::format("make the longer side at most {:g} times the shorter one", most_elongated),
        .key = "box"};
  }
  return std::nullopt;
}

}  // namespace gridlock
