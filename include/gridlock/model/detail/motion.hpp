#pragma once

#include <algorithm>

#include "gridlock/core/box.hpp"
#include "gridlock/core/disks.hpp"

namespace gridlock {

/// The directions in which walls reflected a move.
struct Bounce {
  bool x = false;
  bool y = false;
};

/// The end of a move: across periodic edges, or reflected by walls. Contract: the displacement is shorter than the
/// sides of the box.
struct Motion {
  Vector end;
  int crossed_x = 0;  ///< see Box::wrap()
  int crossed_y = 0;
  Bounce bounce;
};

constexpr Motion motion(Box const& box, Vector p, Vector displacement) {
  Motion motion{.end = p + displacement};
  motion.end = box.wrap(motion.end, motion.crossed_x, motion.crossed_y);
  if (box.is_periodic()) return motion;
  auto const mirror = [](double& coordinate, double side, bool& is_turned) {
    is_turned = coordinate < 0.0 || coordinate > side;
    if (coordinate < 0.0) coordinate = -coordinate;
    if (coordinate > side) coordinate = std::max(0.0, side - (coordinate - side));
  };
  if (!box.is_periodic_x()) mirror(motion.end.x, box.width(), motion.bounce.x);
  if (!box.is_periodic_y()) mirror(motion.end.y, box.height(), motion.bounce.y);
  return motion;
}

}  // namespace gridlock
