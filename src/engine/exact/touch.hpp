#pragma once

#include "engine/obstacles.hpp"

namespace gridlock::exact {

/// The path of a disk after its last hit: p + v τ + ½ g τ².
struct Path {
  Vector position;
  Vector velocity;
  Vector acceleration;

  [[nodiscard]] Vector at(double wait) const {
    return {position.x + (velocity.x + 0.5 * acceleration.x * wait) * wait,
            position.y + (velocity.y + 0.5 * acceleration.y * wait) * wait};
  }
};

/// Returns the time after which a disk on this path first touches the obstacle from outside; `never` where it does not.
///
/// The disk touches the side of a wall where its distance from the line falls to R, a quadratic equation; it touches an
/// end, or a fixed disk, where the squared distance of the centres falls to (R + r)², an equation of the fourth degree
/// in gravity. The result depends on the path alone, so that it has the same bits whenever it is computed.
double time_to_touch(Obstacle const& obstacle, double radius, Path const& path);

}  // namespace gridlock::exact
