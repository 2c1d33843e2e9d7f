#include "drawing/field_picture.hpp"

#include <algorithm>
#include <cmath>

namespace gridlock {

namespace {

constexpr double max_shade = 255.0;

/// Returns the colour of a shade from 0 to max_shade.
Colour colour_of_field(double shade) {
  constexpr Colour white{1.0, 1.0, 1.0};
  constexpr Colour light{0.68, 0.87, 0.56};
  constexpr Colour dark{0.0, 0.41, 0.22};
  double const share = 2.0 * shade / max_shade;
  return share < 1.0 ? mixed(white, light, share) : mixed(light, dark, share - 1.0);
}

}  // namespace

void draw_field(Field const& field, double min, double max, PixelRectangle const& box, Canvas& canvas) {
  auto const border = [](double first, double length, std::size_t cell, std::size_t cells) {
    return std::round(first + length * static_cast<double>(cell) / static_cast<double>(cells));
  };
  double const range = max > min ? max - min : 1.0;
  auto const shade_of = [&](std::size_t row, std::size_t column) {
    double const share = (field.values()[row * field.columns() + column] - min) / range;
    return std::round(std::clamp(share, 0.0, 1.0) * max_shade);
  };
  for (std::size_t row = 0; row < field.rows(); ++row) {
    double const top = border(box.y, box.height, field.rows() - 1 - row, field.rows());
    double const bottom = border(box.y, box.height, field.rows() - row, field.rows());
    if (top == bottom) continue;
    for (std::size_t column = 0; column < field.columns();) {
      std::size_t const first = column;
      double const shade = shade_of(row, first);
      while (column < field.columns() && shade_of(row, column) == shade) ++column;
      double const left = border(box.x, box.width, first, field.columns());
      double const right = border(box.x, box.width, column, field.columns());
      if (left < right && shade > 0.0) canvas.fill({left, top, right - left, bottom - top}, colour_of_field(shade));
    }
  }
}

}  // namespace gridlock
