#include "gridlock/core/box.hpp"

#include <cmath>
#include <string>

#include "core/number_text.hpp"
#include "gridlock/core/error.hpp"

namespace gridlock {

namespace {

void require_side(double side, char const* name) {
  if (std::isfinite(side) && side > 0.0) return;
  throw Error({.what = std::string("the ") + name + " of the box is " + number_text(side) + ", not a positive number",
               .hint = "give box.side, or box.width and box.height, above 0",
               .key = std::string("box.") + name});
}

}  // namespace

Box::Box(double width, double height, Edge edge)
    : width_(width), height_(height), half_width_(0.5 * width), half_height_(0.5 * height), edge_(edge) {
  require_side(width, "width");
  require_side(height, "height");
}

Vector Box::displacement_of_images(Vector from, Vector to) const {
  // Computed for each component alone, so that x does not depend on y.
  auto const component = [](double a, double b, double side) {
    double const d = nearest_image(b - a, side, 0.5 * side);
    if (std::abs(d) <= 0.5 * side) return d;
    // For points far away, images in the box are as precise as its side; the difference of coordinates is not.
    return nearest_image(image_inside(b, side) - image_inside(a, side), side, 0.5 * side);
  };
  return {component(from.x, to.x, width_), component(from.y, to.y, height_)};
}

double Box::side() const { return width_ == height_ ? width_ : std::sqrt(area()); }

double image_inside(double p, double side) {
  if (p >= 0.0 && p < side) return p;
  double image = std::fmod(p, side);
  if (image < 0.0) image += side;
  // −ε + side can round to side, which is the lower edge of the next image.
  return image < side ? image : image - side;
}

}  // namespace gridlock
