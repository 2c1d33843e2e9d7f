#pragma once

#include "gridlock/core/box.hpp"

namespace gridlock {

/// How far an agent has come from one point of the box to another over `crossed` edges: to the right and to the
/// top count, to the left and to the bottom count back, as the columns ImageX and ImageY do.
inline Vector unwrapped_displacement(Box const& box, Vector from, Vector to, Vector crossed) {
  return {to.x - from.x + crossed.x * box.width(), to.y - from.y + crossed.y * box.height()};
}

}  // namespace gridlock
