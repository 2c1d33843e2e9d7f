#pragma once

#include "gridlock/core/box.hpp"

namespace gridlock {

/// Returns the displacement of an agent from one point of the box to another across `crossed` edges. Edges on the right
/// and at the top count +1, on the left and at the bottom −1, as in the columns ImageX and ImageY.
inline Vector unwrapped_displacement(Box const& box, Vector from, Vector to, Vector crossed) {
  return (to - from) + box.offset_of_image(crossed.x, crossed.y);
}

}  // namespace gridlock
