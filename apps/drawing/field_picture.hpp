#pragma once

#include "drawing/canvas.hpp"
#include "gridlock/core/field.hpp"

namespace gridlock {

/// Fills a rectangle with the cells of a field, each with a colour from white, the value `min`, to green, the value
/// `max`. The borders of cells are those of pixels, so that no seams show.
void draw_field(Field const& field, double min, double max, PixelRectangle const& box, Canvas& canvas);

}  // namespace gridlock
