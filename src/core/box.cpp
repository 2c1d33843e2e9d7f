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

Box::Box(double width, double height, Edge edge_x, Edge edge_y)
    : width_(width),
      height_(height),
      half_period_x_(edge_x == Edge::periodic ? 0.5 * width : std::numeric_limits<double>::infinity()),
      half_period_y_(edge_y == Edge::periodic ? 0.5 * height : std::numeric_limits<double>::infinity()),
      edge_x_(edge_x),
      edge_y_(edge_y) {
  require_side(width, "width");
  require_side(height, "height");
}

Vector Box::displacement_of_images(Vector from, Vector to) const {
  // Computed for each component alone, so that x does not depend on y.
  auto const component = [](double a, double b, double side, bool is_periodic) {
    if (!is_periodic) return b - a;
    double const d = nearest_image(b - a, side, 0.5 * side);
    if (std::abs(d) <= 0.5 * side) return d;
    // For points far away, images in the box are as precise as its side; the difference of coordinates is not.
    return nearest_image(image_inside(b, side) - image_inside(a, side), side, 0.5 * side);
  };
  return {component(from.x, to.x, width_, is_periodic_x()), component(from.y, to.y, height_, is_periodic_y())};
}

double Box::side() const { return width_ == height_ ? width_ : std::sqrt(area()); }

std::uint64_t number_of_edges(Box const& box) {
  if (box.edge_x() == box.edge_y()) return box.is_periodic() ? 1 : 0;
  return box.is_periodic_x() ? 2 : 3;
}

Box box_with_edges(double width, double height, std::uint64_t number) {
  if (number > 3) throw Error({.what = "a box has the edges number " + std::to_string(number), .hint = "use 0 to 3"});
  auto const edge = [](bool is_periodic) { return is_periodic ? Edge::periodic : Edge::wall; };
  return {width, height, edge(number == 1 || number == 2), edge(number == 1 || number == 3)};
}

std::string_view edges_in_words(Box const& box) {
  if (box.is_periodic()) return "periodic";
  if (!box.has_images()) return "walled";
  return box.is_periodic_x() ? "x-periodic, y-walled" : "x-walled, y-periodic";
}

double image_inside(double p, double side) {
  if (p >= 0.0 && p < side) return p;
  double image = std::fmod(p, side);
  if (image < 0.0) image += side;
  // −ε + side can round to side, which is the lower edge of the next image.
  return image < side ? image : image - side;
}

}  // namespace gridlock
