#include "gridlock/core/box.hpp"

#include <fmt/format.h>

#include <cmath>

#include "gridlock/core/error.hpp"

namespace gridlock {

namespace {

void require_side(double side, char const* name) {
  if (std::isfinite(side) && side > 0.0) return;
  throw Error({.what = fmt::format("the {} of the box is {}, not a positive number", name, side),
               .hint = "give box.side, or box.width and box.height, above 0",
               .key = fmt::format("box.{}", name)});
}

}  // namespace

Box::Box(double width, double height, Edge edge)
    : width_(width), height_(height), half_width_(0.5 * width), half_height_(0.5 * height), edge_(edge) {
  require_side(width, "width");
  require_side(height, "height");
}

double Box::side() const { return width_ == height_ ? width_ : std::sqrt(area()); }

}  // namespace gridlock
