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

Box Box::shifted(double shift) const {
  // Beyond a million widths the part that is left has lost its digits.
  if (!(std::abs(shift) <= 1e6 * width_)) {
    throw Error({.what = "the tilt of the box is " + number_text(shift / height_),
                 .hint = "give box.tilt, xy over the height, as a number of at most a million widths over the height",
                 .key = "box.tilt"});
  }
  if (shift != 0.0 && !is_periodic()) {
    throw Error({.what = "a box that is " + std::string(edges_in_words(*this)) + " has the tilt " +
                         number_text(shift / height_),
                 .hint = "only a box that is periodic along x and y can be oblique: box.edge = \"periodic\"",
                 .key = "box.tilt"});
  }
  Box box = *this;
  double const widths = widths_in(shift);
  box.shift_ = widths == 0.0 ? shift : shift - widths * width_;
  return box;
}

Vector Box::displacement_of_images(Vector from, Vector to) const {
  if (is_oblique()) {
    Vector const d = displacement_inside(from, to);
    if (std::abs(d.x) <= half_period_x_ && std::abs(d.y) <= half_period_y_) return d;
    return displacement_inside(inside(from), inside(to));
  }
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

Vector Box::inside(Vector p) const {
  Vector image = p;
  if (is_periodic_y()) {
    image.y = image_inside(p.y, height_);
    if (is_oblique()) image.x -= std::round((p.y - image.y) / height_) * shift_;
  }
  if (is_periodic_x()) image.x = image_inside(image.x, width_);
  return image;
}

void require_rectangle(Box const& box, std::string_view what) {
  if (!box.is_oblique()) return;
  throw Error(
      {.what = std::string(what) + " knows rectangles only, and box.tilt is " + number_text(box.tilt()),
       .hint = "use a box without tilt; the engines \"exact\" and \"soft\", growth, protocols of soft disks, contacts "
               "and analysis know oblique boxes, and so do the starts \"random\", \"square\" and \"uniform\"",
       .key = "box.tilt"});
}

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

}  // namespace gridlock
